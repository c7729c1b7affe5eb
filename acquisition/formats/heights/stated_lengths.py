# SPDX-License-Identifier: MIT
"""Printed lengths, with their rounding of half a digit."""

from dataclasses import dataclass

from jointbench.acquisition.basics.errors import UnitError
from jointbench.acquisition.basics.units import to_si
from jointbench.acquisition.formats.table_cells import NUMBER


@dataclass(frozen=True, slots=True)
class StatedLength:
    """A length as it is printed.

    Attributes:
        value: [m].
        half_digit: half a unit of its last digit [m].
    """

    value: float
    half_digit: float

    def agrees(self, other: "StatedLength") -> bool:
        """Return whether two printed lengths agree within rounding."""
        rounding = self.half_digit + other.half_digit
        return abs(self.value - other.value) <= rounding * (1 + 1e-9)


def stated_length(cell: str) -> StatedLength | None:
    """Read a printed length with its unit; None where there is none above zero."""
    text = cell.strip()
    match = NUMBER.match(text)
    if match is None:
        return None
    try:
        unit = to_si(text[match.end() :].strip(), "length")
    except UnitError:
        return None
    value = float(match[0]) * unit
    if not 0 < value < float("inf"):
        return None
    return StatedLength(value, half_digit(match[0]) * unit)


def half_digit(cell: str) -> float:
    """Return half a unit of the last digit of a printed number [its unit].

    >>> half_digit("10.0")
    0.05
    """
    mantissa, _, exponent = cell.lower().partition("e")
    decimals = len(mantissa.partition(".")[2])
    return float(f"0.5e{int(exponent or 0) - decimals}")
