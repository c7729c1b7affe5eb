# SPDX-License-Identifier: MIT
"""Scatter of the hits as reported: by direction, and hit by hit where it is large."""

import math
from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class DirectionFound:
    """Scatter along one direction of the model.

    Attributes:
        name: for example ``"channel gain"``.
        size: sd from hit to hit, in `unit`; 0 if it is not significant.
        unit: ``"-"`` or ``"s"``.
    """

    name: str
    size: float
    unit: str


@dataclass(frozen=True, slots=True)
class HitFound:
    """A hit that deviates from the others.

    Attributes:
        record: its number, 0-based.
        direction: along which it deviates; empty if no direction describes it.
        value: deviation in the unit of the direction; without one, its chi2/dof.
        sd: of the usual hits, same unit; 0 if they do not scatter.
        unit: of value and sd, ``"-"`` or ``"s"``.
    """

    record: int
    direction: str
    value: float
    sd: float
    unit: str = "-"


@dataclass(frozen=True, slots=True)
class ScatterFound:
    """Scatter of the hits of a campaign.

    Attributes:
        directions: every direction that was tried.
        correlation: between successive hits [-].
        hits: those that deviate by more than 4 sd, or stand out.
    """

    directions: tuple[DirectionFound, ...]
    correlation: float
    hits: tuple[HitFound, ...]

    @property
    def words(self) -> str:
        """The significant sizes in words, largest share first."""
        found = [d for d in self.directions if d.size > 0.0]
        if not found:
            return "hits do not scatter beyond the noise"
        listed = ", ".join(f"{d.name} {_size_words(d)}" for d in found)
        tied = ""
        if self.correlation > 0.0:
            tied = f"; successive hits are correlated by {self.correlation:.2g}"
        return f"hits scatter in {listed}{tied}"


def _size_words(direction: DirectionFound) -> str:
    if direction.unit == "s":
        return f"{_two_digits(1e6 * direction.size)} us"
    return f"{_two_digits(100 * direction.size)} %"


def hit_words(hit: HitFound) -> str:
    """Return one hit in words, for example ``record 3 (force gain +8 %)``."""
    if not hit.direction:
        return f"record {hit.record}"
    if hit.unit == "s":
        size = f"{_two_digits(1e6 * hit.value, '+')} us"
    else:
        size = f"{_two_digits(100 * hit.value, '+')} %"
    return f"record {hit.record} ({hit.direction} {size})"


def _two_digits(value: float, sign: str = "-") -> str:
    """Return a number with two significant digits, never as a power of ten.

    Args:
        value: above the resolution of the records, so that none is rounded to 0.
        sign: of the format: ``"+"`` shows that of a positive number, too.
    """
    decimals = max(1 - math.floor(math.log10(abs(value))), 0) if value else 0
    return f"{value:{sign}.{decimals}f}"


def scatter_json(found: ScatterFound) -> dict[str, Any]:
    """Return the scatter as JSON types."""
    return asdict(found)
