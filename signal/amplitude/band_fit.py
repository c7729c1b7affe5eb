# SPDX-License-Identifier: MIT
"""All modes of one band, without and with dependence on amplitude."""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray
from jointbench.signal.amplitude.band_lines import BandLines, band_lines
from jointbench.signal.amplitude.curve_fit import fit_jointly
from jointbench.signal.amplitude.mode_state import JointFit, ModeState, curve_slices
from jointbench.signal.amplitude.noise_of_band import rewhitened
from jointbench.signal.amplitude.other_starts import (
    begun_later,
    carried_over,
    with_knots,
)
from jointbench.signal.amplitude.ring_downs import RingDowns
from jointbench.signal.amplitude.start_values import (
    curved_modes,
    fit_linear,
    refresh_range,
)

# Decays are taken this many time constants long: e^-12 is below any noise.
_TIME_CONSTANTS = 12.0
# Knots in ln a that are tried in turn, while N ln chi2 + 2 edf falls. The finest ones
# follow the onset of slip or contact at 80 dB (docs/decisions/0191).
_PITCHES = (0.5, 0.25, 0.12, 0.06)
# Finer knots are tried where a curve uses this share of its functions.
_STIFF = 0.5
# The finest knots are tried where the last ones left this share of chi-squared at most:
# where the model itself does not hold, they cost much and help little.
_HELPED = 0.5
# First curves: the last step gains this share; above this residual ratio a second
# start is tried.
_NEAR, _POOR = 1e-3, 3.0
# Below this residual ratio of linear modes the tails hold more than noise.
_DEAF = 0.5
# Linear modes that curves are compared with: the last step gains this share.
_SETTLED = 1e-6


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
    power = decays.derivatives
    lines, linear = _heard(*_prepared(decays, band), power)
    curved = _curves(lines, linear, power)
    quiet = rewhitened(lines, curved.residual)
    linear = _again(quiet, carried_over(linear.modes, lines, quiet), power)
    linear = _ranged(quiet, linear)
    start = carried_over(curved.modes, lines, quiet)
    start = tuple(
        with_knots(mode, own.basis, _PITCHES[0])
        for mode, own in zip(start, linear.modes, strict=True)
    )
    curved = fit_jointly(quiet, start, power)
    return _refined(BandFit(quiet, linear, curved, power))


def _heard(
    lines: BandLines, poles: ComplexArray, power: int
) -> tuple[BandLines, JointFit]:
    """Return lines whose noise hides no decay, and the linear fit to them.

    A record that ends before its decays do has them in its tail. Taken for noise they
    leave a first fit without any weight: it would end wherever rounding leads it.
    """
    linear = fit_linear(lines, poles, power)
    if linear.residual_ratio > _DEAF:
        return lines, linear
    quiet = rewhitened(lines, linear.residual)
    linear = _again(quiet, carried_over(linear.modes, lines, quiet), power)
    return quiet, _ranged(quiet, linear)


def _ranged(lines: BandLines, linear: JointFit) -> JointFit:
    """Return a linear fit with the ranges of L that its noise leaves."""
    modes = tuple(refresh_range(lines, mode) for mode in linear.modes)
    return replace(linear, modes=modes)


def _refined(fit: BandFit) -> BandFit:
    """Return the fit with finer knots, as far as they explain more.

    The noise is estimated again after each refinement: what coarse knots left late in
    the decays counted as noise.
    """
    for pitch in _PITCHES[1:]:
        if not _is_stiff(fit.curved):
            break
        finer = tuple(
            with_knots(mode, own.basis, pitch)
            for mode, own in zip(fit.curved.modes, fit.linear.modes, strict=True)
        )
        tried = fit_jointly(fit.lines, finer, fit.power)
        if criterion(tried) >= criterion(fit.curved):
            break
        helped = tried.chi2 < _HELPED * fit.curved.chi2
        fit = _requieted(replace(fit, curved=tried))
        if not helped:
            break
    return fit


