# SPDX-License-Identifier: MIT
"""Values as text: with their standard deviation, or with an SI prefix."""

from math import floor, isfinite, log10

_PLAIN_FROM, _PLAIN_TO = -3, 6
"""Powers of ten between which numbers are written without an exponent."""


def with_sd(value: float, sd: float | None, *, digits: int = 2) -> str:
    """Write a value and its standard deviation with the significant digits.

    >>> with_sd(810.2314, 0.021)
    '810.231 ± 0.021'
    >>> with_sd(6.2e7, 1.1e6)
    '(6.20 ± 0.11)e+07'
    """
    if sd is None or not (isfinite(sd) and sd > 0):
        return f"{value:.6g}"
    last = floor(log10(sd)) - digits + 1
    lead = floor(log10(max(abs(value), sd)))
    if _PLAIN_FROM <= lead < _PLAIN_TO:
        value, sd = round(value, -last), round(sd, -last)
        return f"{value:.{max(-last, 0)}f} ± {sd:.{max(-last, 0)}f}"
    scale = 10.0**lead
    return (
        f"({value / scale:.{lead - last}f} ± {sd / scale:.{lead - last}f})e{lead:+03d}"
    )


def engineering(value: float, unit: str) -> str:
    """Write a value with an SI prefix.

    >>> engineering(3.2e-9, "m")
    '3.2 nm'
    """
    if value == 0 or not isfinite(value):
        return f"{value:g} {unit}"
    prefixes = {-15: "f", -12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M"}
    prefixes |= {9: "G", 12: "T"}
    power = min(max(3 * floor(log10(abs(value)) / 3), -15), 12)
    return f"{value / 10**power:.4g} {prefixes[power]}{unit}"
