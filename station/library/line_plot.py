# SPDX-License-Identifier: MIT
"""Small line plots as SVG, for the display of a result in a notebook."""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np
from numpy.typing import ArrayLike

from jointbench.acquisition.basics.arrays import FloatArray

WIDTH, HEIGHT = 640, 260
_LEFT, _RIGHT, _TOP, _BOTTOM = 76, 14, 14, 44
_COLOURS = ("#1f6f8b", "#c8553d", "#588157", "#7b5ea7", "#b08900")
_MOST_POINTS = 1_500
"""A notebook of many results stays small: each pixel shows two points at most."""
_DECADES = 6
"""Decades of a logarithmic axis at most."""


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """One line: its name, and x and y of equal length; NaN leaves a gap."""

    name: str
    x: ArrayLike
    y: ArrayLike


@dataclass(frozen=True, slots=True)
class AxisView:
    """An axis: its title with unit, and whether it is logarithmic."""

    title: str
    log: bool = False


def line_plot(curves: Sequence[Curve], x: AxisView, y: AxisView) -> str:
    """Return curves on one pair of axes as an SVG element."""
    points = [_thinned(_scaled(c.x, x), _scaled(c.y, y)) for c in curves]
    finite = [p[:, np.isfinite(p).all(axis=0)] for p in points]
    every = np.concatenate(finite, axis=1)
    if not every.size:
        return ""
    box = [_range(every[0], tight=True), _range(every[1], log=y.log)]
    lines = [_line(p, box, i) for i, p in enumerate(points)]
    named = [_legend(c.name, i) for i, c in enumerate(curves) if c.name]
    marks = [*_marks(box[0], x, upright=False), *_marks(box[1], y, upright=True)]
    return (
        f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" role="img" '
        f'aria-label="{escape(y.title)} over {escape(x.title)}" '
        'style="max-width:100%;background:#fff" font-family="system-ui" '
        f'font-size="11" fill="#1c2733">{"".join([*marks, *lines, *named])}</svg>'
    )


def _scaled(values: ArrayLike, axis: AxisView) -> FloatArray:
    """Return values as they lie on the axis; a logarithm of nothing is a gap."""
    plain = np.asarray(values, dtype=float)
    if not axis.log:
        return plain
    return np.log10(np.where(plain > 0, plain, np.nan))


def _thinned(x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the lowest and highest point of each stretch, so that peaks stay."""
    step = -(-x.size // (_MOST_POINTS // 2))
    if step <= 2:
        return np.array([x, y])
    whole = x.size // step * step
    blocks = np.where(np.isnan(y[:whole]), -np.inf, y[:whole]).reshape(-1, step)
    first = np.arange(0, whole, step)
    kept = np.unique(np.r_[first + blocks.argmin(1), first + blocks.argmax(1)])
    return np.array([x[kept], y[kept]])


def _range(
    values: FloatArray, *, tight: bool = False, log: bool = False
) -> tuple[float, float]:
    low, high = float(values.min()), float(values.max())
    if log:
        low = max(low, high - _DECADES)
    spare = 0.0 if tight and high > low else 0.05 * (high - low) or 0.5
    return low - spare, high + spare


def _place(values: FloatArray, ends: tuple[float, float], axis: int) -> FloatArray:
    share = (values - ends[0]) / (ends[1] - ends[0])
    if axis == 0:
        return _LEFT + share * (WIDTH - _LEFT - _RIGHT)
    return HEIGHT - _BOTTOM - np.clip(share, 0, 1) * (HEIGHT - _TOP - _BOTTOM)


def _line(points: FloatArray, box: Sequence[tuple[float, float]], number: int) -> str:
    across, down = (_place(points[i], box[i], i) for i in (0, 1))
    words, pen = [], "M"
    for a, d in zip(across, down, strict=True):
        seen = np.isfinite(a) and np.isfinite(d)
        words += [f"{pen}{a:.1f} {d:.1f}"] if seen else []
        pen = "L" if seen else "M"
    colour = _COLOURS[number % len(_COLOURS)]
    return f'<path d="{"".join(words)}" fill="none" stroke="{colour}"/>'


def _legend(name: str, number: int) -> str:
    colour = _COLOURS[number % len(_COLOURS)]
    x, y = WIDTH - _RIGHT - 6, _TOP + 12 + 14 * number
    return (
        f'<text x="{x}" y="{y}" text-anchor="end" fill="{colour}">{escape(name)}</text>'
    )


def _marks(ends: tuple[float, float], axis: AxisView, *, upright: bool) -> list[str]:
    """Return ticks with their numbers, grid lines and the title of an axis."""
    found = []
    for tick in _ticks(ends, log=axis.log):
        at = float(_place(np.array(tick), ends, int(upright)))
        words = f"1e{tick:g}" if axis.log else f"{tick:g}"
        if upright:
            line = f'x1="{_LEFT}" x2="{WIDTH - _RIGHT}" y1="{at:.1f}" y2="{at:.1f}"'
            text = f'x="{_LEFT - 6}" y="{at + 4:.1f}" text-anchor="end"'
        else:
            line = f'x1="{at:.1f}" x2="{at:.1f}" y1="{_TOP}" y2="{HEIGHT - _BOTTOM}"'
            text = f'x="{at:.1f}" y="{HEIGHT - _BOTTOM + 14}" text-anchor="middle"'
        found += [f'<line {line} stroke="#e3e8ee"/>', f"<text {text}>{words}</text>"]
    if upright:
        place = f'x="-{(HEIGHT - _BOTTOM + _TOP) / 2}" y="14" transform="rotate(-90)"'
    else:
        place = f'x="{(WIDTH + _LEFT - _RIGHT) / 2}" y="{HEIGHT - 8}"'
    title = f'<text {place} text-anchor="middle">{escape(axis.title)}</text>'
    return [*found, title]


def _ticks(ends: tuple[float, float], *, log: bool) -> list[float]:
    """Return round numbers within the ends: whole decades, or steps of 1, 2 or 5."""
    span = ends[1] - ends[0]
    rough = span / 5
    step = 10.0 ** np.floor(np.log10(rough))
    step *= next(m for m in (1, 2, 5, 10) if m * step >= rough)
    if log:
        step = max(1.0, round(step))
    first = np.ceil(ends[0] / step) * step
    return [float(round(t, 12)) for t in np.arange(first, ends[1] + 1e-9 * span, step)]