def _requieted(fit: BandFit) -> BandFit:
    """Return both fits with the noise that the curves leave."""
    lines = rewhitened(fit.lines, fit.curved.residual)
    linear, curved = (
        fit_jointly(lines, carried_over(one.modes, fit.lines, lines), fit.power)
        for one in (fit.linear, fit.curved)
    )
    return replace(fit, lines=lines, linear=_ranged(lines, linear), curved=curved)


def fit_later(decays: RingDowns, band: Band, first: BandFit, delay: float) -> BandFit:
    """Fit the same modes to the same decays from a later start.

    Args:
        decays: of all hits, as `first` had them.
        band: the same.
        first: the fit from the earlier start, where this one begins.
        delay: by which the decays start later [s].
    """
    lines = _prepared(decays.later(delay), band, like=first.lines)[0]
    power = decays.derivatives
    skipped = round(delay * decays.sample_rate) / decays.sample_rate
    linear, curved = (
        _again(
            lines,
            carried_over(
                tuple(begun_later(m, first.lines, lines, skipped) for m in fit.modes),
                first.lines,
                lines,
            ),
            power,
        )
        for fit in (first.linear, first.curved)
    )
    return BandFit(lines, linear, curved, power)


def _again(lines: BandLines, modes: tuple[ModeState, ...], power: int) -> JointFit:
    return fit_jointly(lines, modes, power)


def linear_residual(decays: RingDowns, band: Band) -> float:
    """Return chi-squared of linear modes, lines weighed by the noise of the tails.

    Args:
        decays: of all hits.
        band: its modes and those beside it.
    """
    lines, poles = _prepared(decays, band)
    return fit_linear(lines, poles, decays.derivatives, enough=_SETTLED).chi2


def curved_residual(fit: BandFit, decays: RingDowns, band: Band) -> float:
    """Return chi-squared of the curves of a fit, weighed as `linear_residual` does."""
    lines, _ = _prepared(decays, band)
    channels = np.einsum("cv,hvm->hcm", fit.lines.mixing, fit.curved.residual)
    weighed = lines.reduction @ channels
    return float(np.sum(np.abs(weighed) ** 2))


def _prepared(
    decays: RingDowns, band: Band, like: BandLines | None = None
) -> tuple[BandLines, ComplexArray]:
    poles = np.array(band.poles, complex)
    lines = band_lines(
        decays,
        (band.low, band.high),
        duration=_TIME_CONSTANTS / band.slowest,
        beside=np.array(band.beside, complex),
        modes=poles.size,
        like=like,
    )
    return lines, poles


def _curves(lines: BandLines, linear: JointFit, power: int) -> JointFit:
    """Return first curves: from the ridges, from straight lines where these diverge."""
    every = range(len(linear.modes))
    flat, ridges = (
        curved_modes(lines, linear, every, _PITCHES[0], power, ridges=ridges)
        for ridges in (False, True)
    )
    starts = [flat]
    try:
        first = fit_jointly(lines, ridges, power, steps=0)
    except np.linalg.LinAlgError:
        first = None
    if first is not None:
        starts.insert(0 if first.chi2 < linear.chi2 else 1, ridges)
    fit = fit_jointly(lines, starts[0], power, enough=_NEAR)
    if fit.residual_ratio > _POOR and len(starts) > 1:
        other = fit_jointly(lines, starts[1], power, enough=_NEAR)
        fit = min((fit, other), key=lambda one: one.chi2)
    return fit


def _is_stiff(fit: JointFit) -> bool:
    """Return whether a curve uses so many functions that finer knots may help."""
    used = np.diag(fit.covariance @ fit.normal)
    for mode, own in zip(fit.modes, curve_slices(fit.modes), strict=True):
        size = mode.basis.size
        for part in (used[own][:size], used[own][size:]):
            if part.sum() > _STIFF * size:
                return True
    return False


def criterion(fit: JointFit) -> float:
    """Return N ln chi2 + 2 edf."""
    size = 2.0 * fit.residual.size
    used = float(np.sum(fit.covariance * fit.normal))
    return size * float(np.log(fit.chi2)) + 2.0 * used
