# SPDX-License-Identifier: MIT
"""Smooth sliders: tables of their curves, and a compiled step along them.

The state of a slider is its displacement. Its loading curve changes from elastic to
slip; its unloading is elastic, or follows a second curve (Bouc and Wen). Both curves
are tabulated once for a set of shape parameters, so that a step is one or two lookups.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.compiled import compiled
from jointbench.analysis.gap.response.response_settings import RESPONSE

_TABLE_SIZE = RESPONSE.slider_table_points
_IDENTITY = RESPONSE.slider_elastic_error
_STALE = 1e30
"""Loading coordinate that is invalid since the slider has unloaded."""


@compiled(fastmath=True, forceinline=True)
def _lookup(tables: FloatArray, row: int, per_unit: float, x: float) -> float:
    """Interpolate a row of evenly spaced points; constant above its end.

    Rows are not sliced, and the function is inlined: a view takes longer than the
    lookup, and passing an array ten times as long.
    """
    position = x * per_unit
    index = int(position)
    last = tables.shape[1] - 1
    if index >= last:
        return float(tables[row, last])
    low = tables[row, index]
    return float(low + (position - index) * (tables[row, index + 1] - low))


@compiled(fastmath=True, forceinline=True)
def slide(
    u: float,
    loading: float,
    step: float,
    tables: FloatArray,
    tops: tuple[float, ...] | FloatArray,
    row: int = 0,
) -> tuple[float, float]:
    """Move a slider along its loading and unloading curves.

    Args:
        u: displacement of the slider over its slip displacement [-].
        loading: its signed coordinate on the loading curve [-]; `_STALE` after
            unloading, when it is looked up if needed.
        step: change of displacement over the slip displacement [-].
        tables: u of loading coordinate, its inverse, unloading coordinate of u, its
            inverse; shape (n_rows, n).
        tops: points per unit of the four tables; the state below which all four are
            the identity; 1 where unloading is elastic; end of loading; shape (7,).
        row: first of the four rows of this slider.

    Returns:
        The new u and loading coordinate.
    """
    moved = u + step
    if abs(u) < tops[4] and abs(moved) < tops[4]:
        return moved, moved
    side = 1.0 if u > 0.0 or (u == 0.0 and step >= 0.0) else -1.0
    size, forward = side * u, side * step
    if forward >= 0.0:
        x = side * loading
        if loading == _STALE:
            x = _lookup(tables, row + 1, tops[1], size)
        x = min(x + forward, tops[6])
        return side * _lookup(tables, row, tops[0], x), side * x
    elastic = tops[5] > 0.0
    start = size if elastic else _lookup(tables, row + 2, tops[2], size)
    left = start + forward
    if left < 0.0:
        return -side * _lookup(tables, row, tops[0], -left), side * left
    if not elastic:
        # A difference of two lookups: the error of each would add up over the steps.
        left = size + _lookup(tables, row + 3, tops[3], left)
        left = max(left - _lookup(tables, row + 3, tops[3], start), 0.0)
    return side * left, _STALE


class Bank(NamedTuple):
    """A bank of sliders in the time integration, as plain numbers.

    Attributes:
        law: index of its law.
        first: its first slider.
        beyond: end of its sliders.
        lanes: number of records integrated in parallel.
        now: offset of its motions [m].
        last: offset of the motions of the previous step [m].
        earlier: offset of the motions of the step before that [m].
        force: offset of its forces [N].
    """

    law: int
    first: int
    beyond: int
    lanes: int
    now: int
    last: int
    earlier: int
    force: int


class Sliders(NamedTuple):
    """The sliders of all banks, by ascending slip displacement within a bank.

    Attributes:
        slips: slip displacements [m], shape (n_sliders,).
        rates: their inverse [1/m], same shape.
        weights: stiffness of each [N/m], same shape.
    """

    slips: FloatArray
    rates: FloatArray
    weights: FloatArray


@compiled(fastmath=True, forceinline=True)
def _turning_point(earlier: float, before: float, now: float) -> float:
    """Return the motion at which a step turns, or that at its start if it does not.

    A slider follows the way, not its ends: a turn missed within a step would leave an
    error of the order of the step squared at every reversal. The motion is a parabola
    through the last three points.

    Args:
        earlier: motion two steps before [m].
        before: motion at the start of the step [m].
        now: motion at its end [m].
    """
    rise, bend = 0.5 * (now - earlier), now - 2.0 * before + earlier
    if rise * bend < 0.0 and abs(rise) < abs(bend):
        return before - 0.5 * rise * rise / bend
    return before


@compiled(fastmath=True, forceinline=True)
def bank_forces(
    bank: Bank,
    w: FloatArray,
    f: FloatArray,
    states: FloatArray,
    active: IntArray,
    sliders: Sliders,
    tables: FloatArray,
    tops: FloatArray,
) -> None:
    """Write the force of a bank, minus that of the same bank without slip.

    Sliders are in order of ascending slip displacement. Those that have never left
    their elastic range follow the joint, and are skipped.

    Args:
        bank: the bank and its offsets.
        w: state of the lanes, including the motions.
        f: forces of the lanes; changed in place.
        states: displacement over slip displacement, and loading coordinate, shape
            (n_lanes, n_sliders, 2); changed in place.
        active: sliders that have left their elastic range, shape (n_laws, n_lanes).
        sliders: of all banks.
        tables: four rows per law, shape (4 n_laws, n_points).
        tops: properties of these tables, see `slide`, shape (n_laws, 7).
    """
    # Unpacked once: each access to a tuple of arrays changes a reference count.
    slips, rates, weights = sliders
    a, first, beyond = bank.law, bank.first, bank.beyond
    # Local numbers: an array could alias `states`, and would be read at every use.
    own = (
        tops[a, 0],
        tops[a, 1],
        tops[a, 2],
        tops[a, 3],
        tops[a, 4],
        tops[a, 5],
        tops[a, 6],
    )
    for k in range(bank.lanes):
        r, before = w[bank.now + k], w[bank.last + k]
        turn = _turning_point(w[bank.earlier + k], before, r)
        farthest = max(abs(r), abs(turn))
        total, end = 0.0, first + active[a, k]
        while end < beyond and farthest > own[4] * slips[end]:
            states[k, end, 0] = before / slips[end]
            states[k, end, 1] = states[k, end, 0]
            end += 1
        active[a, k] = end - first
        out, back = turn - before, r - turn
        for i in range(first, end):
            u, loading = states[k, i, 0], states[k, i, 1]
            if out != 0.0:
                u, loading = slide(u, loading, out * rates[i], tables, own, 4 * a)
            u, loading = slide(u, loading, back * rates[i], tables, own, 4 * a)
            states[k, i, 0], states[k, i, 1] = u, loading
            total += weights[i] * (slips[i] * u - r)
        f[bank.force + k] = total


@lru_cache(maxsize=64)
def slider_tables(
    loading: float, unloading: float, sharpness: float
) -> tuple[FloatArray, FloatArray]:
    """Tabulate the curves of a smooth slider.

    If u is the displacement of the slider over its slip displacement, the loading
    rate is du/dr = 1 - loading u^n and the unloading rate 1 + unloading u^n.

    Args:
        loading: beta + gamma of Bouc and Wen [-]; 1 for a slider that saturates at 1.
        unloading: beta - gamma [-]; 0 for elastic unloading.
        sharpness: n [-].

    Returns:
        Tables, shape (4, TABLE_SIZE), and their properties (`tops` of `slide`), (7,).
        Both are shared by all calls with the same shape, and never written to.

    Source:
        Wen 1976, J. Eng. Mech. Div. 102, eq. (2), with |u| <= 1 normalised.
    """
    limit = RESPONSE.slider_reach
    if loading > 0:
        limit = min(limit, loading ** (-1.0 / sharpness))
    beyond = limit > 1.0
    points = RESPONSE.slider_curve_points[beyond]
    if loading > 0:  # fine towards saturation
        stretch = 1.0 - np.exp(-np.linspace(0.0, 14.0, points))
    else:  # fine towards zero, where most motions are
        stretch = np.sinh(np.linspace(0.0, 8.0, points))
    u = limit * stretch / stretch[-1] * (1.0 - 1e-6)
    load = _cumulative(u, 1.0 / (1.0 - loading * u**sharpness))
    unload = _cumulative(u, 1.0 / np.maximum(1.0 + unloading * u**sharpness, 1e-3))
    bend = max(abs(loading), abs(unloading), 1e-12)
    free = (_IDENTITY * (sharpness + 1.0) / bend) ** (1.0 / sharpness)
    elastic = float(unloading == 0.0)
    ends = np.array([load[-1], u[-1], u[-1], unload[-1]])
    size = RESPONSE.long_table_points if beyond else _TABLE_SIZE
    tops = np.array([*((size - 1) / ends), min(free, 0.9), elastic, load[-1]])
    grid = np.linspace(0.0, 1.0, size)
    tables = np.stack(
        [
            np.interp(grid * ends[0], load, u),
            np.interp(grid * ends[1], u, load),
            np.interp(grid * ends[2], u, unload),
            np.interp(grid * ends[3], unload, u),
        ]
    )
    return tables, tops


def _cumulative(x: FloatArray, y: FloatArray) -> FloatArray:
    """Integrate y over x from the first point, by the trapezoidal rule."""
    steps = 0.5 * (y[1:] + y[:-1]) * np.diff(x)
    return np.concatenate([[0.0], np.cumsum(steps)])


NO_SLIDERS: tuple[FloatArray, FloatArray, FloatArray, FloatArray] = (
    np.zeros(0),
    np.zeros(0),
    np.zeros((4, 2)),
    np.ones(7),
)
