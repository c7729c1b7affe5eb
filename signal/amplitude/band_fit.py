# SPDX-License-Identifier: MIT
"""All modes of one band, without and with dependence on amplitude."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray
from jointbench.signal.amplitude.band_lines import BandLines, band_lines
from jointbench.signal.amplitude.curve_fit import JointFit, fit_jointly
from jointbench.signal.amplitude.noise_of_band import rewhitened
from jointbench.signal.amplitude.ring_downs import RingDowns
from jointbench.signal.amplitude.start_values import curved_modes, fit_linear

# Decays are taken this many time constants long: e^-12 is below any noise.
_TIME_CONSTANTS = 12.0
# Knots in ln a that are tried; the better by N ln chi2 + 2 edf is kept.
_PITCHES = (0.5, 0.25)


@dataclass(frozen=True, slots=True)
class Band:
    """Where modes are fitted together.

    Attributes:
        low: [Hz].
        high: [Hz].
        poles: of the modes [rad/s], where the fit starts.
        beside: poles whose flanks reach into the band [rad/s].
        slowest: least decay rate, that sets the length of the decays [1/s].
    """

    low: float
    high: float
    poles: tuple[complex, ...]
    beside: tuple[complex, ...]
    slowest: float


@dataclass(frozen=True, slots=True, eq=False)
class BandFit:
    """Both fits of one band.

    Attributes:
        lines: that were fitted.
        linear: modes that do not depend on amplitude.
        curved: modes that may.
        power: derivatives of the response.
    """

    lines: BandLines
    linear: JointFit
    curved: JointFit
    power: int

    @property
    def share_explained(self) -> float:
        """Part of the linear fit's excess residual that the curves remove [-]."""
        excess = self.linear.chi2 - self.linear.freedom
        if excess <= 0.0:
            return 1.0
        return float((self.linear.chi2 - self.curved.chi2) / excess)


def fit_band(decays: RingDowns, band: Band) -> BandFit:
    """Fit the modes of a band without and with dependence on amplitude.

    Args:
        decays: of all hits.
        band: its modes and those beside it.
    """
    lines, poles = _prepared(decays, band)
    power = decays.derivatives
    first = _curves(lines, fit_linear(lines, poles, power), _PITCHES[0], power)
    lines = rewhitened(lines, first.residual)
    linear = fit_linear(lines, poles, power)
    tried = [_curves(lines, linear, pitch, power) for pitch in _PITCHES]
    return BandFit(lines, linear, min(tried, key=_criterion), power)


def linear_residual(decays: RingDowns, band: Band) -> float:
    """Return chi-squared of linear modes, lines weighed by the noise of the tails.

    Args:
        decays: of all hits.
        band: its modes and those beside it.
    """
    lines, poles = _prepared(decays, band)
    return fit_linear(lines, poles, decays.derivatives).chi2


def curved_residual(fit: BandFit, decays: RingDowns, band: Band) -> float:
    """Return chi-squared of the curves of a fit, weighed as `linear_residual` does."""
    lines, _ = _prepared(decays, band)
    channels = np.einsum("cv,hvm->hcm", fit.lines.mixing, fit.curved.residual)
    weighed = np.linalg.pinv(lines.mixing) @ channels
    return float(np.sum(np.abs(weighed) ** 2))


def _prepared(decays: RingDowns, band: Band) -> tuple[BandLines, ComplexArray]:
    poles = np.array(band.poles, complex)
    lines = band_lines(
        decays,
        (band.low, band.high),
        duration=_TIME_CONSTANTS / band.slowest,
        beside=np.array(band.beside, complex),
        modes=poles.size,
    )
    return lines, poles


def _curves(lines: BandLines, linear: JointFit, pitch: float, power: int) -> JointFit:
    every = range(len(linear.modes))
    start = curved_modes(lines, linear, every, pitch, power)
    fit = fit_jointly(lines, start, power)
    if fit.chi2 <= linear.chi2:
        return fit
    # The ridges diverged: start from the straight lines of the linear fit.
    flat = curved_modes(lines, linear, every, pitch, power, ridges=False)
    again = fit_jointly(lines, flat, power)
    return min((fit, again), key=lambda one: one.chi2)


def _criterion(fit: JointFit) -> float:
    """Return N ln chi2 + 2 edf."""
    size = 2.0 * fit.residual.size
    used = float(np.sum(fit.covariance * fit.normal))
    return size * float(np.log(fit.chi2)) + 2.0 * used


def linear_poles(fit: JointFit, centre: float) -> ComplexArray:
    """Return the poles of a linear fit [rad/s], shape (n_modes,)."""
    omega = np.array([centre * np.exp(m.log_omega[0]) for m in fit.modes])
    zeta = np.array([np.exp(m.log_zeta[0]) for m in fit.modes])
    return np.asarray(omega * (-zeta + 1j))
