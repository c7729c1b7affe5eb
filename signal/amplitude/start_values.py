# SPDX-License-Identifier: MIT
"""Where a joint fit starts: linear modes, then curves from the ridges of decays."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.signal.amplitude.band_lines import BandLines
from jointbench.signal.amplitude.curve_basis import (
    CurveBasis,
    constant_basis,
    spline_basis,
)
from jointbench.signal.amplitude.curve_fit import fit_jointly
from jointbench.signal.amplitude.mode_state import JointFit, ModeState

# Least ratio of a decay to its noise over one e-fold of amplitude.
_LEAST_SNR = 3.0
# A linear mode starts no broader than this.
_MOST_ZETA = 0.2
# A curve needs at least this much of ln a.
_LEAST_SPAN = 0.7
# Hits and decays spread over no more of ln a than this: e^15 is 130 dB.
_WIDEST = 15.0
# Time over which a ridge's slope is taken, in time constants of the mode.
_RIDGE_WINDOW = 0.35
# A first curve keeps this close to the linear fit: ln omega, ln zeta.
_DIVERGED = (0.1, 1.5)
# A ridge is read where it stands this far above the noise.
_RIDGE_SNR = 5.0
# Smoothness of the first curves.
_FIRST_WEIGHT = 3.0
_POINTS = 240
# Share of chi-squared that the last step of a linear fit gains: curves follow.
_ROUGH = 1e-3


def linear_modes(
    lines: BandLines, poles: ComplexArray, power: int
) -> tuple[ModeState, ...]:
    """Return modes without dependence on amplitude, before any fit.

    Args:
        lines: of the band.
        poles: of the modes [rad/s], shape (n_modes,).
        power: derivatives of the response.
    """
    decays = np.exp((poles - 1j * lines.centre) * lines.time[:, None])
    columns = lines.transform @ decays
    solved = np.linalg.lstsq(
        columns, lines.data.reshape(-1, lines.omega.size).T, rcond=1e-9
    )[0]
    amplitude = solved.reshape(poles.size, *lines.data.shape[:2])
    return tuple(
        _linear_mode(lines, complex(pole), table, power)
        for pole, table in zip(poles, amplitude, strict=True)
    )


def _linear_mode(
    lines: BandLines, pole: complex, amplitude: ComplexArray, power: int
) -> ModeState:
    """Return one mode from the amplitude of each hit and virtual channel."""
    left, size, right = np.linalg.svd(amplitude, full_matrices=False)
    shape = right[0]
    reference = int(np.argmax(np.abs(shape)))
    factor = left[:, 0] * size[0] * shape[reference]
    omega = pole.imag
    log_omega = np.log(omega / lines.centre)
    start = np.log(np.maximum(np.abs(factor), 1e-300)) - power * log_omega
    zeta = min(-pole.real / omega, _MOST_ZETA)
    ranged = level_range(lines, start, zeta * omega, shape / shape[reference])
    return ModeState(
        basis=constant_basis(*ranged),
        log_omega=np.array([log_omega]),
        log_zeta=np.array([np.log(zeta)]),
        shape=shape / shape[reference],
        reference=reference,
        start=start,
        phase=np.angle(factor),
    )


def level_range(
    lines: BandLines, start: FloatArray, rate: float, shape: ComplexArray
) -> tuple[float, float, float]:
    """Return the bottom of the grid and the range of L that the data inform.

    Args:
        lines: of the band.
        start: L of each hit at time 0, shape (n_hits,).
        rate: decay rate [1/s].
        shape: of the virtual channels.
    """
    high = float(start.max())
    soft = max(float(start.min()), high - _WIDEST)
    fall = min(rate * lines.duration, _WIDEST)
    # The transform of a decay over one e-fold, from Parseval's theorem.
    gain = np.linalg.norm(lines.transform @ np.exp(-rate * lines.time))
    unit = gain * np.linalg.norm(shape) * np.sqrt(0.5 * (1.0 - np.exp(-2.0)))
    low = float(np.log(_LEAST_SNR / unit))
    low = min(max(low, soft - fall), high - _LEAST_SPAN)
    return min(soft - 2.0 * fall - 2.0, low - 1.0), low, high


def refresh_range(lines: BandLines, mode: ModeState) -> ModeState:
    """Return a linear mode with the range of L that its fit leaves."""
    rate = float(np.exp(mode.log_zeta[0] + mode.log_omega[0]) * lines.centre)
    basis = constant_basis(*level_range(lines, mode.start, rate, mode.shape))
    return replace(mode, basis=basis)


@dataclass(frozen=True, slots=True, eq=False)
class Ridge:
    """Points of instantaneous frequency and damping, all hits together.

    Attributes:
        level: L, shape (n,).
        log_omega: ln(omega / centre), shape (n,).
        zeta: [-], shape (n,).
        weight: of each, shape (n,).
    """

    level: FloatArray
    log_omega: FloatArray
    zeta: FloatArray
    weight: FloatArray


def curved_modes(
    lines: BandLines,
    linear: JointFit,
    which: Sequence[int],
    pitch: float,
    power: int,
    *,
    ridges: bool = True,
) -> tuple[ModeState, ...]:
    """Return modes with curves read off the ridges of the decays.

    Args:
        lines: of the band.
        linear: fit without dependence on amplitude.
        which: modes that get curves.
        pitch: distance of knots in L.
        power: derivatives of the response.
        ridges: False starts from the constants of the linear fit.
    """
    return tuple(
        _curved(lines, linear, number, pitch, power if ridges else None)
        if number in which
        else mode
        for number, mode in enumerate(linear.modes)
    )


def _curved(
    lines: BandLines,
    linear: JointFit,
    number: int,
    pitch: float,
    power: int | None,
) -> ModeState:
    mode = linear.modes[number]
    basis = mode.basis
    splines = spline_basis(float(basis.grid[0]), basis.low, basis.high, pitch)
    mode = replace(mode, turn=np.zeros_like(mode.shape))
    weights = (_FIRST_WEIGHT / 1e-8, _FIRST_WEIGHT / 1e-3)
    if power is None:
        flat = np.ones(splines.size)
        return replace(
            mode,
            basis=splines,
            log_omega=mode.log_omega * flat,
            log_zeta=mode.log_zeta * flat,
            weights=weights,
        )
    ridge = read_ridge(lines, linear, number, power)
    log_omega = _smooth(splines, ridge.level, ridge.log_omega, ridge.weight, mode, 0)
    good = ridge.zeta > 0
    log_zeta = _smooth(
        splines,
        ridge.level[good],
        np.log(ridge.zeta[good]),
        ridge.weight[good],
        mode,
        1,
    )
    return replace(
        mode,
        basis=splines,
        log_omega=log_omega,
        log_zeta=log_zeta,
        weights=weights,
    )


def _smooth(
    basis: CurveBasis,
    level: FloatArray,
    value: FloatArray,
    weight: FloatArray,
    mode: ModeState,
    which: int,
) -> FloatArray:
    """Return coefficients of a smooth curve through the points of a ridge."""
    constant = float((mode.log_omega, mode.log_zeta)[which][0])
    if level.size < basis.size:
        return np.full(basis.size, constant)
    values = basis.at(level)
    share = weight / weight.sum() * level.size
    matrix = (values * share[:, None]).T @ values
    matrix += _FIRST_WEIGHT * basis.penalty + 1e-6 * np.eye(basis.size)
    right = (values * share[:, None]).T @ (value - constant)
    curve = constant + np.linalg.solve(matrix, right)
    return np.asarray(
        np.clip(curve, constant - _DIVERGED[which], constant + _DIVERGED[which])
    )


def read_ridge(lines: BandLines, linear: JointFit, number: int, power: int) -> Ridge:
    """Read instantaneous frequency and damping off the band-limited decays.

    Other modes of the band are taken off as the linear fit has them, channels are
    combined by the shape of the mode; slopes of phase and of ln amplitude are taken
    over a third of a time constant.
    """
    mode = linear.modes[number]
    own = _own_lines(lines, linear, number)
    combined = np.einsum("v,hvm->hm", mode.shape.conj(), own)
    combined = combined / np.linalg.norm(mode.shape) ** 2
    width = lines.omega[-1] - lines.omega[0]
    x = (lines.omega - lines.omega.mean()) / (0.5 * width)
    taper = np.cos(0.5 * np.pi * x) ** 2
    time = np.linspace(0.0, lines.duration, _POINTS)
    back = np.exp(1j * np.outer(lines.omega - lines.centre, time))
    # The transform's scale undone, so that a slow signal comes back as it was.
    sum_to_signal = 2.0 * (lines.omega[1] - lines.omega[0]) / (2 * np.pi)
    rate_of_samples = 2.0 * np.abs(_gain(lines))
    signal = (combined * taper) @ back * sum_to_signal / rate_of_samples
    noise = sum_to_signal / rate_of_samples * np.sqrt(2.0 * np.sum(taper**2))
    noise /= np.linalg.norm(mode.shape)
    return _slopes(lines, mode, signal, time, noise, power)


def _gain(lines: BandLines) -> float:
    """Return half the sample rate: what the transform multiplies a second by."""
    row = lines.transform + lines.background @ (
        lines.background.conj().T @ lines.transform
    )
    return float(lines.omega.size and np.abs(row).sum(axis=1).max() / lines.duration)


def _own_lines(lines: BandLines, linear: JointFit, number: int) -> ComplexArray:
    """Return the data without the other modes of the band."""
    if len(linear.modes) == 1:
        return lines.data
    from_mode = model_of(lines, linear.modes[number])
    return np.asarray(linear.residual + from_mode)


def model_of(lines: BandLines, mode: ModeState) -> ComplexArray:
    """Return the lines of one linear mode, shape (n_hits, n_virtual, n_lines)."""
    pole = 1j * lines.centre * (np.exp(mode.log_omega[0]) - 1.0)
    pole -= np.exp(mode.log_zeta[0] + mode.log_omega[0]) * lines.centre
    row = lines.transform @ np.exp(pole * lines.time)
    factor = np.exp(mode.start + 1j * mode.phase)
    return np.asarray(factor[:, None, None] * mode.shape[:, None] * row)


def _slopes(
    lines: BandLines,
    mode: ModeState,
    signal: ComplexArray,
    time: FloatArray,
    noise: float,
    power: int,
) -> Ridge:
    rate = float(np.exp(mode.log_zeta[0] + mode.log_omega[0])) * lines.centre
    step = time[1] - time[0]
    half = max(2, round(0.5 * _RIDGE_WINDOW / rate / step))
    lag = np.arange(-half, half + 1)
    slope = lag / np.sum(lag**2) / step
    level = np.log(np.abs(signal) + 1e-300)
    phase = np.unwrap(np.angle(signal), axis=1)
    inside = slice(half, time.size - half)
    turn = np.array([np.convolve(p, slope[::-1], "valid") for p in phase])
    decay = -np.array([np.convolve(v, slope[::-1], "valid") for v in level])
    keep = level[:, inside] > np.log(_RIDGE_SNR * noise)
    # What is left of the taper's ringing is at both ends of the record.
    edge = round(4 * np.pi / (lines.omega[-1] - lines.omega[0]) / step)
    keep[:, : max(0, edge - half)] = False
    keep[:, max(0, keep.shape[1] - edge) :] = False
    omega = lines.centre + turn[keep]
    log_omega = np.log(np.maximum(omega, 0.2 * lines.centre) / lines.centre)
    weight = np.minimum((np.exp(level[:, inside][keep]) / noise) ** 2, 1e4)
    return Ridge(
        level=level[:, inside][keep] - power * log_omega,
        log_omega=log_omega,
        zeta=decay[keep] / omega,
        weight=weight,
    )


def fit_linear(
    lines: BandLines, poles: ComplexArray, power: int, enough: float = _ROUGH
) -> JointFit:
    """Fit modes that do not depend on amplitude, by default roughly."""
    fit = fit_jointly(lines, linear_modes(lines, poles, power), power, enough=enough)
    return replace(fit, modes=tuple(refresh_range(lines, m) for m in fit.modes))
