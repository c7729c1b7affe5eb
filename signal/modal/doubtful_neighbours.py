# SPDX-License-Identifier: MIT
"""Neighbours that the residual hints at and no fit could settle.

Between "the residual is white" and "the FRF needs one more mode" lies the case in which
a neighbour may be missing: its own pole would be too uncertain to report, yet it moves
the modes around it. Both models are admissible there. So the interval of each mode is
that of their mixture: the value is kept, and its variance is the weighted mean of
variance and squared shift of the fits with and without the neighbour.
"""

from dataclasses import dataclass

import numpy as np
import scipy.special
import scipy.stats

from jointbench.acquisition.basics.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    IntArray,
    freeze,
)
from jointbench.signal.modal.frf_lines import measured_width
from jointbench.signal.modal.local_fit import Group, WholeFit
from jointbench.signal.modal.missing_modes import (
    refined_group,
    trial_group,
    trial_starts,
)
from jointbench.signal.modal.refined_pole_covariance import RefinedPoles, unresolved

# Probability that noise anywhere in the band hints at a neighbour.
_CHANCE = 0.1
_TRIALS = 16
# Residual power over noise up to which a model with one more mode is admissible: else
# leakage or a nonlinear structure is left, which no neighbour explains.
_ADMISSIBLE = 4.0
# Half-power half-widths on each side of a mode that a group must hold.
_PEAK = 1.0
# Weight of a neighbour from which it is stated.
_STATED = 0.5
# Places named in the remark.
_LISTED = 6


@dataclass(frozen=True, slots=True, eq=False)
class DoubtfulNeighbours:
    """Where a mode may be missing, and what it would change.

    Attributes:
        frequency: of the neighbours [Hz], shape (n,), ascending.
        shift: mean squared change of (Re p, Im p) of each mode [rad^2/s^2], shape
            (n_modes, 2, 2).
    """

    frequency: FloatArray
    shift: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "frequency", "shift")


def doubtful_neighbours(whole: WholeFit) -> DoubtfulNeighbours:
    """Try one more mode wherever the residual hints at one.

    Args:
        whole: final fit of all lines.

    Returns:
        Places and changes; of several neighbours of a mode the largest change counts.

    Source:
        Burnham and Anderson, Model Selection and Multimodel Inference (2002), sec. 4.3
        and 2.9 (weights of Akaike, unconditional variance).
    """
    n_frf, n_lines = whole.noise.shape
    limit = float(scipy.stats.chi2.isf(_CHANCE / n_lines, 2 * n_frf))
    shift = np.zeros((whole.n_modes, 2, 2))
    places: list[float] = []
    for start in trial_starts(whole, limit, apart=0.0, most=_TRIALS):
        group = trial_group(whole, start)
        without = refined_group(whole, group)
        fitted = refined_group(whole, group, start)
        pole = fitted.pole[-1:]
        if pole[0].real >= 0.0 or bool(unresolved(whole.lines, pole)[0]):
            continue
        if _left(group, fitted) > _ADMISSIBLE:
            continue
        weight = _weight(group, without, fitted)
        inside = _inside(group, without.pole)
        change = weight * _change(without, fitted)
        _widen(shift, change[inside], group.modes[inside])
        near = np.abs(np.array(places, float) - pole[0].imag) < abs(pole[0].real)
        if weight > _STATED and not near.any():
            places.append(float(pole[0].imag))
    return DoubtfulNeighbours(np.sort(places) / (2.0 * np.pi), shift)


def neighbour_words(doubts: DoubtfulNeighbours) -> tuple[str, ...]:
    """State where modes may be missing, and what would show them.

    Args:
        doubts: of the final fit.

    Returns:
        One sentence, or none.
    """
    count = doubts.frequency.size
    if count == 0:
        return ()
    listed = ", ".join(f"{f:.6g}" for f in doubts.frequency[:_LISTED])
    more = f" and {count - _LISTED} more" if count > _LISTED else ""
    return (
        f"{'a mode' if count == 1 else 'modes'} may be missing near {listed} Hz{more}: "
        "the residual is that of a resonance there, too weak or too close to another "
        "to be reported; the intervals of the modes around include it; another "
        "accelerometer or hammer point, or more hits, would show it",
    )


def _weight(group: Group, without: RefinedPoles, fitted: RefinedPoles) -> float:
    """Return the Akaike weight of the model with one more mode [-].

    Chi-squared counts in units of what that model leaves: noise, or what neither has.
    """
    n_frf, n_lines = group.noise.shape
    before, after = _left(group, without), _left(group, fitted)
    gain = 2.0 * n_frf * n_lines * (before - after) / max(1.0, after)
    return float(scipy.special.expit(0.5 * gain - 2 * (n_frf + 1)))


def _left(group: Group, fitted: RefinedPoles) -> float:
    """Return the mean residual power over the noise [-]."""
    return float(np.mean(np.abs(fitted.residual) ** 2 / group.noise))


def _inside(group: Group, pole: ComplexArray) -> BoolArray:
    """Return which modes have their peaks within the lines of the group.

    Of the others only a flank was fitted again.
    """
    low, high = group.lines.laplace.imag[[0, -1]]
    width = _PEAK * measured_width(group.lines, pole)
    return np.asarray((pole.imag - width > low) & (pole.imag + width < high))


def _change(without: RefinedPoles, fitted: RefinedPoles) -> FloatArray:
    """Return squared shift and growth of the variance, shape (n_members, 2, 2)."""
    moved = (fitted.pole[:-1] - without.pole).view(np.float64).reshape(-1, 2)
    own = fitted.covariance[:-1] * fitted.inflation[:-1, None, None]
    grown = own - without.covariance * without.inflation[:, None, None]
    both = np.arange(2)
    larger = np.zeros_like(grown)
    larger[:, both, both] = np.maximum(grown[:, both, both], 0.0)
    return np.asarray(moved[:, :, None] * moved[:, None, :] + larger)


def _widen(shift: FloatArray, change: FloatArray, modes: IntArray) -> None:
    """Keep the larger change of each mode, by its trace."""
    known = np.trace(shift[modes], axis1=1, axis2=2)
    more = np.trace(change, axis1=1, axis2=2) > known
    shift[modes[more]] = change[more]
