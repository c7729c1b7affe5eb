# SPDX-License-Identifier: MIT
"""The curve of one fitted mode in physical amplitude, with its bands."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, freeze
from jointbench.signal.amplitude.amplitude_curve import (
    DAMPING_FLOOR,
    FREQUENCY_FLOOR,
    AmplitudeCurve,
)
from jointbench.signal.amplitude.band_fit import BandFit
from jointbench.signal.amplitude.mode_state import ModeState, curve_slices
from jointbench.signal.amplitude.model_errors import energy_share, model_errors
from jointbench.signal.amplitude.ring_downs import RingDowns

_POINTS = 40
# A point of the curve is shown where its frequency is known to this share of half the
# half-power width.
_KNOWN = 0.5
# Correction of the rate of a decay, at least.
_LEAST_FALL = -0.5
# Standard uncertainties by which a curve comes back where it turns round.
_CLEAR = 3.0


@dataclass(frozen=True, slots=True, eq=False)
class LevelCurve:
    """ln omega and ln zeta of a mode over L, with covariance.

    Attributes:
        level: ln of the amplitude at the largest channel, shape (n,).
        log_omega: shape (n,).
        log_zeta: shape (n,).
        omega_covariance: residual_ratio taken in, without floor, shape (n, n).
        zeta_covariance: likewise, shape (n, n).
        cross_covariance: of ln omega with ln zeta, likewise, shape (n, n).
        channel: index of the largest channel.
        inflation: factor of the residual ratio in the square roots of the covariances.
        omega_model_sd: of ln omega, what the model itself may be off, shape (n,).
        zeta_model_sd: of ln zeta, likewise, shape (n,).
    """

    level: FloatArray
    log_omega: FloatArray
    log_zeta: FloatArray
    omega_covariance: FloatArray
    zeta_covariance: FloatArray
    cross_covariance: FloatArray
    channel: int
    inflation: float
    omega_model_sd: FloatArray
    zeta_model_sd: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(
            self,
            "level",
            "log_omega",
            "log_zeta",
            "omega_covariance",
            "zeta_covariance",
            "cross_covariance",
            "omega_model_sd",
            "zeta_model_sd",
        )


def level_curve(fit: BandFit, number: int, points: int = _POINTS) -> LevelCurve:
    """Return the curve of one mode on an even grid of L that the data inform."""
    mode = fit.curved.modes[number]
    basis, own = mode.basis, curve_slices(fit.curved.modes)[number]
    level = np.linspace(basis.low, basis.high, points)
    values = basis.at(level)
    inflation = max(1.0, fit.curved.residual_ratio)
    covariance = fit.curved.covariance[own, own] * inflation**2
    size = basis.size
    relative, log_zeta = values @ mode.log_omega, values @ mode.log_zeta
    shapes, turned = _shapes(fit, mode, relative, np.exp(log_zeta))
    slope = np.gradient(relative, level)
    falls = np.gradient(turned, level)
    falls = falls + energy_share(relative, np.exp(log_zeta)) * slope
    errors = model_errors(fit, mode, level, slope)
    channel = int(np.argmax(np.abs(shapes[0])))
    return LevelCurve(
        level=level + np.log(np.abs(shapes[:, channel])) + fit.power * relative,
        log_omega=relative + np.log(fit.lines.centre),
        log_zeta=log_zeta + np.log1p(np.maximum(falls, _LEAST_FALL)),
        omega_covariance=values @ covariance[:size, :size] @ values.T,
        zeta_covariance=values @ covariance[size:, size:] @ values.T,
        cross_covariance=values @ covariance[:size, size:] @ values.T,
        channel=channel,
        inflation=inflation,
        omega_model_sd=errors[0],
        zeta_model_sd=errors[1],
    )


def _shapes(
    fit: BandFit, mode: ModeState, relative: FloatArray, zeta: FloatArray
) -> tuple[ComplexArray, FloatArray]:
    """Return the shape over L, and ln of its part along the softest shape.

    Damping is that of the modal amplitude, to whose shape at one amplitude the change
    is orthogonal (masses at the channels taken as equal). The amplitude of one channel
    falls faster or slower as the shape turns.
    """
    pole = relative - relative[0] + 1j * (zeta - zeta[0])
    turn = mode.turn if mode.turn.size else np.zeros_like(mode.shape)
    shapes = (mode.shape + pole[:, None] * turn) @ fit.lines.mixing.T
    along = np.abs(shapes @ shapes[0].conj())
    return np.asarray(shapes), np.asarray(np.log(along / along[0]))


def known_part(curve: LevelCurve) -> slice:
    """Return the points whose frequency is known well enough to be shown."""
    zeta = np.exp(curve.log_zeta)
    good = np.sqrt(np.diag(curve.omega_covariance)) < _KNOWN * zeta
    good &= np.sqrt(np.diag(curve.zeta_covariance)) < _KNOWN
    where = np.flatnonzero(good)
    if where.size == 0:
        return slice(0, 0)
    # One piece, from the hard end down.
    breaks = np.flatnonzero(np.diff(where) > 1)
    first = where[breaks[-1] + 1] if breaks.size else where[0]
    return slice(int(first), int(where[-1]) + 1)


def amplitude_curve(
    curve: LevelCurve, decays: RingDowns, shift: tuple[FloatArray, FloatArray]
) -> AmplitudeCurve | None:
    """Return the curve in physical units; None where nothing of it is known.

    Args:
        curve: of the mode.
        decays: name channels and unit.
        shift: how far ln omega and ln zeta move when the decays start later, shape
            (n,) each; it counts as one more standard uncertainty.
    """
    part = known_part(curve)
    level = curve.level[part]
    if level.size < 3 or np.any(np.diff(level) <= 0.0):
        return None
    zeta = np.exp(curve.log_zeta[part])
    natural = np.sqrt(1.0 + zeta**2)
    frequency = np.exp(curve.log_omega[part]) * natural / (2.0 * np.pi)
    own_f = np.sqrt(np.diag(curve.omega_covariance)[part])
    own_z = np.sqrt(np.diag(curve.zeta_covariance)[part])
    f_extra = shift[0][part] ** 2 + curve.omega_model_sd[part] ** 2
    z_extra = shift[1][part] ** 2 + curve.zeta_model_sd[part] ** 2
    f_sd = np.sqrt(own_f**2 + FREQUENCY_FLOOR**2 + f_extra)
    z_sd = np.sqrt(own_z**2 + DAMPING_FLOOR**2 + z_extra)
    return AmplitudeCurve(
        amplitude=np.exp(level),
        frequency=frequency,
        frequency_sd=frequency * f_sd,
        damping_ratio=zeta / natural,
        damping_sd=zeta / natural * z_sd,
        frequency_noise_sd=frequency * own_f / curve.inflation,
        damping_noise_sd=zeta / natural * own_z / curve.inflation,
        channel=decays.labels[curve.channel],
        unit=decays.unit,
    )


def shift_between(main: LevelCurve, later: LevelCurve) -> tuple[FloatArray, FloatArray]:
    """Return how far the curves of two fits differ, at the levels of the first.

    Above the levels of the second the difference at its hard end is kept.
    """
    part = known_part(later)
    if part.stop - part.start < 3:
        none = np.zeros(main.level.size)
        return none, none
    level = later.level[part]
    omega = np.interp(main.level, level, later.log_omega[part])
    zeta = np.interp(main.level, level, later.log_zeta[part])
    inside = np.clip(main.level, level[0], level[-1])
    own_omega = np.interp(inside, main.level, main.log_omega)
    own_zeta = np.interp(inside, main.level, main.log_zeta)
    return np.abs(omega - own_omega), np.abs(zeta - own_zeta)


def clear_turns(curve: LevelCurve) -> int:
    """Return how often frequency or damping turns round along the curve, the larger.

    A turn counts where the curve comes back by more than three standard uncertainties
    of the difference.
    """
    part = known_part(curve)
    return max(
        _turns(curve.log_omega[part], curve.omega_covariance[part, part]),
        _turns(curve.log_zeta[part], curve.zeta_covariance[part, part]),
    )


def _turns(value: FloatArray, covariance: FloatArray) -> int:
    """Return the turns of the longest chain of clear steps to and fro."""
    own = np.diag(covariance)
    variance = own[:, None] + own - 2.0 * covariance
    limit = _CLEAR * np.sqrt(np.maximum(variance, 1e-30))
    step = value - value[:, None]
    rises, falls = np.zeros(value.size, int), np.zeros(value.size, int)
    for now in range(1, value.size):
        before = slice(0, now)
        up = step[before, now] > limit[before, now]
        down = -step[before, now] > limit[before, now]
        rises[now] = np.max(falls[before][up] + 1, initial=0)
        falls[now] = np.max(rises[before][down] + 1, initial=0)
    longest = max(np.max(rises, initial=0), np.max(falls, initial=0))
    return max(int(longest) - 1, 0)
