# SPDX-License-Identifier: MIT
"""Compiled time integration of the nonlinear link force along a linear motion.

Only the difference between the motion with and without the effect is integrated, so
that a force law of amplitude 0 leaves the linear response unchanged to the last bit.
The link's compliance is a sum of modes, each integrated exactly for a force that is
linear within the step (first-order hold); the force at the end of a step is computed
from the motion predicted with an extrapolated force, whose error is of the order
dt^2/m of a second difference and far below the noise.

All functions called in a step are inlined: passing arrays would take longer than the
step itself.
"""

import math
from typing import NamedTuple

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, IntArray
from jointbench.acquisition.basics.compiled import compiled
from jointbench.analysis.gap.response.curve_integration import curve_force
from jointbench.analysis.gap.response.response_settings import RESPONSE
from jointbench.analysis.gap.response.slider_integration import (
    Bank,
    Sliders,
    bank_forces,
)

POLYNOMIAL = 0
ONE_SIDED = 1
SLIDERS = 2
COULOMB = 3
QUADRATIC_DAMPING = 4
CURVES = 5
LANES = RESPONSE.lanes

# The state of all lanes is in two plain arrays, each quantity at an offset that is a
# compile-time constant: with one array per quantity, a step takes twice as long.
_FORCE, _GUESS, _BEFORE, _MOTION, _SPEED, _SLOPE = (i * LANES for i in range(6))
"""Offsets of the force of all laws, its estimate, the last motion, the motion, its
rate, and the change of that rate per unit force within a step."""
_MODES = 6 * LANES
_REAL, _IMAGINARY, _TURN, _QUARTER, _START, _START_I, _END, _END_I, _POLE, _POLE_I = (
    i * LANES for i in range(10)
)
"""Offsets within a mode: its motion, growth, hold weights and pole (re, im)."""
_MODE = 10 * LANES
_OWN, _EARLIER, _EXTRAPOLATED = (i * LANES for i in range(3))
"""Offsets within a law: its force, that of the previous step, and the extrapolation."""
_LAW = 3 * LANES


class IntegrationLaws(NamedTuple):
    """All force laws of a link in the arrays of the time integration.

    Common arrays are used because passing each law as an array or a view would take
    longer at every step than its evaluation.

    Attributes:
        kinds: which laws, shape (n_laws,).
        p: their parameters, shape (n_laws, 2).
        ends: first slider of each law, and the end of the last, shape (n_laws + 1,).
        slips: slip displacements of the sliders [m], ascending within a law, shape
            (n_sliders,).
        weights: stiffness of each slider [N/m], same shape.
        tables: of sliders, four rows per law, shape (4 n_laws, n_points).
        tops: properties of these tables, see `slide`, shape (n_laws, 7).
        curves: of curve laws, three rows per law, shape (3 n_laws, n_points).
    """

    kinds: IntArray
    p: FloatArray
    ends: IntArray
    slips: FloatArray
    weights: FloatArray
    tables: FloatArray
    tops: FloatArray
    curves: FloatArray


@compiled()
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


@compiled(fastmath=True, inline="always")
def _forces(
    a: int,
    w: FloatArray,
    f: FloatArray,
    kinds: IntArray,
    p: FloatArray,
    curves: FloatArray,
) -> None:
    """Write the force of law `a`, other than a slider law, in every lane."""
    kind, first, second, own = kinds[a], p[a, 0], p[a, 1], a * _LAW + _OWN
    if kind == POLYNOMIAL:
        for k in range(LANES):
            r = w[_MOTION + k]
            f[own + k] = r * r * (first + second * r)
    elif kind == ONE_SIDED:
        for k in range(LANES):
            f[own + k] = first * max(w[_MOTION + k] - second, 0.0)
    elif kind == QUADRATIC_DAMPING:
        for k in range(LANES):
            f[own + k] = first * w[_SPEED + k] * abs(w[_SPEED + k])
    elif kind == COULOMB:
        for k in range(LANES):
            extrapolated = f[a * _LAW + _EXTRAPOLATED + k]
            f[own + k] = _rub(first, second, w[_SPEED + k], w[_SLOPE + k], extrapolated)
    elif kind == CURVES:
        for k in range(LANES):
            r, v = w[_MOTION + k], w[_SPEED + k]
            f[own + k] = curve_force(curves, 3 * a, first, second, r, v)


@compiled()
def _made_ready(poles: ComplexArray, residues: ComplexArray, dt: float) -> FloatArray:
    """Return the initial state of the lanes, at rest.

    Modes are scaled by their residues, so that a real part is a displacement; each is
    advanced by its growth and by first-order-hold weights.
    """
    w = np.zeros(_MODES + poles.shape[0] * _MODE)
    for m in range(poles.shape[0]):
        for k in range(LANES):
            at, pole = _MODES + m * _MODE + k, poles[m, k]
            z = pole * dt
            growth = np.exp(z)
            end = residues[m, k] * dt * (growth - 1.0 - z) / (z * z)
            start = residues[m, k] * dt * (growth - 1.0) / z - end
            w[at + _TURN], w[at + _QUARTER] = growth.real, growth.imag
            w[at + _START], w[at + _START_I] = start.real, start.imag
            w[at + _END], w[at + _END_I] = end.real, end.imag
            w[at + _POLE], w[at + _POLE_I] = pole.real, pole.imag
            w[_SLOPE + k] += end.real * pole.real - end.imag * pole.imag
    return w


