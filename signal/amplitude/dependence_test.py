# SPDX-License-Identifier: MIT
"""Does a mode depend on its amplitude? A score test, and what it must not be fooled by.

The score test asks whether slope and curvature of ln omega and ln zeta over ln a would
gain more than white noise allows. It sees a softening of a hundredth of a percent, and
fires just as well on a neighbour that was left out. So three outcomes: a dependence is
reported only where it is large enough to matter, the curve explains the residual that
the linear mode leaves, what is left is nearly white, the finding survives a later
start, and the levels disagree as well when they are compared without any model.
"""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.tail_probabilities import chi2_above
from jointbench.signal.amplitude.amplitude_curve import Dependence
from jointbench.signal.amplitude.band_fit import BandFit
from jointbench.signal.amplitude.curve_basis import slope_basis
from jointbench.signal.amplitude.curve_fit import fit_jointly
from jointbench.signal.amplitude.curve_of_fit import LevelCurve, known_part
from jointbench.signal.amplitude.mode_state import ModeState, curve_slices

CHANCE = 0.01
"""A linear mode in white noise is taken for a dependent one this often."""
# Changes that matter: of frequency in halves of the half-power width, of damping.
_FREQUENCY_EFFECT, _DAMPING_EFFECT = 0.1, 0.05
# Share of the linear fit's excess that the curve must remove, where there is excess.
_EXPLAINED, _EXCESS = 0.8, 1.1
LARGEST_RESIDUAL_RATIO = 2.0
"""Rms residual over noise above which a residual is not white."""
# A change must stand this many standard uncertainties from none.
_CLEAR = 3.0
# A joint's law turns frequency or damping round once or twice; a beat with a neighbour
# that was not resolved does so every period.
_MOST_TURNS = 3
# A later start may change the change by this share of it.
_KEPT = 0.5
# Ends of the curve between which the change is taken, as shares of its points: the
# pair whose differences stand out most.
_SOFT_ENDS, _HARD_ENDS = (0.05, 0.5), (0.75, 0.97)


@dataclass(frozen=True, slots=True)
class Change:
    """What changes from soft to hard.

    Attributes:
        frequency: over the frequency [-].
        frequency_sd: its standard uncertainty [-].
        damping: of the damping ratio [-].
        damping_sd: its standard uncertainty [-].
        zeta: damping ratio at the soft end [-].
        levels: L of both ends.
    """

    frequency: float
    frequency_sd: float
    damping: float
    damping_sd: float
    zeta: float
    levels: tuple[float, float]

    @property
    def matters(self) -> bool:
        """True where the change is clear and more than a tenth of a bandwidth."""
        large = abs(self.frequency) > _FREQUENCY_EFFECT * self.zeta
        other = abs(self.damping) > _DAMPING_EFFECT * self.zeta
        frequency, damping = self._clear
        return (large and frequency) or (other and damping)

    @property
    def clear(self) -> bool:
        """True where frequency or damping changes by more than the uncertainty."""
        return any(self._clear)

    @property
    def _clear(self) -> tuple[bool, bool]:
        return (
            abs(self.frequency) > _CLEAR * self.frequency_sd,
            abs(self.damping) > _CLEAR * self.damping_sd,
        )


@dataclass(frozen=True, slots=True)
class DependenceEvidence:
    """What the outcome rests on.

    Attributes:
        chance: of the score test [-].
        explained: share of the excess residual that the curves remove [-].
        linear_residual_ratio: rms residual over noise without dependence [-].
        residual_ratio: the same with it [-].
        change: from soft to hard, None where no curve is known.
        later: the same with a later start.
        levels: chance that the levels differ as much in a linear structure, compared
            without a model of the decay; None where that could not be asked.
        levels_words: why it could not, or empty.
        turns: how often the curve clearly turns round.
    """

    chance: float
    explained: float
    linear_residual_ratio: float
    residual_ratio: float
    change: Change | None
    later: Change | None
    levels: float | None
    levels_words: str
    turns: int = 0


def score_chance(fit: BandFit, number: int) -> float:
    """Return the chance that a linear mode in white noise shows as much [-].

    Args:
        fit: of the band.
        number: of the mode.
    """
    modes = tuple(
        _bent(mode) if i == number else mode for i, mode in enumerate(fit.linear.modes)
    )
    bent = fit_jointly(fit.lines, modes, fit.power, steps=0)
    first = curve_slices(modes)[number].start
    # Constant, slope, curvature of ln omega, then of ln zeta.
    asked = first + np.array([1, 2, 4, 5])
    step = (bent.covariance @ bent.gradient)[asked]
    information = np.linalg.inv(bent.covariance[np.ix_(asked, asked)])
    return chi2_above(float(step @ information @ step), asked.size)


def _bent(mode: ModeState) -> ModeState:
    basis = slope_basis(float(mode.basis.grid[0]), mode.basis.low, mode.basis.high)
    none = np.zeros(2)
    return replace(
        mode,
        basis=basis,
        log_omega=np.append(mode.log_omega, none),
        log_zeta=np.append(mode.log_zeta, none),
    )


