# SPDX-License-Identifier: MIT
"""A value and its 95 % interval, as the head of a report states them."""

from math import floor, isfinite, log10

NORMAL_95 = 1.959964
"""Half width of the 95 % interval of a normal distribution [sd]."""
_MOST_DIGITS = 7
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_PREFIXES = {-15: "f", -12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k"}
_PREFIXES |= {6: "M", 9: "G", 12: "T"}


def value_and_interval(
    value: float, sd: float | None, unit: str, *, prefix: bool = True
) -> tuple[str, str]:
    """Return a value with its unit, and its 95 % interval.

    Args:
        value: [unit].
        sd: its standard deviation [unit]; None where it has none.
        unit: of the value.
        prefix: whether the unit takes an SI prefix.

    Returns:
        Value, and interval; the interval is empty without a standard deviation.

    >>> value_and_interval(5.9984e7, 4.4e4, "N/m")
    ('59.984 MN/m', '95 %: 59.898 to 60.070 MN/m')
    >>> value_and_interval(197.969091, 3.3e-5, "Hz", prefix=False)
    ('197.9691 Hz', '95 %: 197.9690 to 197.9692 Hz')
    >>> value_and_interval(0.0736, 0.0024, "-", prefix=False)
    ('0.0736', '95 %: 0.0689 to 0.0783')
    """
    if not isfinite(value):
        return "-", ""
    if sd is None or not isfinite(sd) or sd <= 0:
        scaled, name = _scaled(value, unit, prefix=prefix)
        return f"{scaled:.4g}{_gap(name)}", ""
    return between(value, value - NORMAL_95 * sd, value + NORMAL_95 * sd, unit, prefix)


def between(
    value: float, low: float, high: float, unit: str, prefix: bool = True
) -> tuple[str, str]:
    """Return a value with its unit, and an interval that need not be even.

    Args:
        value: [unit].
        low: lower end [unit].
        high: upper end [unit].
        unit: of all three.
        prefix: whether the unit takes an SI prefix.
    """
    scaled, name = _scaled(value, unit, prefix=prefix)
    factor = scaled / value if value else 1.0
    ends = low * factor, high * factor
    wide = max(abs(ends[1] - ends[0]), 1e-300)
    lead = floor(log10(max(abs(scaled), wide)))
    digits = min(max(1 - floor(log10(wide / 2)), 0), max(_MOST_DIGITS - 1 - lead, 0))
    words = f"{ends[0]:.{digits}f} to {ends[1]:.{digits}f}{_gap(name)}"
    return f"{scaled:.{digits}f}{_gap(name)}", f"95 %: {words}"


def _gap(name: str) -> str:
    """Return a unit with the blank before it; a power of ten follows the number."""
    return name if not name or name.startswith("·") else f" {name}"


def _scaled(value: float, unit: str, *, prefix: bool) -> tuple[float, str]:
    """Return a value in a readable multiple of its unit, and that unit."""
    # A number without a unit, "-" in tables, stands alone.
    unit = "" if unit == "-" else unit.replace("^2", "²").replace("^3", "³")
    if not value:
        return value, unit
    power = 3 * floor(log10(abs(value)) / 3)
    if prefix and unit and power in _PREFIXES:
        return value / 10.0**power, f"{_PREFIXES[power]}{unit}"
    if -3 <= log10(abs(value)) < 6:
        return value, unit
    lead = floor(log10(abs(value)))
    raised = str(lead).translate(_RAISED)
    return value / 10.0**lead, f"·10{raised} {unit}".rstrip()