@compiled(fastmath=True, inline="always")
def _predict(w: FloatArray, n_modes: int) -> None:
    """Advance the modes in place with an estimated force; add them to the motion."""
    for m in range(n_modes):
        at = _MODES + m * _MODE
        for k in range(LANES):
            x, y = w[at + _REAL + k], w[at + _IMAGINARY + k]
            turn, quarter = w[at + _TURN + k], w[at + _QUARTER + k]
            old, change = w[_FORCE + k], w[_GUESS + k]
            moved = turn * x - quarter * y
            moved -= w[at + _START + k] * old + w[at + _END + k] * change
            w[at + _IMAGINARY + k] = (
                turn * y
                + quarter * x
                - w[at + _START_I + k] * old
                - w[at + _END_I + k] * change
            )
            w[at + _REAL + k] = moved
            w[_MOTION + k] += moved


@compiled(fastmath=True)
def _integrate_lanes(
    displacement: FloatArray,
    velocity: FloatArray,
    w: FloatArray,
    laws: IntegrationLaws,
    needs_velocity: bool,
    first: int,
    out: FloatArray,
) -> None:
    """Integrate as many records as there are lanes, beginning at `first`."""
    n_modes, n_laws = (w.size - _MODES) // _MODE, laws.kinds.size
    states = np.zeros((LANES, laws.slips.size, 2))
    active = np.zeros((n_laws, LANES), dtype=np.int64)
    # Unpacked once: each access to a tuple changes a reference count.
    kinds, p, ends, slips, weights, tables, tops, curves = laws
    sliders, f = Sliders(slips, 1.0 / slips, weights), np.zeros(n_laws * _LAW)
    for i in range(displacement.shape[0]):
        for k in range(LANES):
            w[_GUESS + k] = 0.0
            w[_BEFORE + k] = w[_MOTION + k]
            w[_MOTION + k] = displacement[i, first + k]
        for a in range(n_laws):
            for k in range(LANES):
                at = a * _LAW + k
                f[at + _EXTRAPOLATED] = 2.0 * f[at + _OWN] - f[at + _EARLIER]
                f[at + _EARLIER] = f[at + _OWN]
                w[_GUESS + k] += f[at + _EXTRAPOLATED]
        _predict(w, n_modes)
        if needs_velocity:
            for k in range(LANES):
                w[_SPEED + k] = velocity[i, first + k]
            for m in range(n_modes):
                for k in range(LANES):
                    at = _MODES + m * _MODE + k
                    w[_SPEED + k] += w[at + _POLE] * w[at + _REAL]
                    w[_SPEED + k] -= w[at + _POLE_I] * w[at + _IMAGINARY]
        for a in range(n_laws):
            if kinds[a] == SLIDERS:
                bank = Bank(
                    law=a,
                    first=ends[a],
                    beyond=ends[a + 1],
                    lanes=LANES,
                    now=_MOTION,
                    last=_BEFORE,
                    force=a * _LAW + _OWN,
                )
                bank_forces(bank, w, f, states, active, sliders, tables, tops)
            else:
                _forces(a, w, f, kinds, p, curves)
        for k in range(LANES):
            w[_FORCE + k] = 0.0
        for a in range(n_laws):
            for k in range(LANES):
                w[_FORCE + k] += f[a * _LAW + _OWN + k]
        for k in range(LANES):
            out[i, first + k] = w[_FORCE + k]
            w[_GUESS + k] = w[_FORCE + k] - w[_GUESS + k]
        for m in range(n_modes):
            for k in range(LANES):
                at = _MODES + m * _MODE + k
                w[at + _REAL] -= w[at + _END] * w[_GUESS + k]
                w[at + _IMAGINARY] -= w[at + _END_I] * w[_GUESS + k]


@compiled(nogil=True)
def integrate_link_force(
    displacement: FloatArray,
    velocity: FloatArray,
    poles: ComplexArray,
    residues: ComplexArray,
    dt: float,
    laws: IntegrationLaws,
    needs_velocity: bool,
) -> FloatArray:
    """Integrate the force of all laws of a link along the coupled motion.

    Args:
        displacement: linear motion across the link [m], shape (n_steps, n_columns):
            one column per record, and zero columns up to a multiple of `LANES`.
        velocity: its rate [m/s], same shape; ignored unless needed.
        poles: of the link's compliance [rad/s], shape (n_modes, n_records), one of
            each conjugate pair.
        residues: of the compliance, doubled for a pair [m/N rad/s], same shape.
        dt: step [s].
        laws: that act together.
        needs_velocity: True if one of them depends on the velocity.

    Returns:
        Force of the laws together [N], shape (n_steps, n_columns).
    """
    n_modes, n_records = poles.shape
    out = np.empty(displacement.shape)
    for first in range(0, displacement.shape[1], LANES):
        count = min(LANES, n_records - first)
        own_poles = np.full((n_modes, LANES), -1.0 + 0.0j)
        own_residues = np.zeros((n_modes, LANES), dtype=np.complex128)
        # Copied in a loop: the shape check of a slice takes seconds to compile.
        for m in range(n_modes):
            for k in range(count):
                own_poles[m, k] = poles[m, first + k]
                own_residues[m, k] = residues[m, first + k]
        w = _made_ready(own_poles, own_residues, dt)
        _integrate_lanes(displacement, velocity, w, laws, needs_velocity, first, out)
    return out
