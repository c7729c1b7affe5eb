# SPDX-License-Identifier: MIT
"""Compiled force laws of ports that have no memory, for many records side by side.

The state of the records is in two plain arrays, in blocks of one value per record
(lane); the constants here are the offsets of these blocks. With one array per quantity,
a step of the integration takes twice as long.
"""

import math
from typing import NamedTuple

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.compiled import compiled
from jointbench.analysis.gap.response.curve_integration import curve_force
from jointbench.analysis.gap.response.response_settings import RESPONSE

POLYNOMIAL = 0
ONE_SIDED = 1
SLIDERS = 2
COULOMB = 3
QUADRATIC_DAMPING = 4
CURVES = 5
TWO_SIDED = 6
FIFTH_POWER = 7
POWER_DAMPING = 8
MOVING = (COULOMB, QUADRATIC_DAMPING, CURVES, POWER_DAMPING)
"""Laws that depend on the velocity."""
LANES = RESPONSE.lanes
_STILL = RESPONSE.still_speed

FORCE, GUESS, LAST, BEFORE, MOTION, SPEED, PACE = (i * LANES for i in range(7))
"""Offsets within a port: force of its laws, its estimate, the two last motions, the
motion, its rate, and the rate at the start of the step."""
SLOPE, HOLD = 7 * LANES, 8 * LANES
"""The change of the rate by a force of the port that rises to 1 N within a step, and by
one that is 1 N throughout."""
DEFECT, LEAN, SHIFT, SPREAD = (i * LANES for i in range(9, 13))
"""Where a force jumps or bends within a step: its mean and first moment over the step
less those of a straight line, and its first and second moment less those of the samples
of a band-limited signal. Moments are about the middle of a step of length 1."""
PORT = 13 * LANES
OWN, EARLIER, EXTRAPOLATED, DRIFT = (i * LANES for i in range(4))
"""Offsets within a law: its force, that of the previous step, the extrapolation, and,
for dry friction, the change of the speed in the last step by all else."""
LAW = 4 * LANES


class IntegrationLaws(NamedTuple):
    """All force laws at all ports in the arrays of the time integration.

    Common arrays are used because passing each law as an array or a view would take
    longer at every step than its evaluation.

    Attributes:
        kinds: which laws, shape (n_laws,).
        ports: port of each law, same shape.
        p: their parameters, shape (n_laws, 4).
        ends: first slider of each law, and the end of the last, shape (n_laws + 1,).
        slips: slip displacements of the sliders [m], ascending within a law, shape
            (n_sliders,).
        weights: stiffness of each slider [N/m], same shape.
        tables: of sliders, four rows per law, shape (4 n_laws, n_points).
        tops: properties of these tables, see `slide`, shape (n_laws, 7).
        curves: of curve laws, three rows per law, shape (3 n_laws, n_points).
        band_limited: True for samples of the band-limited force, False for the force at
            the instants themselves.
    """

    kinds: IntArray
    ports: IntArray
    p: FloatArray
    ends: IntArray
    slips: FloatArray
    weights: FloatArray
    tables: FloatArray
    tops: FloatArray
    curves: FloatArray
    band_limited: bool


@compiled(forceinline=True)
def sign_of(x: float) -> float:
    """Return tanh x, to 1e-16 of 1, in a third of the time of the library's."""
    return 1.0 - 2.0 / (math.exp(2.0 * x) + 1.0)


@compiled(error_model="numpy")
def rub(
    limit: float, width: float, v: float, slope: float, guess: float, start: float
) -> float:
    """Solve f = limit tanh((v - slope (f - guess)) / width), by safe Newton steps."""
    low, high = -abs(limit), abs(limit)
    force = start
    for _ in range(12):
        t = sign_of((v - slope * (force - guess)) / width)
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


@compiled(fastmath=True, forceinline=True)
def corner(before: float, now: float, edge: float) -> float:
    """Return the mean of max(r - edge, 0) over a step less that of its ends [m].

    The motion r is taken as a straight line; without this mean, each contact would
    leave an error of the order of the step squared that depends on its instant.
    """
    low, high = min(before, now), max(before, now)
    inside = max(edge - low, 0.0) * max(high - edge, 0.0)
    return -0.5 * inside / (high - low + 1e-300)


@compiled(fastmath=True, forceinline=True)
def force_of_real_joint(
    a: int, at: int, w: FloatArray, f: FloatArray, kinds: IntArray, p: FloatArray
) -> None:
    """Write the force of law `a`, one of the further laws, in every lane.

    It is apart from the others, which it would slow by a tenth; arguments as those of
    `force_without_memory`.
    """
    kind, first, second, third, own = kinds[a], p[a, 0], p[a, 1], p[a, 2], a * LAW + OWN
    if kind == TWO_SIDED:
        slope, rest = p[a, 3], first * (max(-second, 0.0) - max(third, 0.0))
        for k in range(LANES):
            r, before = w[at + MOTION + k], w[at + BEFORE + k]
            stops = max(r - second, 0.0) - max(third - r, 0.0)
            f[own + k] = first * stops - rest - slope * r
            corners = corner(before, r, second) - corner(before, r, third)
            w[at + DEFECT + k] += first * corners
            w[at + SPREAD + k] += 0.25 * first * corners
    elif kind == FIFTH_POWER:
        for k in range(LANES):
            r = w[at + MOTION + k]
            f[own + k] = r * r * r * (first + second * r * r)
    elif kind == POWER_DAMPING:
        for k in range(LANES):
            v = w[at + SPEED + k]
            size = math.sqrt(v * v + _STILL * _STILL)
            f[own + k] = first * (v / size) * (size / third) ** second


@compiled(fastmath=True, forceinline=True)
def force_without_memory(
    a: int,
    at: int,
    w: FloatArray,
    f: FloatArray,
    kinds: IntArray,
    p: FloatArray,
    curves: FloatArray,
) -> None:
    """Write the force of law `a`, other than a slider law, in every lane.

    Args:
        a: index of the law.
        at: offset of its port in `w`.
        w: state of the lanes, with motions and speeds.
        f: forces of the lanes; changed in place.
        kinds: of all laws.
        p: parameters of all laws.
        curves: tables of all laws given by curves.
    """
    kind, first, second, own = kinds[a], p[a, 0], p[a, 1], a * LAW + OWN
    if kind == POLYNOMIAL:
        for k in range(LANES):
            r = w[at + MOTION + k]
            f[own + k] = r * r * (first + second * r)
    elif kind == ONE_SIDED:
        for k in range(LANES):
            r, before = w[at + MOTION + k], w[at + BEFORE + k]
            f[own + k] = first * max(r - second, 0.0)
            bend = first * corner(before, r, second)
            w[at + DEFECT + k] += bend
            w[at + SPREAD + k] += 0.25 * bend
    elif kind == QUADRATIC_DAMPING:
        for k in range(LANES):
            v = w[at + SPEED + k]
            f[own + k] = first * v * abs(v)
    elif kind == COULOMB:
        for k in range(LANES):
            guess = f[a * LAW + EXTRAPOLATED + k]
            speed, slope = w[at + SPEED + k], w[at + SLOPE + k]
            start = first * sign_of(speed / second)
            f[own + k] = rub(first, second, speed, slope, guess, start)
    elif kind == CURVES:
        for k in range(LANES):
            r, v = w[at + MOTION + k], w[at + SPEED + k]
            f[own + k] = curve_force(curves, 3 * a, first, second, r, v)