def change_of(
    curve: LevelCurve, levels: tuple[float, float] | None = None
) -> Change | None:
    """Return what changes between two levels, or along the curve.

    Args:
        curve: of the mode.
        levels: L of both ends; None for almost the whole curve.
    """
    part = known_part(curve)
    if part.stop - part.start < 3:
        return None
    if levels is None:
        soft, hard = _clearest(curve, part)
    else:
        ends = [int(np.argmin(np.abs(curve.level - level))) for level in levels]
        soft, hard = (min(max(end, part.start), part.stop - 1) for end in ends)
    log_zeta, zeta = curve.log_zeta, np.exp(curve.log_zeta)
    return Change(
        frequency=float(curve.log_omega[hard] - curve.log_omega[soft]),
        frequency_sd=_difference_sd(curve.omega_covariance, soft, hard),
        damping=float(zeta[hard] - zeta[soft]),
        damping_sd=float(np.exp(log_zeta[soft]))
        * _difference_sd(curve.zeta_covariance, soft, hard),
        zeta=float(zeta[soft]),
        levels=(float(curve.level[soft]), float(curve.level[hard])),
    )


def _clearest(curve: LevelCurve, part: slice) -> tuple[int, int]:
    """Return the soft and the hard end whose differences stand out most."""
    last = part.stop - part.start - 1
    softs, hards = (
        range(part.start + round(low * last), part.start + round(high * last) + 1)
        for low, high in (_SOFT_ENDS, _HARD_ENDS)
    )

    def stands_out(pair: tuple[int, int]) -> float:
        soft, hard = pair
        turn = (curve.log_omega[hard] - curve.log_omega[soft]) / _difference_sd(
            curve.omega_covariance, soft, hard
        )
        fall = (curve.log_zeta[hard] - curve.log_zeta[soft]) / _difference_sd(
            curve.zeta_covariance, soft, hard
        )
        return float(turn**2 + fall**2)

    pairs = [(soft, hard) for soft in softs for hard in hards]
    return max(pairs, key=stands_out)


def _difference_sd(covariance: FloatArray, one: int, other: int) -> float:
    variance = (
        covariance[one, one] + covariance[other, other] - 2.0 * covariance[one, other]
    )
    return float(np.sqrt(max(variance, 1e-30)))


def decide(found: DependenceEvidence) -> tuple[Dependence, str]:
    """Return the outcome and its reason."""
    change = found.change
    if change is None:
        if found.residual_ratio > LARGEST_RESIDUAL_RATIO:
            return Dependence.NOT_DECIDED, _not_white(found)
        return Dependence.NOT_DECIDED, "the decays do not stand out of the noise"
    if found.chance > CHANCE:
        return Dependence.NONE, (
            f"slopes over amplitude are those of noise (chance {found.chance:.2g})"
        )
    if not change.matters:
        if found.residual_ratio > LARGEST_RESIDUAL_RATIO:
            return Dependence.NOT_DECIDED, _not_white(found)
        return Dependence.NONE, (
            f"frequency changes by {100 * change.frequency:+.2g} %, damping by "
            f"{100 * change.damping / change.zeta:+.2g} %: less than a tenth of half "
            "the half-power width and 5 %, or not clear of its uncertainty"
        )
    for doubt in _doubts(found, change):
        return Dependence.NOT_DECIDED, doubt
    return Dependence.DEPENDS, (
        f"score test {found.chance:.2g}, levels {found.levels:.2g}; the curve removes "
        f"{100 * found.explained:.0f} % of the excess residual"
    )


def curve_holds(found: DependenceEvidence) -> bool:
    """Return whether nothing speaks against the curve itself.

    False where much of the excess residual stays, or where a later start gives another
    change: a neighbour may be missing, and the band of the curve does not know it. A
    beat is no function of amplitude.
    """
    if found.turns > _MOST_TURNS:
        return False
    unexplained = found.linear_residual_ratio > _EXCESS and found.explained < _EXPLAINED
    change = found.change
    if unexplained or change is None or found.later is None:
        return not unexplained
    return not change.matters or _same(change, found.later)


def _doubts(found: DependenceEvidence, change: Change) -> tuple[str, ...]:
    """Return what speaks against a dependence that the score test reports."""
    words = []
    if found.residual_ratio >= LARGEST_RESIDUAL_RATIO:
        words.append(_not_white(found))
    if found.linear_residual_ratio > _EXCESS and found.explained < _EXPLAINED:
        words.append(
            f"residual not white: curves remove {100 * found.explained:.0f} % of the "
            f"excess only (least {100 * _EXPLAINED:.0f} %); a neighbour may be missing"
        )
    if found.turns > _MOST_TURNS:
        words.append(
            f"a beat: the curve turns round {found.turns} times (a joint's law at most "
            f"{_MOST_TURNS}); a neighbour close by is not resolved"
        )
    if found.later is None or not _same(change, found.later):
        words.append("the change does not stay when the decays start later")
    if found.levels is None:
        words.append(found.levels_words)
    elif found.levels > CHANCE:
        words.append(
            "hard and soft hits give the same FRF around the mode (chance "
            f"{found.levels:.2g}); what changes along a decay is no amplitude"
        )
    return tuple(words)


def _not_white(found: DependenceEvidence) -> str:
    return (
        f"residual not white: {found.residual_ratio:.2g} times the noise with curves "
        f"(limit {LARGEST_RESIDUAL_RATIO:g}); modes are missing or not resolved"
    )


def _same(change: Change, later: Change) -> bool:
    """Return whether a change found from a later start is the same one."""
    gap = abs(change.frequency - later.frequency)
    room = _CLEAR * float(np.hypot(change.frequency_sd, later.frequency_sd))
    by_frequency = gap <= max(_KEPT * abs(change.frequency), room)
    gap = abs(change.damping - later.damping)
    room = _CLEAR * float(np.hypot(change.damping_sd, later.damping_sd))
    by_damping = gap <= max(_KEPT * abs(change.damping), room)
    return bool(by_frequency and by_damping)
