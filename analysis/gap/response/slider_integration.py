# SPDX-License-Identifier: MIT
"""Smooth sliders: their curves as tables, and a compiled step along them.

A slider remembers how far it has been pushed. Its loading curve rises from elastic to
slip; unloading it is elastic, or follows a second curve (Bouc and Wen). Both curves are
tabulated once for a set of shape parameters, so that a step is one or two lookups.
"""

from typing import NamedTuple

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.compiled import compiled
from jointbench.analysis.gap.response.response_settings import RESPONSE

_TABLE_SIZE = RESPONSE.slider_table_points
_IDENTITY = RESPONSE.slider_elastic_error
_STALE = 1e30
"""Loading coordinate of a slider that has unloaded since it was last known."""


@compiled(fastmath=True, inline="always")
def _lookup(tables: FloatArray, row: int, per_unit: float, x: float) -> float:
    """Interpolate a row of evenly spaced points; constant above its end.

    Rows are not sliced out, and the function is compiled into its caller: a view costs
    more than the lookup, and an array that is handed over ten times as much.
    """
    position = x * per_unit
    index = int(position)
    last = tables.shape[1] - 1
    if index >= last:
        return float(tables[row, last])
    low = tables[row, index]
    return float(low + (position - index) * (tables[row, index + 1] - low))


@compiled(fastmath=True, inline="always")
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
            unloading, when it is looked up at need.
        step: change of displacement over the slip displacement [-].
        tables: u of loading coordinate, its inverse, unloading coordinate of u, its
            inverse; shape (n_rows, n).
        tops: points per unit of the four tables; the state below which all four are
            the identity; 1 where unloading is elastic; end of loading; shape (7,).
        row: where the four tables of this slider begin.

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
    left = (size if elastic else _lookup(tables, row + 2, tops[2], size)) + forward
    if left < 0.0:
        return -side * _lookup(tables, row, tops[0], -left), side * left
    return side * (left if elastic else _lookup(tables, row + 3, tops[3], left)), _STALE


class Bank(NamedTuple):
    """A bank of sliders in a march: plain numbers, which cost nothing to hand over.

    Attributes:
        law: which law of the link it is.
        first: where its sliders begin.
        beyond: where they end.
        lanes: records that are marched side by side.
        now: where in the motions its own begin [m].
        last: where those of the step before begin [m].
        force: where in the forces its own begin [N].
    """

    law: int
    first: int
    beyond: int
    lanes: int
    now: int
    last: int
    force: int


class Sliders(NamedTuple):
    """The sliders of all banks, in order of rising slip displacement within a bank.

    Attributes:
        slips: slip displacements [m], shape (n_sliders,).
        rates: their inverse [1/m], same shape.
        weights: stiffness of each [N/m], same shape.
    """

    slips: FloatArray
    rates: FloatArray
    weights: FloatArray


@compiled(fastmath=True, inline="always")
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
    """Write the force of a bank, less that of the same bank held fast.

    Sliders come in order of rising slip displacement. Those that have never left their
    elastic range follow the joint, and are passed over.

    Args:
        bank: which one, and where its numbers are.
        w: motions of the lanes among other things.
        f: forces of the lanes among other things; written.
        states: displacement over slip displacement, and loading coordinate, shape
            (n_lanes, n_sliders, 2); moved.
        active: sliders that have left their elastic range, shape (n_laws, n_lanes).
        sliders: of all banks.
        tables: four rows a law, shape (4 n_laws, n_points).
        tops: what goes with them, shape (n_laws, 7).
    """
    # Taken out once: each look into a tuple of arrays counts a reference up and down.
    slips, rates, weights = sliders
    a, first, beyond = bank.law, bank.first, bank.beyond
    # Numbers of their own: an array might change with `states`, and is read each time.
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
        total, end = 0.0, first + active[a, k]
        while end < beyond and abs(r) > own[4] * slips[end]:
            states[k, end, 0] = before / slips[end]
            states[k, end, 1] = states[k, end, 0]
            end += 1
        active[a, k] = end - first
        step = r - before
        for i in range(first, end):
            u, loading = states[k, i, 0], states[k, i, 1]
            u, loading = slide(u, loading, step * rates[i], tables, own, 4 * a)
            states[k, i, 0], states[k, i, 1] = u, loading
            total += weights[i] * (slips[i] * u - r)
        f[bank.force + k] = total


def slider_tables(
    loading: float, unloading: float, sharpness: float
) -> tuple[FloatArray, FloatArray]:
    """Tabulate the curves of a smooth slider.

    With u the displacement of the slider over its slip displacement, the loading
    rate is du/dr = 1 - loading u^n and the unloading rate 1 + unloading u^n.

    Args:
        loading: beta + gamma of Bouc and Wen [-]; 1 for a slider that saturates at 1.
        unloading: beta - gamma [-]; 0 for elastic unloading.
        sharpness: n [-].

    Returns:
        Tables, shape (4, TABLE_SIZE), and what `slide` wants with them, shape (7,).

    Source:
        Wen 1976, J. Eng. Mech. Div. 102, eq. (2), with |u| <= 1 normalised.
    """
    limit = 30.0
    if loading > 0:
        limit = min(limit, loading ** (-1.0 / sharpness))
    stretch = 1.0 - np.exp(-np.linspace(0.0, 14.0, 3000))
    u = limit * stretch / stretch[-1] * (1.0 - 1e-6)
    load = _cumulative(u, 1.0 / (1.0 - loading * u**sharpness))
    unload = _cumulative(u, 1.0 / np.maximum(1.0 + unloading * u**sharpness, 1e-3))
    bend = max(abs(loading), abs(unloading), 1e-12)
    free = (_IDENTITY * (sharpness + 1.0) / bend) ** (1.0 / sharpness)
    elastic = float(unloading == 0.0)
    ends = np.array([load[-1], u[-1], u[-1], unload[-1]])
    tops = np.array([*((_TABLE_SIZE - 1) / ends), min(free, 0.9), elastic, load[-1]])
    grid = np.linspace(0.0, 1.0, _TABLE_SIZE)
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
    """Integrate y over x from the first point, by trapezia."""
    steps = 0.5 * (y[1:] + y[:-1]) * np.diff(x)
    return np.concatenate([[0.0], np.cumsum(steps)])


NO_SLIDERS: tuple[FloatArray, FloatArray, FloatArray, FloatArray] = (
    np.zeros(0),
    np.zeros(0),
    np.zeros((4, 2)),
    np.ones(7),
)
