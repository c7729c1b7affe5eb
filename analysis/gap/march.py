# SPDX-License-Identifier: MIT
"""Compiled march of the nonlinear link force along a known linear motion.

Only the difference e between the motion with and without the effect is stepped, so
that a force law of amplitude 0 leaves the linear response untouched to the last bit.
The link's own compliance is a sum of modes, each stepped exactly for a force that is
a straight line within the step (first-order hold); the force at the end of a step is
found from the motion predicted with an extrapolated force, whose error is of the
order dt^2/m of a second difference and far below the noise.
"""

import math

import numpy as np
from numba import njit

from jointbench.acquisition.arrays import ComplexArray, FloatArray
from jointbench.analysis.gap.curve_march import curve_force

POLYNOMIAL = 0
ONE_SIDED = 1
SLIDERS = 2
COULOMB = 3
QUADRATIC_DAMPING = 4
CURVES = 5
TABLE_SIZE = 4096
IDENTITY = 1e-7
"""Departure of a slider from elasticity that is passed over."""


@njit(cache=True)
def _lookup(table: FloatArray, top: float, x: float) -> float:
    """Interpolate a table on [0, top]; constant above."""
    last = table.size - 1
    position = x / top * last
    if position >= last:
        return float(table[last])
    index = int(position)
    weight = position - index
    return float(table[index] * (1.0 - weight) + table[index + 1] * weight)


@njit(cache=True)
def slide(state: float, step: float, tables: FloatArray, tops: FloatArray) -> float:
    """Move a slider along its loading and unloading curves.

    Args:
        state: loading coordinate, signed by the side the slider is on [-].
        step: change of displacement over the slip displacement [-].
        tables: u of loading coordinate, its inverse, unloading coordinate of u, its
            inverse; shape (4, n).
        tops: upper ends of the four tables; the coordinate below which all four are
            the identity; 1 where unloading is elastic, else 0; shape (6,).

    Returns:
        The new state.
    """
    side = 1.0 if state > 0.0 or (state == 0.0 and step >= 0.0) else -1.0
    forward = side * step
    size = abs(state)
    if forward >= 0.0:
        return side * float(min(size + forward, tops[0]))
    if size < tops[4]:
        return state + step
    u = _lookup(tables[0], tops[0], size)
    left = (u if tops[5] > 0.0 else _lookup(tables[2], tops[2], u)) + forward
    if left < tops[4]:
        return side * left
    u = left if tops[5] > 0.0 else _lookup(tables[3], tops[3], left)
    return side * _lookup(tables[1], tops[1], u)


@njit(cache=True)
def _rub(limit: float, width: float, v: float, slope: float, guess: float) -> float:
    """Solve f = limit tanh((v - slope (f - guess)) / width), by safe Newton steps."""
    low, high = -abs(limit), abs(limit)
    force = limit * math.tanh(v / width)
    for _ in range(12):
        t = math.tanh((v - slope * (force - guess)) / width)
        excess = force - limit * t
        if excess > 0.0:
            high = force
        else:
            low = force
        step = excess / (1.0 + limit * slope * (1.0 - t * t) / width)
        trial = force - step
        if not low <= trial <= high:
            trial = 0.5 * (low + high)
        if abs(trial - force) < 1e-7 * (abs(limit) + 1e-300):
            return trial
        force = trial
    return force


@njit(cache=True, fastmath=True)
def _forces(
    law: int,
    p: FloatArray,
    r: FloatArray,
    v: FloatArray,
    slope: FloatArray,
    guess: FloatArray,
    before: FloatArray,
    states: FloatArray,
    slips: FloatArray,
    weights: FloatArray,
    tables: FloatArray,
    tops: FloatArray,
    force: FloatArray,
) -> None:
    """Write the force of one law in every record; sliders move their states."""
    n = r.size
    if law == POLYNOMIAL:
        for k in range(n):
            force[k] = r[k] * r[k] * (p[0] + p[1] * r[k])
    elif law == ONE_SIDED:
        for k in range(n):
            force[k] = p[0] * max(r[k] - p[1], 0.0)
    elif law == QUADRATIC_DAMPING:
        for k in range(n):
            force[k] = p[0] * v[k] * abs(v[k])
    elif law == COULOMB:
        for k in range(n):
            force[k] = _rub(p[0], p[1], v[k], slope[k], guess[k])
    elif law == CURVES:
        for k in range(n):
            force[k] = curve_force(tables, p, r[k], v[k])
    else:
        for k in range(n):
            force[k] = -p[0] * r[k]
        for i in range(slips.size):
            inverse = 1.0 / slips[i]
            limit = weights[i] * slips[i]
            for k in range(n):
                state = slide(states[i, k], (r[k] - before[k]) * inverse, tables, tops)
                states[i, k] = state
                u = abs(state)
                if u > tops[4]:
                    u = _lookup(tables[0], tops[0], u)
                force[k] += limit * (u if state > 0.0 else -u)


