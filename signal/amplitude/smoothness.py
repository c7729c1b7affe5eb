# SPDX-License-Identifier: MIT
"""What is known of curves before the data: they are smooth; weights of other modes.

The weights of the penalties maximise the marginal likelihood (Fellner and Schall): a
curve is as smooth as the data leave it.

Source:
    Wood and Fasiolo, A generalized Fellner-Schall method, Biometrics 73 (2017), eq. 2.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.signal.amplitude.curve_basis import CurveBasis
from jointbench.signal.amplitude.mode_state import ModeState, mode_slices

_PENALTY_RANGE = (1e-3, 1e9)
# ln of the weight of another mode's square: most likely value and standard deviation.
# A joint that both modes work alike gives 1 to 2; 0.01 to 20 are within two sd.
MOST_LIKELY_WEIGHT, _WEIGHT_SD = -0.7, 1.8
# Turn of a shape with the relative change of its pole, over its largest channel: about
# 1 where neighbours are as far away as the mode's own frequency.
_TURN_SD = 5.0


def penalty(modes: Sequence[ModeState], total: int) -> tuple[FloatArray, FloatArray]:
    """Return the penalty matrix and its gradient at the modes."""
    matrix, gradient = np.zeros((total, total)), np.zeros(total)
    for mode, own in zip(modes, mode_slices(modes), strict=True):
        for where, weight, value in _curves(mode, own.shared.start):
            matrix[where, where] += weight * mode.basis.penalty
            gradient[where] += weight * mode.basis.penalty @ value
        beside = np.arange(own.shared.start + 2 * mode.basis.size, own.shared.stop)
        matrix[beside, beside] += _WEIGHT_SD**-2
        gradient[beside] += (mode.log_weights.ravel() - MOST_LIKELY_WEIGHT) / (
            _WEIGHT_SD**2
        )
        if mode.turn.size:
            turn = mode.turn[mode.others]
            place = np.arange(own.shape.stop - 2 * turn.size, own.shape.stop)
            matrix[place, place] += _turn_weight(mode)
            gradient[place] += (
                _turn_weight(mode) * np.stack((turn.real, turn.imag), axis=1).ravel()
            )
    return matrix, gradient


def penalty_cost(modes: Sequence[ModeState]) -> float:
    """Return what the penalties add to chi-squared."""
    cost = 0.0
    for mode in modes:
        away = (mode.log_weights - MOST_LIKELY_WEIGHT) / _WEIGHT_SD
        cost += float(np.sum(away**2))
        cost += _turn_weight(mode) * float(np.sum(np.abs(mode.turn) ** 2))
        for _, weight, value in _curves(mode, 0):
            cost += weight * float(value @ mode.basis.penalty @ value)
    return cost


def _turn_weight(mode: ModeState) -> float:
    return float((_TURN_SD * np.abs(mode.shape).max()) ** -2)


def _curves(mode: ModeState, first: int) -> Iterator[tuple[slice, float, FloatArray]]:
    """Yield place, weight and coefficients of ln omega and of ln zeta."""
    size = mode.basis.size
    yield slice(first, first + size), mode.weights[0], mode.log_omega
    yield slice(first + size, first + 2 * size), mode.weights[1], mode.log_zeta


def reweighted(
    modes: tuple[ModeState, ...], normal: FloatArray, noise: float
) -> tuple[ModeState, ...]:
    """Return the modes with weights that raise the marginal likelihood.

    Args:
        modes: after a step.
        normal: J'J there.
        noise: square of the residual over that of the tails, at least 1.
    """
    if not any(mode.basis.rank for mode in modes):
        return modes
    covariance = inverse(normal + penalty(modes, normal.shape[0])[0])
    new = []
    for mode, own in zip(modes, mode_slices(modes), strict=True):
        weights = [
            _weight(mode.basis, weight, value, covariance[where, where], noise)
            for where, weight, value in _curves(mode, own.shared.start)
        ]
        new.append(replace(mode, weights=(weights[0], weights[1])))
    return tuple(new)


def _weight(
    basis: CurveBasis,
    weight: float,
    value: FloatArray,
    covariance: FloatArray,
    noise: float,
) -> float:
    """Return the next weight of one penalty (Fellner and Schall)."""
    if basis.rank == 0:
        return weight
    rough = float(value @ basis.penalty @ value) + 1e-300
    free = basis.rank - weight * float(np.sum(covariance * basis.penalty))
    wanted = noise * max(free, 1e-3) / rough
    bounded = float(np.clip(wanted, weight / 30.0, weight * 30.0))
    return float(np.clip(bounded, *_PENALTY_RANGE))


def largest_change(old: Sequence[ModeState], new: Sequence[ModeState]) -> float:
    """Return the largest change of the logarithm of a weight."""
    before = np.log([m.weights for m in old])
    after = np.log([m.weights for m in new])
    return float(np.abs(after - before).max())


def scales(matrix: FloatArray) -> FloatArray:
    """Return what brings the diagonal of a matrix to 1; finite where it is 0."""
    diagonal = np.diag(matrix)
    return np.asarray(1.0 / np.sqrt(diagonal + 1e-30 * diagonal.max() + 1e-300))


def inverse(matrix: FloatArray) -> FloatArray:
    """Invert a positive matrix after scaling it."""
    scale = scales(matrix)
    scaled = matrix * scale[:, None] * scale
    scaled[np.diag_indices_from(scaled)] += 1e-12
    return np.asarray(np.linalg.inv(scaled) * scale[:, None] * scale)
