# SPDX-License-Identifier: MIT
"""Check that printed stamps are evenly spaced, up to rounding.

A stamp printed with few digits is an interval: half a unit of its last digit to
either side. Stamps are even if one straight line over the index passes through all
intervals; the slopes of all such lines are the steps that the print allows.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import SamplingError

# Jitter of unrounded stamps attributed to the clock [step].
JITTER = 0.02
# One or two lost samples, or a repeated row, look like rounding where all other steps
# are equal to the digit: this many odd steps are a fault.
_FEW_LONG = 2
_FEW_SHORT = 1
# Largest change of a step of unrounded stamps to a round number.
_TIGHT = 1e-9
_MAX_DECIMALS = 12
_MAX_DIGITS = 10


@dataclass(frozen=True, slots=True)
class EvenSteps:
    """A straight line through all stamps.

    Attributes:
        step: distance of neighbours: the span over (n - 1), within the bounds.
        low: smallest step that the printed digits allow.
        high: largest step that they allow.
        resolution: coarsest unit of the last digit; 0 for stamps of full precision.
    """

    step: float
    low: float
    high: float
    resolution: float


def fit_even_steps(
    stamps: FloatArray,
    *,
    what: str,
    unit: str,
    where: Callable[[int], str],
    printed: Callable[[], FloatArray] | None = None,
) -> EvenSteps:
    """Find the even step of ascending stamps.

    Args:
        stamps: as printed, in the unit of the file, shape (n,), n >= 2.
        what: name of the stamps, for messages: ``"time"``.
        unit: their unit, for messages.
        where: returns the place of a stamp in its file, by index.
        printed: returns the unit of the last printed digit of each stamp [unit],
            shape (n,); used only where the values alone do not explain the digits, as
            in files with a changing number of digits.

    Returns:
        The step and its bounds [unit].

    Raises:
        SamplingError: a stamp is not a number, they decrease or are constant, or are
            not even; the message names the first place and both values.
    """
    if stamps.size < 2:
        raise SamplingError(f"{what} has {stamps.size} values, at least 2 are needed")
    _require_rising(stamps, what, unit, where)
    resolution = printed_resolution(stamps)
    fault = _few_odd_steps(stamps)
    if fault is None:
        fitted = _fit(stamps, resolution)
        if fitted is None and printed is not None:
            resolution = np.maximum(resolution, printed())
            fitted = _fit(stamps, resolution)
        if fitted is not None:
            return fitted
        fault = _first_fault(stamps, resolution)
    steps = np.diff(stamps)
    usual = float(np.median(steps)) or float(steps.mean())
    raise SamplingError(
        f"{where(fault + 1)}: {what} goes from {stamps[fault]:.9g} to "
        f"{stamps[fault + 1]:.9g} {unit} where the usual step is {usual:.6g} {unit}; "
        f"{what} must be evenly spaced: cut the file there, or export it without gaps"
    )


def printed_resolution(stamps: FloatArray) -> FloatArray:
    """Guess the unit of the last printed digit of each stamp from the values.

    Fixed decimals, few significant digits and single precision are distinguished by
    agreement of all values; where several fit, the coarsest counts.

    Args:
        stamps: shape (n,), finite.

    Returns:
        Unit of the last digit of each stamp, shape (n,); 0 without visible rounding.
    """
    resolution = np.zeros(stamps.shape)
    for decimals in range(-3, _MAX_DECIMALS + 1):
        unit = np.full(stamps.shape, 10.0**-decimals)
        if _are_multiples(stamps, unit):
            resolution = unit
            break
    magnitude = np.abs(stamps)
    exponent = np.floor(np.log10(np.where(magnitude > 0, magnitude, 1.0)))
    for digits in range(1, _MAX_DIGITS + 1):
        unit = 10.0 ** (exponent - digits + 1)
        if _are_multiples(stamps, unit):
            resolution = np.maximum(resolution, np.where(magnitude > 0, unit, 0.0))
            break
    with np.errstate(over="ignore"):
        single = stamps.astype(np.float32)
    if np.array_equal(single.astype(np.float64), stamps):
        spacing = np.spacing(np.abs(single)).astype(np.float64)
        resolution = np.maximum(resolution, spacing)
    return resolution


def roundest(low: float, high: float) -> float:
    """Return the number with the fewest digits between two bounds.

    >>> roundest(3999.6, 4000.7)
    4000.0
    """
    middle = 0.5 * (low + high)
    for digits in range(1, 16):
        candidate = float(f"{middle:.{digits - 1}e}")
        if low <= candidate <= high:
            return candidate
    return middle


def _are_multiples(values: FloatArray, unit: FloatArray) -> bool:
    """Return whether all values are multiples of their units, by a sample first."""
    for part in (slice(None, None, max(1, values.size // 200)), slice(None)):
        scaled = np.abs(values[part] / unit[part])
        off = np.abs(scaled - np.rint(scaled))
        tiny = (scaled > 0) & (scaled < 0.5)
        # Beyond 1e10 a double has no digits left to distinguish a multiple from any
        # number.
        if scaled.max() > 1e10 or off.max() > 1e-5 or np.any(tiny):
            return False
    return True


def _require_rising(
    stamps: FloatArray, what: str, unit: str, where: Callable[[int], str]
) -> None:
    bad = np.flatnonzero(~np.isfinite(stamps))
    if bad.size:
        raise SamplingError(
            f"{where(int(bad[0]))}: {what} is {stamps[bad[0]]}; "
            "every row needs a number"
        )
    back = np.flatnonzero(np.diff(stamps) < 0)
    if back.size:
        i = int(back[0])
        raise SamplingError(
            f"{where(i + 1)}: {what} runs backwards, from {stamps[i]:.9g} to "
            f"{stamps[i + 1]:.9g} {unit}; {what} must rise: cut the file into one "
            "record each"
        )
    if stamps[-1] == stamps[0]:
        raise SamplingError(
            f"{where(stamps.size - 1)}: {what} is constant at {stamps[0]:.9g} {unit} "
            "from the first row to the last; is it the right column?"
        )


def _noise(stamps: FloatArray) -> float:
    """Return the rounding of the arithmetic that made the stamps."""
    return 4 * float(np.finfo(np.float64).eps * np.abs(stamps).max())


def _few_odd_steps(stamps: FloatArray) -> int | None:
    """Return the first odd step if there are one or two among equal ones."""
    steps = np.diff(stamps)
    usual = float(np.median(steps))
    odd = np.flatnonzero(np.abs(steps - usual) > 1e-6 * usual + 2 * _noise(stamps))
    if odd.size == 0 or steps.size < odd.size + 3:
        return None
    if np.abs(steps[odd] - usual).min() < 0.5 * usual:  # one unit of the last digit
        return None
    most = _FEW_LONG if steps[odd[0]] > usual else _FEW_SHORT
    return int(odd[0]) if odd.size <= most else None


def _fit(stamps: FloatArray, resolution: FloatArray) -> EvenSteps | None:
    """Fit a line within the rounding, or within the jitter of a clock."""
    span = float(stamps[-1] - stamps[0]) / (stamps.size - 1)
    half = 0.5 * (1 + 1e-9) * resolution + _noise(stamps)
    coarsest = float(resolution.max())
    bounds = _slope_bounds(stamps, half)
    if bounds is not None:
        low, high = bounds
        return EvenSteps(min(max(span, low), high), low, high, coarsest)
    if _slope_bounds(stamps, np.maximum(half, JITTER * span)) is None:
        return None
    return EvenSteps(span, span * (1 - _TIGHT), span * (1 + _TIGHT), coarsest)


def _first_fault(stamps: FloatArray, resolution: FloatArray) -> int:
    """Return the index before the first stamp that does not fit an even line."""
    good, bad = 2, stamps.size
    while bad - good > 1:
        middle = (good + bad) // 2
        fits = _fit(stamps[:middle], resolution[:middle]) is not None
        good, bad = (middle, bad) if fits else (good, middle)
    return bad - 2


def _slope_bounds(stamps: FloatArray, half: FloatArray) -> tuple[float, float] | None:
    """Return the least and largest slope of a line within `half` of all stamps."""
    high = _largest_slope(stamps, half)
    low = _largest_slope(-stamps, half)
    if high is None or low is None or -low > high:
        return None
    return max(-low, np.finfo(np.float64).tiny), high


def _largest_slope(stamps: FloatArray, half: FloatArray) -> float | None:
    """Return the largest slope of a line through all intervals, or None.

    A line of slope b passes through all where g(b) = max(lower - b i) - min(upper - b
    i) is not above zero. g is convex; Newton's method from an upper bound converges to
    its larger root, or past its minimum where there is none.
    """
    index = np.arange(stamps.size, dtype=np.float64)
    lower, upper = stamps - half, stamps + half
    slack = 4 * np.finfo(np.float64).eps * float(np.abs(stamps).max())
    slope = float(upper[-1] - lower[0]) / (stamps.size - 1)
    for _ in range(200):
        i = int(np.argmax(lower - slope * index))
        j = int(np.argmin(upper - slope * index))
        if (lower[i] - slope * i) - (upper[j] - slope * j) <= slack:
            return slope
        if j <= i:
            return None
        slope = float(upper[j] - lower[i]) / (j - i)
    return None
