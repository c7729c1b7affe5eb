# SPDX-License-Identifier: MIT
"""The joint fit: curves, shapes and every hit's start, to the lines of all hits.

Penalised least squares by damped Gauss-Newton steps. Real and imaginary parts of the
whitened lines have variance 1, so that the inverse of the normal matrix is the
covariance. The weights of the penalties maximise the marginal likelihood (Fellner and
Schall): a curve is as smooth as the data leave it.

Source:
    Wood and Fasiolo, A generalized Fellner-Schall method, Biometrics 73 (2017), eq. 2.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, IntArray
from jointbench.signal.amplitude.band_lines import BandLines
from jointbench.signal.amplitude.curve_basis import CurveBasis
from jointbench.signal.amplitude.slow_flow import decay_signal, master_decay

_STEPS = 25
# A step that gains less than this of chi-squared ends the fit.
_GAIN = 0.02
_DAMPING, _MOST_DAMPING = 1e-6, 1e4
_PENALTY_RANGE = (1e-3, 1e9)
# Damping ratios that a step may reach: beyond them no mode is a resonance.
_ZETA_RANGE = (1e-6, 0.5)


@dataclass(frozen=True, slots=True, eq=False)
class ModeState:
    """One mode's parameters.

    Attributes:
        basis: of both curves.
        log_omega: coefficients of ln(omega / centre), shape (n_functions,).
        log_zeta: coefficients of ln zeta, shape (n_functions,).
        shape: of the virtual channels, 1 at `reference`, shape (n_virtual,).
        reference: index of that channel.
        start: L of each hit at time 0, shape (n_hits,).
        phase: of each hit at time 0 [rad], shape (n_hits,).
        weights: of the penalties on ln omega and ln zeta.
    """

    basis: CurveBasis
    log_omega: FloatArray
    log_zeta: FloatArray
    shape: ComplexArray
    reference: int
    start: FloatArray
    phase: FloatArray
    weights: tuple[float, float] = (1.0, 1.0)


@dataclass(frozen=True, slots=True, eq=False)
class JointFit:
    """Modes fitted to a band.

    Attributes:
        modes: in the order given.
        residual: shape (n_hits, n_virtual, n_lines).
        normal: J'J, shape (n, n).
        gradient: J'r, shape (n,).
        covariance: of all parameters, shape (n, n); mode by mode the coefficients of
            ln omega and of ln zeta come first, see `curve_slices`.
        chi2: squares of the residual.
        freedom: degrees of freedom left.
    """

    modes: tuple[ModeState, ...]
    residual: ComplexArray
    normal: FloatArray
    gradient: FloatArray
    covariance: FloatArray
    chi2: float
    freedom: float

    @property
    def residual_ratio(self) -> float:
        """Rms residual over the noise of the tails [-]."""
        return float(np.sqrt(self.chi2 / max(self.freedom, 1.0)))


@dataclass(frozen=True, slots=True, eq=False)
class _Linear:
    """The model linearised: residual, normal matrix, gradient, chi-squared."""

    residual: ComplexArray
    normal: FloatArray
    gradient: FloatArray
    chi2: float


def curve_slices(modes: Sequence[ModeState]) -> tuple[slice, ...]:
    """Return where the coefficients of each mode's two curves are."""
    first, slices = 0, []
    for mode in modes:
        slices.append(slice(first, first + 2 * mode.basis.size))
        first += 2 * mode.basis.size
    return tuple(slices)


def fit_jointly(
    lines: BandLines,
    modes: Sequence[ModeState],
    power: int,
    *,
    steps: int = _STEPS,
) -> JointFit:
    """Fit all modes of a band to all hits.

    Args:
        lines: of the band.
        modes: where to start.
        power: derivatives of the response.
        steps: most steps tried; 0 only linearises.

    Raises:
        LinAlgError: the start gives no finite signal, or the fit is singular.
    """
    state, damping = tuple(modes), _DAMPING
    now = _linearise(lines, state, power)
    if not np.isfinite(now.chi2):
        raise np.linalg.LinAlgError("the fit cannot start: its signals overflow")
    for _ in range(steps):
        penalty, prior_gradient = _penalty(state, now.gradient.size)
        cost = now.chi2 + _penalty_cost(state)
        new, ahead, damping = _step(
            lines, state, power, now, (penalty, prior_gradient, cost), damping
        )
        if ahead is None:
            break
        gained = cost - ahead.chi2 - _penalty_cost(new)
        changed = _reweighted(new, ahead)
        moved = _largest_change(new, changed)
        state, now = changed, ahead
        if gained < _GAIN + 1e-7 * cost and moved < 0.3:
            break
    return _finished(lines, state, now)


