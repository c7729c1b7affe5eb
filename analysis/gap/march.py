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

POLYNOMIAL = 0
ONE_SIDED = 1
SLIDERS = 2
COULOMB = 3
QUADRATIC_DAMPING = 4
TABLE_SIZE = 4096


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
        tops: upper ends of the four tables, shape (4,).

    Returns:
        The new state.
    """
    side = 1.0 if state > 0.0 or (state == 0.0 and step >= 0.0) else -1.0
    forward = side * step
    if forward >= 0.0:
        return side * min(abs(state) + forward, tops[0])
    u = _lookup(tables[0], tops[0], abs(state))
    left = _lookup(tables[2], tops[2], u) + forward
    if left < 0.0:
        return side * left
    u = _lookup(tables[3], tops[3], left)
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
        if abs(trial - force) < 1e-10 * (abs(limit) + 1e-300):
            return trial
        force = trial
    return force


@njit(cache=True)
def _force(
    law: int,
    p: FloatArray,
    r: float,
    v: float,
    slope: float,
    guess: float,
    states: FloatArray,
    trial: FloatArray,
    step: float,
    slips: FloatArray,
    weights: FloatArray,
    tables: FloatArray,
    tops: FloatArray,
) -> float:
    """Force of one law at displacement r and velocity v; sliders write `trial`."""
    if law == POLYNOMIAL:
        return float(p[0] * r * r + p[1] * r * r * r)
    if law == ONE_SIDED:
        return float(p[0] * (r - p[1])) if r > p[1] else 0.0
    if law == QUADRATIC_DAMPING:
        return float(p[0] * v * abs(v))
    if law == COULOMB:
        return _rub(p[0], p[1], v, slope, guess)
    total = -p[0] * r
    for i in range(slips.size):
        trial[i] = slide(states[i], step / slips[i], tables, tops)
        u = _lookup(tables[0], tops[0], abs(trial[i]))
        total += weights[i] * slips[i] * (u if trial[i] > 0.0 else -u)
    return float(total)


@njit(cache=True)
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
        displacement: linear motion across the link [m], shape (n_records, n_steps).
        velocity: its rate [m/s], same shape.
        poles: of the link's compliance [rad/s], shape (n_records, n_modes), one of
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
        Force of this law [N], shape (n_records, n_steps).
    """
    n_records, n_steps = displacement.shape
    n_modes = poles.shape[1]
    force = np.zeros((n_records, n_steps))
    states = np.zeros(slips.size)
    trial = np.zeros(slips.size)
    e = np.zeros(n_modes, dtype=np.complex128)
    growth = np.zeros(n_modes, dtype=np.complex128)
    start = np.zeros(n_modes, dtype=np.complex128)
    end = np.zeros(n_modes, dtype=np.complex128)
    for k in range(n_records):
        slope = 0.0
        for m in range(n_modes):
            z = poles[k, m] * dt
            growth[m] = np.exp(z)
            end[m] = dt * (growth[m] - 1.0 - z) / (z * z)
            start[m] = dt * (growth[m] - 1.0) / z - end[m]
            e[m] = 0.0
            slope += (residues[k, m] * poles[k, m] * end[m]).real
        states[:] = 0.0
        old, older, r_old = 0.0, 0.0, 0.0
        for i in range(n_steps):
            guess = 2.0 * old - older
            r, v = displacement[k, i], velocity[k, i]
            for m in range(n_modes):
                e[m] = growth[m] * e[m] - start[m] * old - end[m] * guess
                r += (residues[k, m] * e[m]).real
                v += (residues[k, m] * poles[k, m] * e[m]).real
            new = _force(
                law, p, r, v, slope, guess, states, trial,
                r - r_old, slips, weights, tables, tops,
            )
            force[k, i] = new
            total = new + extra[k, i]
            for m in range(n_modes):
                e[m] -= end[m] * (total - guess)
            for j in range(slips.size):
                states[j] = trial[j]
            older, old, r_old = old, total, r
    return force


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
        Tables of shape (4, TABLE_SIZE) and their upper ends, shape (4,).

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
    tops = np.array([load[-1], u[-1], u[-1], unload[-1]])
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
    np.ones(4),
)
