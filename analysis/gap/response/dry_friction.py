# SPDX-License-Identifier: MIT
"""Dry friction within one step of the time integration, at one port or several.

Dry friction is stiff: within a step its force changes the speed of its own port, and
that of every other port, by much more than the speed over which it changes sign. The
forces at the end of a step are therefore solved for together. Where a force switches,
the step is followed in pieces: with the instant of the switch, mean and first moment of
the force over the step are known, and the step need not be short.
"""

import math

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.compiled import compiled
from jointbench.analysis.gap.response.law_forces import (
    COULOMB,
    DEFECT,
    DRIFT,
    EARLIER,
    EXTRAPOLATED,
    HOLD,
    LANES,
    LAW,
    LEAN,
    OWN,
    PACE,
    PORT,
    SHIFT,
    SLOPE,
    SPEED,
    SPREAD,
    rub,
    sign_of,
)
from jointbench.analysis.gap.response.response_settings import RESPONSE

_SWEEPS = RESPONSE.friction_sweeps
_TOLERANCE = RESPONSE.friction_tolerance
_SWITCH = RESPONSE.friction_switch
_RIGID = RESPONSE.friction_rigid
_PIECES = RESPONSE.friction_pieces
_LAYER = RESPONSE.friction_layer
_FAR = RESPONSE.friction_far
_FASTEST = RESPONSE.table_speed


@compiled(forceinline=True)
def _exponential_weights(x: float) -> tuple[float, float, float]:
    """Return phi_1, phi_2 and phi_3 of an exponential integrator, for x <= 0."""
    if x > -0.02:
        third = (1.0 + x / 4.0 * (1.0 + x / 5.0 * (1.0 + x / 6.0))) / 6.0
        second = 0.5 + x * third
        return 1.0 + x * second, second, third
    first = math.expm1(x) / x
    second = (first - 1.0) / x
    return first, second, (second - 0.5) / x


@compiled(error_model="numpy")
def follow_switch(
    limit: float, width: float, start: float, drift: float, growth: float, hold: float
) -> tuple[float, float, float, float]:
    """Follow v' = drift(t) - hold limit tanh(v / width) over a step of length 1.

    Far from a speed of zero the force is constant; near it, each piece changes the
    speed by a part of `width`, and a speed that comes to rest there decays.

    Args:
        limit: largest force [N].
        width: speed over which the force changes its sign [m/s].
        start: speed at the start [m/s].
        drift: change of the speed by all else, on average over the step [m/s].
        growth: change of the drift over the step [m/s].
        hold: change of the speed by a force of 1 N throughout the step [m/s].

    Returns:
        Force at the end [N]; its mean, first and second moment over the step [N], about
        the middle of the step.

    Source:
        Hochbruck, Ostermann and Schweitzer 2009, SIAM J. Numer. Anal. 47, 786, the
        method exprb32 for a piece.
    """
    v, t, moment, second = start, 0.0, 0.0, 0.0
    bend = sign_of(v / width)
    for piece in range(_PIECES):
        rate = drift + growth * (t - 0.5) - hold * limit * bend
        steep, reach = 0.0, abs(v) - _FAR * width
        if reach < _LAYER * width:
            steep = -hold * limit * (1.0 - bend * bend) / width
            reach = _LAYER * width
        elif v * rate > 0.0:
            reach = 1e300
        h = 1.0 - t
        if piece < _PIECES - 1:
            h = min(h, reach / (abs(rate) + 1e-300))
        one, two, three = _exponential_weights(steep * h)
        grown = (one * rate + two * growth * h) * h
        changed = -hold * limit * (sign_of((v + grown) / width) - bend)
        grown += 2.0 * three * h * (changed - steep * grown)
        middle = t + 0.5 * h - 0.5
        force = (drift + growth * middle - grown / h) / hold
        v, t, before = v + grown, t + h, bend
        bend = sign_of(v / width)
        lean = limit * (bend - before) * h * h / 12.0
        moment += force * h * middle + lean
        second += force * h * (middle * middle + h * h / 12.0) + 2.0 * middle * lean
        if t >= 1.0 - 1e-12:
            break
    mean = (drift - (v - start)) / hold
    return limit * bend, mean, moment, second