def _step(
    lines: BandLines,
    state: tuple[ModeState, ...],
    power: int,
    now: _Linear,
    prior: tuple[FloatArray, FloatArray, float],
    damping: float,
) -> tuple[tuple[ModeState, ...], _Linear | None, float]:
    """Try steps with more and more damping until one gains."""
    penalty, prior_gradient, cost = prior
    matrix = now.normal + penalty
    while damping < _MOST_DAMPING:
        damped = matrix + damping * np.diag(np.diag(now.normal) + 1e-12)
        step = _solve(damped, now.gradient - prior_gradient)
        new = _moved(state, step)
        if new is not None:
            ahead = _linearise(lines, new, power)
            # Not a number is no gain.
            if ahead.chi2 + _penalty_cost(new) <= cost:
                return new, ahead, max(0.1 * damping, 1e-9)
        damping = max(10.0 * damping, 1e-4)
    return state, None, damping


def _solve(matrix: FloatArray, right: FloatArray) -> FloatArray:
    """Solve a scaled positive system; directions without information stay."""
    scale = 1.0 / np.sqrt(np.diag(matrix) + 1e-300)
    scaled = matrix * scale[:, None] * scale
    scaled[np.diag_indices_from(scaled)] += 1e-12
    try:
        factor = scipy.linalg.cho_factor(scaled)
        return np.asarray(scale * scipy.linalg.cho_solve(factor, scale * right))
    except np.linalg.LinAlgError:
        solved = np.linalg.lstsq(scaled, scale * right, rcond=1e-12)[0]
        return np.asarray(scale * solved)


def _linearise(lines: BandLines, modes: tuple[ModeState, ...], power: int) -> _Linear:
    """Return residual, J'J and J'r; derivatives run hit by hit."""
    columns = _columns(modes, lines.data.shape[0])
    total = sum(2 * m.basis.size + 2 * (m.shape.size - 1) for m in modes)
    total += 2 * len(modes) * lines.data.shape[0]
    normal, gradient = np.zeros((total, total)), np.zeros(total)
    residual = np.empty_like(lines.data)
    decays = [
        master_decay(m.basis, m.log_omega, m.log_zeta, lines.centre, power)
        for m in modes
    ]
    for hit, data in enumerate(lines.data):
        model, blocks = np.zeros_like(data), []
        for mode, decay in zip(modes, decays, strict=True):
            signal, change = decay_signal(
                decay, float(mode.start[hit]), float(mode.phase[hit]), lines.time
            )
            both = lines.transform @ np.concatenate((signal[:, None], change), axis=1)
            model += mode.shape[:, None] * both[:, 0]
            blocks.append(_jacobian(mode, both))
        residual[hit] = data - model
        jacobian = np.concatenate(blocks, axis=1)
        jacobian = np.concatenate((jacobian.real, jacobian.imag))
        flat = residual[hit].ravel()
        index = columns[hit]
        normal[np.ix_(index, index)] += jacobian.T @ jacobian
        gradient[index] += jacobian.T @ np.concatenate((flat.real, flat.imag))
    chi2 = float(np.sum(np.abs(residual) ** 2))
    return _Linear(residual, normal, gradient, chi2)


def _jacobian(mode: ModeState, both: ComplexArray) -> ComplexArray:
    """Return derivatives of all virtual channels: curves, start, phase, shape."""
    channels, n_lines = mode.shape.size, both.shape[0]
    size = both.shape[1] - 1
    table = np.zeros((channels, n_lines, size + 2 * (channels - 1)), complex)
    table[:, :, :size] = mode.shape[:, None, None] * both[:, 1:]
    others = [c for c in range(channels) if c != mode.reference]
    for number, channel in enumerate(others):
        table[channel, :, size + 2 * number] = both[:, 0]
        table[channel, :, size + 2 * number + 1] = 1j * both[:, 0]
    return table.reshape(channels * n_lines, -1)


def _columns(modes: Sequence[ModeState], hits: int) -> list[IntArray]:
    """Return for each hit where its columns belong among all parameters.

    All curves first, then all shapes, then start and phase, hit by hit.
    """
    curves = curve_slices(modes)
    first = curves[-1].stop
    shapes = []
    for mode in modes:
        size = 2 * (mode.shape.size - 1)
        shapes.append(np.arange(first, first + size))
        first += size
    table = []
    for hit in range(hits):
        parts: list[IntArray] = []
        for number, curve in enumerate(curves):
            own = first + 2 * (hit * len(modes) + number)
            parts += [
                np.arange(curve.start, curve.stop),
                np.array([own, own + 1]),
                shapes[number],
            ]
        table.append(np.concatenate(parts))
    return table


