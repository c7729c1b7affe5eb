# SPDX-License-Identifier: MIT
"""Compiled march of the nonlinear link force along a known linear motion.

Only the difference e between the motion with and without the effect is stepped, so
that a force law of amplitude 0 leaves the linear response untouched to the last bit.
The link's own compliance is a sum of modes, each stepped exactly for a force that is
a straight line within the step (first-order hold); the force at the end of a step is
found from the motion predicted with an extrapolated force, whose error is of the
order dt^2/m of a second difference and far below the noise.

All that a step calls is compiled into it: handing arrays over would cost more than the
step. Numba's cache looks only at the date of this file, so touch it after an edit of
`slider_march` or `curve_march`.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from jointbench.acquisition.arrays import ComplexArray, FloatArray, IntArray
from jointbench.analysis.gap.curve_march import curve_force
from jointbench.analysis.gap.slider_march import bank_forces

POLYNOMIAL = 0
ONE_SIDED = 1
SLIDERS = 2
COULOMB = 3
QUADRATIC_DAMPING = 4
CURVES = 5


class MarchLaw(NamedTuple):
    """A force law as the compiled march wants it.

    Attributes:
        kind: which law.
        p: its parameters.
        slips: slip displacements of its sliders [m], rising, shape (n_sliders,).
        weights: stiffness of each slider [N/m], same shape.
        tables: of its curves.
        tops: what goes with the tables.
    """

    kind: int
    p: FloatArray
    slips: FloatArray
    weights: FloatArray
    tables: FloatArray
    tops: FloatArray


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


@njit(cache=True, fastmath=True, inline="always")
def _forces(
    law: MarchLaw,
    r: FloatArray,
    v: FloatArray,
    slope: FloatArray,
    guess: FloatArray,
    before: FloatArray,
    states: FloatArray,
    active: IntArray,
    force: FloatArray,
) -> None:
    """Write the force of one law in every record; sliders move their states."""
    n, p = r.size, law.p
    if law.kind == POLYNOMIAL:
        for k in range(n):
            force[k] = r[k] * r[k] * (p[0] + p[1] * r[k])
    elif law.kind == ONE_SIDED:
        for k in range(n):
            force[k] = p[0] * max(r[k] - p[1], 0.0)
    elif law.kind == QUADRATIC_DAMPING:
        for k in range(n):
            force[k] = p[0] * v[k] * abs(v[k])
    elif law.kind == COULOMB:
        for k in range(n):
            force[k] = _rub(p[0], p[1], v[k], slope[k], guess[k])
    elif law.kind == CURVES:
        for k in range(n):
            force[k] = curve_force(law.tables, p, r[k], v[k])
    else:
        force[:] = 0.0
        bank_forces(
            r,
            before,
            states,
            active,
            law.slips,
            law.weights,
            law.tables,
            law.tops,
            force,
        )


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


@njit(cache=True, fastmath=True, inline="always")
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
    laws: tuple[MarchLaw, ...],
    needs_velocity: bool,
) -> FloatArray:
    """Return the force of all laws of a link along the coupled motion.

    Args:
        displacement: linear motion across the link [m], shape (n_steps, n_records).
        velocity: its rate [m/s], same shape; not looked at unless needed.
        poles: of the link's compliance [rad/s], shape (n_modes, n_records), one of
            each conjugate pair.
        residues: of it, doubled for a pair [m/N rad/s], same shape.
        dt: step [s].
        laws: that act together.
        needs_velocity: True where one of them looks at it.

    Returns:
        Force of the laws together [N], shape (n_steps, n_records).
    """
    n_steps, n_records = displacement.shape
    n_modes, n_laws = poles.shape[0], len(laws)
    out = np.zeros((n_steps, n_records))
    widest = 0
    for law in laws:
        widest = max(widest, law.slips.size)
    states = np.zeros((n_laws, n_records, widest, 2))
    active = np.zeros((n_laws, n_records), dtype=np.int64)
    c = _hold(poles, residues, dt)
    slope = np.sum(c[4] * poles.real - c[5] * poles.imag, axis=0)
    er, ei = np.zeros((n_modes, n_records)), np.zeros((n_modes, n_records))
    own, earlier = np.zeros((n_laws, n_records)), np.zeros((n_laws, n_records))
    hope = np.zeros((n_laws, n_records))
    old, guess, before = (
        np.zeros(n_records),
        np.zeros(n_records),
        np.zeros(n_records),
    )
    r, v = np.zeros(n_records), np.zeros(n_records)
    for i in range(n_steps):
        guess[:] = 0.0
        for a in range(n_laws):
            for k in range(n_records):
                hope[a, k] = 2.0 * own[a, k] - earlier[a, k]
                guess[k] += hope[a, k]
                earlier[a, k] = own[a, k]
        for k in range(n_records):
            before[k] = r[k]
            r[k] = displacement[i, k]
        _predict(er, ei, c, old, guess, r)
        if needs_velocity:
            v[:] = velocity[i]
            for m in range(n_modes):
                for k in range(n_records):
                    v[k] += poles[m, k].real * er[m, k] - poles[m, k].imag * ei[m, k]
        a = 0
        for law in laws:
            _forces(law, r, v, slope, hope[a], before, states[a], active[a], own[a])
            a += 1
        old[:] = 0.0
        for a in range(n_laws):
            for k in range(n_records):
                old[k] += own[a, k]
        out[i] = old
        for m in range(n_modes):
            for k in range(n_records):
                change = old[k] - guess[k]
                er[m, k] -= c[4, m, k] * change
                ei[m, k] -= c[5, m, k] * change
    return out
