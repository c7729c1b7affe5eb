# SPDX-License-Identifier: MIT
"""Decays of one mode whose frequency and damping depend on amplitude.

With L = ln a: dL/dt = -zeta omega and dtheta/dt = omega, where ln omega and ln zeta are
sums of basis functions of S. S is L for a mode alone on its joint. Where other modes
work the same joint, 2 S = ln(exp(2 L) + sum of weight x square of their amplitudes),
with weights of their own for omega and for zeta.

A hit is a start and a phase; derivatives with respect to all parameters are integrals
along the decay (the equation for a change of L is linear and of first order).
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.basics.compiled import compiled
from jointbench.signal.amplitude.mode_state import ModeState
from jointbench.signal.amplitude.panels import Panels


@dataclass(frozen=True, slots=True, eq=False)
class Flow:
    """One mode's decay in each hit.

    Attributes:
        level: L, shape (n_hits, n_nodes).
        signal: at the centre frequency, shape (n_hits, n_nodes).
        pole: change of ln omega + i zeta from the softest amplitude, same shape.
        change: derivatives of ln signal with respect to the shared parameters, to the
            start and to the phase, shape (n_hits, n_nodes, n_shared + 2).
    """

    level: FloatArray
    signal: ComplexArray
    pole: ComplexArray
    change: ComplexArray


@dataclass(frozen=True, slots=True, eq=False)
class _Looked:
    """One curve looked up along the decays.

    Attributes:
        value: of the curve, shape (n_hits, n_nodes).
        slope: of the curve over L at constant squares, same shape.
        functions: of the basis, shape (n_hits, n_nodes, n_functions).
        by_weights: change of the curve with each ln weight, shape (n_hits, n_nodes,
            n_others).
    """

    value: FloatArray
    slope: FloatArray
    functions: FloatArray
    by_weights: FloatArray


def decays(mode: ModeState, panels: Panels, centre: float, power: int) -> Flow:
    """Follow a mode through all hits.

    Args:
        mode: its curves, starts and phases.
        panels: of time.
        centre: frequency whose phase is left out, at which exp(L) is the amplitude of
            the response [rad/s].
        power: derivatives of the response (2 for acceleration).
    """
    curves = (mode.basis.values @ mode.log_omega, mode.basis.values @ mode.log_zeta)
    level = np.empty((mode.start.size, panels.time.size))
    weights = np.exp(mode.log_weights)
    squares = np.broadcast_to(mode.squares, (*level.shape, mode.squares.shape[2]))
    grid = mode.basis.grid
    _follow(  # type: ignore[no-untyped-call]
        (grid[0], grid[1] - grid[0], centre),
        curves,
        mode.start,
        panels.time,
        (squares @ weights[0], squares @ weights[1]),
        level,
    )
    omega, zeta = (
        _looked_up(mode, curve, level, squares * weight)
        for curve, weight in zip(curves, weights, strict=True)
    )
    turn = panels.integral((centre * np.expm1(omega.value))[..., None])[..., 0]
    angle = mode.phase[:, None] + turn
    signal = np.exp(level + power * omega.value + 1j * angle)
    change = _changes(omega, zeta, panels, centre, power)
    soft = mode.basis.at(np.array([mode.basis.low]))[0]
    pole = omega.value - soft @ mode.log_omega
    turn = np.exp(zeta.value) - np.exp(soft @ mode.log_zeta)
    return Flow(level, signal, pole + 1j * turn, change)


def _looked_up(
    mode: ModeState, curve: FloatArray, level: FloatArray, squares: FloatArray
) -> _Looked:
    grid = mode.basis.grid
    step = grid[1] - grid[0]
    # Below the grid curves are constant.
    alone = np.exp(2.0 * np.maximum(level, grid[0]))
    total = alone + squares.sum(axis=2)
    # The share of the mode itself in the amplitude that counts: dS/dL.
    own = alone / total
    place = np.clip((0.5 * np.log(total) - grid[0]) / step, 0.0, grid.size - 1.000001)
    low = place.astype(int)
    part = place - low
    slopes = np.gradient(curve, step)
    slope = slopes[low] * (1.0 - part) + slopes[low + 1] * part
    below, above = mode.basis.values[low], mode.basis.values[low + 1]
    return _Looked(
        value=curve[low] * (1.0 - part) + curve[low + 1] * part,
        slope=slope * own,
        functions=below + part[..., None] * (above - below),
        by_weights=(0.5 * slope / total)[..., None] * squares,
    )


def _changes(
    omega: _Looked, zeta: _Looked, panels: Panels, centre: float, power: int
) -> ComplexArray:
    """Return the derivatives of ln signal, see `Flow`."""
    size, others = omega.functions.shape[2], omega.by_weights.shape[2]
    shared = 2 * (size + others)
    by_omega, by_zeta = (
        (slice(0, size), slice(2 * size, 2 * size + others)),
        (
            slice(size, 2 * size),
            slice(2 * size + others, shared),
        ),
    )
    # Changes of ln omega and of ln(zeta omega) at constant L.
    direct = np.zeros((*omega.value.shape, shared + 2))
    direct[..., by_omega[0]] = omega.functions
    direct[..., by_omega[1]] = omega.by_weights
    rate = centre * np.exp(omega.value + zeta.value)
    both = direct.copy()
    both[..., by_zeta[0]] = zeta.functions
    both[..., by_zeta[1]] = zeta.by_weights
    stiff = panels.integral((rate * (omega.slope + zeta.slope))[..., None])
    level = -np.exp(-stiff) * panels.integral(both * (rate[..., None] * np.exp(stiff)))
    level[..., shared] = np.exp(-stiff[..., 0])
    level[..., shared + 1] = 0.0
    relative = direct + omega.slope[..., None] * level
    turn = panels.integral((centre * np.exp(omega.value))[..., None] * relative)
    turn[..., shared + 1] = 1.0
    return np.asarray(level + power * relative + 1j * turn)


@compiled(nogil=True, error_model="numpy")
def _follow(  # type: ignore[no-untyped-def]
    numbers, curves, start, time, squares, level
):
    """Integrate L over time, all hits, by the classical Runge-Kutta method."""
    both = (numbers, curves)
    for hit in range(start.size):
        now, before = start[hit], 0.0
        for n in range(time.size):
            step = time[n] - before
            last = max(n - 1, 0)
            w0, w2 = squares[0][hit, last], squares[0][hit, n]
            z0, z2 = squares[1][hit, last], squares[1][hit, n]
            w1, z1 = np.sqrt(w0 * w2), np.sqrt(z0 * z2)
            k1 = _rate(now, w0, z0, both)  # type: ignore[no-untyped-call]
            k2 = _rate(now + 0.5 * step * k1, w1, z1, both)  # type: ignore[no-untyped-call]
            k3 = _rate(now + 0.5 * step * k2, w1, z1, both)  # type: ignore[no-untyped-call]
            k4 = _rate(now + step * k3, w2, z2, both)  # type: ignore[no-untyped-call]
            now += step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
            level[hit, n] = now
            before = time[n]


@compiled(nogil=True, error_model="numpy")
def _rate(level, omega_square, zeta_square, both):  # type: ignore[no-untyped-def]
    """Return dL/dt."""
    numbers, curves = both
    bottom, step, centre = numbers
    total = 0.0
    for which in range(2):
        square = zeta_square if which else omega_square
        at = level
        if square > 0.0:
            at = level + 0.5 * np.log1p(square * np.exp(-2.0 * level))
        curve = curves[which]
        place = min(max((at - bottom) / step, 0.0), curve.size - 1.000001)
        low = int(place)
        total += curve[low] + (place - low) * (curve[low + 1] - curve[low])
    return -centre * np.exp(total)