def _moved(
    modes: tuple[ModeState, ...], step: FloatArray
) -> tuple[ModeState, ...] | None:
    """Return the modes after a step; None where it leaves what is physical."""
    columns = _columns(modes, modes[0].start.size)
    moved, first = [], 0
    for mode in modes:
        size = 2 * mode.basis.size + 2 + 2 * (mode.shape.size - 1)
        own = [step[index[first : first + size]] for index in columns]
        first += size
        new = _mode_moved(mode, own)
        zeta = new.basis.values @ new.log_zeta
        omega = new.basis.values @ new.log_omega
        low, high = np.log(_ZETA_RANGE)
        if not (np.all((zeta > low) & (zeta < high)) and np.all(np.abs(omega) < 0.5)):
            return None
        moved.append(new)
    return tuple(moved)


def _mode_moved(mode: ModeState, own: Sequence[FloatArray]) -> ModeState:
    size = mode.basis.size
    shape = mode.shape.copy()
    others = [c for c in range(shape.size) if c != mode.reference]
    change = own[0][2 * size + 2 :]
    shape[others] += change[::2] + 1j * change[1::2]
    return replace(
        mode,
        log_omega=mode.log_omega + own[0][:size],
        log_zeta=mode.log_zeta + own[0][size : 2 * size],
        shape=shape,
        start=mode.start + [o[2 * size] for o in own],
        phase=mode.phase + [o[2 * size + 1] for o in own],
    )


def _penalty(modes: Sequence[ModeState], total: int) -> tuple[FloatArray, FloatArray]:
    """Return the penalty matrix and its gradient at the modes."""
    matrix, prior_gradient = np.zeros((total, total)), np.zeros(total)
    for mode, own in zip(modes, curve_slices(modes), strict=True):
        middle = own.start + mode.basis.size
        for where, weight, value in (
            (slice(own.start, middle), mode.weights[0], mode.log_omega),
            (slice(middle, own.stop), mode.weights[1], mode.log_zeta),
        ):
            matrix[where, where] += weight * mode.basis.penalty
            prior_gradient[where] += weight * mode.basis.penalty @ value
    return matrix, prior_gradient


def _penalty_cost(modes: Sequence[ModeState]) -> float:
    return sum(
        weight * float(value @ mode.basis.penalty @ value)
        for mode in modes
        for weight, value in zip(
            mode.weights, (mode.log_omega, mode.log_zeta), strict=True
        )
    )


def _reweighted(modes: tuple[ModeState, ...], now: _Linear) -> tuple[ModeState, ...]:
    """Return the modes with weights that raise the marginal likelihood."""
    if not any(mode.basis.rank for mode in modes):
        return modes
    penalty, _ = _penalty(modes, now.gradient.size)
    covariance = _inverse(now.normal + penalty)
    noise = max(1.0, now.chi2 / max(2.0 * now.residual.size, 1.0))
    new = []
    for mode, own in zip(modes, curve_slices(modes), strict=True):
        middle = own.start + mode.basis.size
        weights = [
            _weight(mode.basis, weight, value, covariance[where, where], noise)
            for where, weight, value in (
                (slice(own.start, middle), mode.weights[0], mode.log_omega),
                (slice(middle, own.stop), mode.weights[1], mode.log_zeta),
            )
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


def _largest_change(old: Sequence[ModeState], new: Sequence[ModeState]) -> float:
    """Return the largest change of the logarithm of a weight."""
    before = np.log([m.weights for m in old])
    after = np.log([m.weights for m in new])
    return float(np.abs(after - before).max())


def _inverse(matrix: FloatArray) -> FloatArray:
    """Invert a positive matrix after scaling it."""
    scale = 1.0 / np.sqrt(np.diag(matrix) + 1e-300)
    scaled = matrix * scale[:, None] * scale
    scaled[np.diag_indices_from(scaled)] += 1e-12
    return np.asarray(np.linalg.inv(scaled) * scale[:, None] * scale)


def _finished(lines: BandLines, modes: tuple[ModeState, ...], now: _Linear) -> JointFit:
    penalty, _ = _penalty(modes, now.gradient.size)
    covariance = _inverse(now.normal + penalty)
    used = float(np.sum(covariance * now.normal))
    return JointFit(
        modes=modes,
        residual=now.residual,
        normal=now.normal,
        gradient=now.gradient,
        covariance=covariance,
        chi2=now.chi2,
        freedom=lines.freedom - used,
    )
