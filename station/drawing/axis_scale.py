# SPDX-License-Identifier: MIT
"""An axis of a figure: where values lie on it, and which of them are written."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import ceil, floor, isfinite, log10

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray

_STEPS = (1.0, 2.0, 5.0, 10.0)
_TIMES = "·10"
_MARKS = 5
"""Marks that an axis has room for at 300 pixels."""
_PLAIN_FROM, _PLAIN_TO = 1e-3, 1e5
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True, slots=True)
class AxisScale:
    """Ends of an axis and how values lie between them.

    Attributes:
        low: lower end; of a logarithmic axis its power of ten.
        high: upper end, larger than `low`.
        log: whether the axis is logarithmic.
        names: of categories, the first at 0; empty for numbers.
        turned: whether the axis runs downwards or leftwards.
    """

    low: float
    high: float
    log: bool = False
    names: tuple[str, ...] = ()
    turned: bool = False

    def places(self, values: object) -> FloatArray:
        """Return places of values, 0 at the lower end and 1 at the upper.

        Args:
            values: numbers, None, or names of categories, shape (n,).

        Returns:
            Places [-], shape (n,); NaN for what has none.
        """
        plain = self._numbers(values)
        found = (plain - self.low) / (self.high - self.low)
        return np.asarray(1.0 - found if self.turned else found)

    def _numbers(self, values: object) -> FloatArray:
        if self.names:
            index = {name: float(at) for at, name in enumerate(self.names)}
            listed = list(values) if isinstance(values, list | tuple) else []
            return np.array([index.get(str(v), np.nan) for v in listed], float)
        plain = numbers_of(values)
        return _powers(plain) if self.log else plain


def numbers_of(values: object) -> FloatArray:
    """Return numbers of a trace, shape (n,); NaN for what is none."""
    if isinstance(values, list | tuple):
        return np.array([_number(v) for v in values], float)
    return np.atleast_1d(np.asarray(values, float)) if values is not None else _NONE


_NONE = np.zeros(0)


def plain_number(value: object, otherwise: float) -> float:
    """Return a setting of a figure that must be a finite number, else `otherwise`."""
    found = _number(value)
    return found if isfinite(found) else otherwise


def _number(value: object) -> float:
    try:
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        return float("nan")


def _powers(values: FloatArray) -> FloatArray:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(values > 0, np.log10(np.where(values > 0, values, 1)), np.nan)


def axis_scale(
    settings: Mapping[str, object],
    values: Sequence[object],
    *,
    room: float = 0.04,
    zero: bool = False,
) -> AxisScale:
    """Return the axis that shows values, or the range that is set.

    Args:
        settings: of the axis: type, range, autorange.
        values: of every trace on it.
        room: share of the span that is left free at each end.
        zero: whether zero is shown, as under bars.
    """
    turned = settings.get("autorange") == "reversed"
    words = [v for one in values for v in _words(one)]
    if settings.get("type") == "category" or words:
        every = [str(v) for one in values if isinstance(one, list | tuple) for v in one]
        names = tuple(dict.fromkeys(every)) or ("",)
        return AxisScale(-0.5, len(names) - 0.5, names=names, turned=turned)
    log = settings.get("type") == "log"
    ends = _given(settings.get("range"))
    if ends is not None:
        return AxisScale(min(ends), max(ends), log, turned=turned or ends[0] > ends[1])
    parts = [numbers_of(one) for one in values] or [_NONE]
    plain = np.concatenate(parts)
    plain = _powers(plain) if log else plain
    plain = plain[np.isfinite(plain)]
    if zero and not log:
        plain = np.append(plain, 0.0)
    return _around(plain, room, log=log, turned=turned)


def _around(plain: FloatArray, room: float, *, log: bool, turned: bool) -> AxisScale:
    if not plain.size:
        return AxisScale(0.0, 1.0, log, turned=turned)
    low, high = float(plain.min()), float(plain.max())
    span = high - low
    if span <= 1e-12 * max(abs(low), abs(high)):
        wide = 0.5 if log else max(0.05 * abs(low), 1e-12)
        return AxisScale(low - wide, high + wide, log, turned=turned)
    return AxisScale(low - room * span, high + room * span, log, turned=turned)


def _words(values: object) -> list[str]:
    if not isinstance(values, list | tuple):
        return []
    return [v for v in values if isinstance(v, str)]


def _given(ends: object) -> tuple[float, float] | None:
    if not isinstance(ends, list | tuple) or len(ends) != 2:
        return None
    low, high = _number(ends[0]), _number(ends[1])
    return (low, high) if isfinite(low) and isfinite(high) and low != high else None


def axis_marks(
    scale: AxisScale, settings: Mapping[str, object]
) -> list[tuple[float, str]]:
    """Return places [-] and texts of the marks of an axis."""
    chosen = settings.get("tickvals")
    if isinstance(chosen, list | tuple):
        texts = settings.get("ticktext")
        words = texts if isinstance(texts, list | tuple) else chosen
        pairs = zip(scale.places(chosen), map(_written, words), strict=False)
    elif scale.names:
        pairs = zip(scale.places(list(scale.names)), scale.names, strict=True)
    elif scale.log:
        pairs = _log_marks(scale)
    else:
        values = _even_marks(scale.low, scale.high, settings.get("dtick"))
        pairs = zip(scale.places(values), mark_texts(values), strict=True)
    return [(float(p), text) for p, text in pairs if -1e-9 <= p <= 1 + 1e-9]


def _written(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def _log_marks(scale: AxisScale) -> "zip[tuple[float, str]]":
    """Return decades, or figures within them where the axis holds fewer than three."""
    first, last = ceil(scale.low - 1e-9), floor(scale.high + 1e-9)
    if last - first >= 2:
        every = max(1, -(-(last - first + 1) // 7))
        powers = list(range(first, last + 1, every))
        values = [10.0**p for p in powers]
        texts = [
            f"{v:g}" if -2 <= p <= 4 else f"10{str(p).translate(_RAISED)}"
            for p, v in zip(powers, values, strict=True)
        ]
        return zip(scale.places(values), texts, strict=True)
    low, high = 10.0**scale.low, 10.0**scale.high
    start = floor(scale.low)
    steps = [m * 10.0**k for k in range(start, start + 4) for m in (1, 2, 5)]
    values = [v for v in steps if low <= v <= high]
    if len(values) < 3:
        values = [v for v in _even_marks(low, high, None) if v > 0]
    texts = mark_texts(values)
    if any(_TIMES in text for text in texts):
        texts = [_with_power(v, floor(log10(v) + 1e-9)) for v in values]
    return zip(scale.places(values), texts, strict=True)


def _even_marks(low: float, high: float, step: object) -> list[float]:
    size = (high - low) / _MARKS
    power = 10.0 ** floor(log10(size))
    own = power * next((s for s in _STEPS if s * power >= 0.999 * size), 10.0)
    if isinstance(step, int | float) and step > 0 and (high - low) / step <= 24:
        own = float(step)
    first = ceil(low / own - 1e-9)
    count = floor(high / own + 1e-9) - first + 1
    return [(first + k) * own for k in range(max(count, 0))]


def mark_texts(values: Sequence[float]) -> list[str]:
    """Return numbers as an axis writes them: with one power of ten for all.

    >>> mark_texts([0.0, 2e7, 4e7])
    ['0', '2·10⁷', '4·10⁷']
    """
    largest = max((abs(v) for v in values), default=0.0)
    if largest and not _PLAIN_FROM <= largest < _PLAIN_TO:
        power = floor(log10(largest) + 1e-9)
        return [_with_power(v, power) if v else "0" for v in values]
    tiny = 1e-9 * largest
    return [f"{0.0 if abs(v) < tiny else v:.6g}" for v in values]


def _with_power(value: float, power: int) -> str:
    return f"{value / 10.0**power:.6g}{_TIMES}{str(power).translate(_RAISED)}"