@njit(cache=True)
def _hold(poles: ComplexArray, residues: ComplexArray, dt: float) -> FloatArray:
    """Return growth and first-order-hold weights of the modes, each (re, im).

    Modes are scaled by their residues, so that a real part is a displacement.
    """
    z = poles * dt
    growth = np.exp(z)
    end = dt * (growth - 1.0 - z) / (z * z)
    start = dt * (growth - 1.0) / z - end
    c = np.empty((6, *poles.shape))
    c[0], c[1] = growth.real, growth.imag
    c[2], c[3] = (residues * start).real, (residues * start).imag
    c[4], c[5] = (residues * end).real, (residues * end).imag
    return c


@njit(cache=True, fastmath=True)
def _predict(
    er: FloatArray,
    ei: FloatArray,
    c: FloatArray,
    old: FloatArray,
    guess: FloatArray,
    r: FloatArray,
) -> None:
    """Step the modes in place with a guessed force, and add them to the motion."""
    for m in range(er.shape[0]):
        for k in range(er.shape[1]):
            x, y = er[m, k], ei[m, k]
            pull, push = old[k], guess[k]
            er[m, k] = c[0, m, k] * x - c[1, m, k] * y
            er[m, k] -= c[2, m, k] * pull + c[4, m, k] * push
            ei[m, k] = c[0, m, k] * y + c[1, m, k] * x
            ei[m, k] -= c[3, m, k] * pull + c[5, m, k] * push
            r[k] += er[m, k]


@njit(cache=True, fastmath=True)
def march(
    displacement: FloatArray,
    velocity: FloatArray,
    poles: ComplexArray,
    residues: ComplexArray,
    dt: float,
    law: int,
    p: FloatArray,
    slips: FloatArray,
    weights: FloatArray,
    tables: FloatArray,
    tops: FloatArray,
    extra: FloatArray,
) -> FloatArray:
    """Return the force of a law along the coupled motion.

    Args:
        displacement: linear motion across the link [m], shape (n_steps, n_records).
        velocity: its rate [m/s], same shape.
        poles: of the link's compliance [rad/s], shape (n_modes, n_records), one of
            each conjugate pair.
        residues: of it, doubled for a pair [m/N rad/s], same shape.
        dt: step [s].
        law: which of the force laws.
        p: its parameters.
        slips: slip displacements of the sliders [m], shape (n_sliders,).
        weights: stiffness of each slider [N/m], same shape.
        tables: of `slide`.
        tops: of `slide`.
        extra: force of other laws, known beforehand [N], shape as `displacement`.

    Returns:
        Force of this law [N], shape (n_steps, n_records).
    """
    n_steps, n_records = displacement.shape
    n_modes = poles.shape[0]
    out = np.zeros((n_steps, n_records))
    states = np.zeros((slips.size, n_records))
    c = _hold(poles, residues, dt)
    slope = np.sum(c[4] * poles.real - c[5] * poles.imag, axis=0)
    er, ei = np.zeros((n_modes, n_records)), np.zeros((n_modes, n_records))
    old, older = np.zeros(n_records), np.zeros(n_records)
    guess, before = np.zeros(n_records), np.zeros(n_records)
    r, v, force = np.zeros(n_records), np.zeros(n_records), np.zeros(n_records)
    moving = law == COULOMB or law == QUADRATIC_DAMPING or law == CURVES
    for i in range(n_steps):
        for k in range(n_records):
            guess[k] = 2.0 * old[k] - older[k]
            before[k] = r[k]
            r[k] = displacement[i, k]
        _predict(er, ei, c, old, guess, r)
        if moving:
            v[:] = velocity[i]
            for m in range(n_modes):
                for k in range(n_records):
                    v[k] += poles[m, k].real * er[m, k] - poles[m, k].imag * ei[m, k]
        _forces(
            law,
            p,
            r,
            v,
            slope,
            guess,
            before,
            states,
            slips,
            weights,
            tables,
            tops,
            force,
        )
        for k in range(n_records):
            out[i, k] = force[k]
            older[k] = old[k]
            old[k] = force[k] + extra[i, k]
        for m in range(n_modes):
            for k in range(n_records):
                change = old[k] - guess[k]
                er[m, k] -= c[4, m, k] * change
                ei[m, k] -= c[5, m, k] * change
    return out


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
        Tables, shape (4, TABLE_SIZE), and what `slide` wants with them, shape (6,).

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
    free = (IDENTITY * (sharpness + 1.0) / bend) ** (1.0 / sharpness)
    elastic = float(unloading == 0.0)
    tops = np.array([load[-1], u[-1], u[-1], unload[-1], min(free, 0.9), elastic])
    grid = np.linspace(0.0, 1.0, TABLE_SIZE)
    tables = np.stack(
        [
            np.interp(grid * tops[0], load, u),
            np.interp(grid * tops[1], u, load),
            np.interp(grid * tops[2], u, unload),
            np.interp(grid * tops[3], unload, u),
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
    np.ones(6),
)