@compiled(error_model="numpy")
def balance_friction(
    w: FloatArray,
    f: FloatArray,
    kinds: IntArray,
    ports: IntArray,
    p: FloatArray,
    coupled: int,
    n_ports: int,
) -> None:
    """Solve for the forces of all laws of dry friction, in every lane.

    The change of all speeds per unit force is a symmetric positive matrix for any
    reciprocal structure, and each force grows with its speed, so that solving for one
    force after the other converges.

    Args:
        w: state of the lanes, with the speeds predicted with extrapolated forces.
        f: forces of the lanes, solved for each law alone; changed in place.
        kinds: of all laws.
        ports: of all laws.
        p: parameters of all laws.
        coupled: offset of the changes of speed in `w`; only for several ports.
        n_ports: number of ports.
    """
    several = 0
    for a in range(kinds.size):
        several += kinds[a] == COULOMB
    for k in range(LANES):
        for _ in range(_SWEEPS if n_ports > 1 and several > 1 else 0):
            change = 0.0
            for a in range(kinds.size):
                if kinds[a] != COULOMB:
                    continue
                at, limit, width = ports[a] * PORT, p[a, 0], p[a, 1]
                v = _others_moved(w, f, kinds, ports, a, k, coupled, n_ports)
                guess, before = f[a * LAW + EXTRAPOLATED + k], f[a * LAW + OWN + k]
                force = rub(limit, width, v, w[at + SLOPE + k], guess, before)
                f[a * LAW + OWN + k] = force
                change = max(change, math.fabs(force - before) / (abs(limit) + 1e-300))
            if change < _TOLERANCE:
                break
        for a in range(kinds.size):
            own, limit = a * LAW + k, p[a, 0]
            if kinds[a] != COULOMB or limit == 0.0:
                continue
            force, before = f[own + OWN], f[own + EARLIER]
            at = ports[a] * PORT + k
            v = _others_moved(w, f, kinds, ports, a, k, coupled, n_ports)
            slope, hold, start = w[at + SLOPE], w[at + HOLD], w[at + PACE]
            drift = v - start + (hold - slope) * before
            drift += slope * f[own + EXTRAPOLATED]
            growth, f[own + DRIFT] = drift - f[own + DRIFT], drift
            small = abs(force - before) < _SWITCH * abs(limit)
            if small or slope * abs(limit) < _RIGID * p[a, 1]:
                continue
            if not abs(drift) + abs(growth) < _FASTEST:
                continue  # another law has run away; not a number fails as well
            force, mean, moment, second = follow_switch(
                limit, p[a, 1], start, drift, growth, hold
            )
            f[own + OWN] = force
            w[at + DEFECT] += mean - 0.5 * (before + force)
            w[at + LEAN] += moment - (force - before) / 12.0
            w[at + SHIFT] += moment - (force - before) / 6.0
            w[at + SPREAD] += second - (force + before) / 24.0


@compiled(forceinline=True)
def _others_moved(
    w: FloatArray,
    f: FloatArray,
    kinds: IntArray,
    ports: IntArray,
    a: int,
    k: int,
    coupled: int,
    n_ports: int,
) -> float:
    """Return the speed of a law's port, corrected for all other dry friction."""
    v = w[ports[a] * PORT + SPEED + k]
    for b in range(kinds.size):
        if n_ports > 1 and b != a and kinds[b] == COULOMB:
            across = (ports[a] * n_ports + ports[b]) * LANES
            away = f[b * LAW + OWN + k] - f[b * LAW + EXTRAPOLATED + k]
            v -= w[coupled + across + k] * away
    return float(v)
