# SPDX-License-Identifier: MIT
"""Values as typed in options and arguments: preload, sample rate, hit point."""

import math

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.basics.units import parse_value


def parse_preload(text: str) -> float:
    """Read a preload as typed, for example ``"4 kN"``; in newton.

    Raises:
        UnitError: it has no unit of force.
        UsageError: it is not above zero.
    """
    value = parse_value(text, "force")
    if value <= 0:
        raise UsageError(f"--preload is {text!r}; it must be above zero, e.g. '4 kN'")
    return value


def parse_rate(text: str | float | None) -> float | None:
    """Read a sample rate as typed, for example ``"25.6 kHz"``; in hertz.

    Args:
        text: with a unit; a number is in hertz; None for none.

    Raises:
        UnitError: it has no unit of frequency.
        UsageError: it is not above zero.
    """
    if text is None:
        return None
    if not isinstance(text, str | int | float):
        raise UsageError(f"the rate is {text!r}; give it in Hz, or as '25.6 kHz'")
    value = parse_value(text, "frequency") if isinstance(text, str) else float(text)
    if not 0.0 < value < math.inf:
        raise UsageError(f"--rate is {text!r}; it must be above zero, e.g. '25.6 kHz'")
    return value


def parse_point(text: str) -> str:
    """Read the name of a hit point as typed.

    Raises:
        UsageError: it is empty.
    """
    if not text.strip():
        raise UsageError("--point is empty; give the name of the hit point, e.g. '1'")
    return text.strip()
