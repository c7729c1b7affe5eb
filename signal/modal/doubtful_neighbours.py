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
    ComplexArray,
    FloatArray,
    IntArray,
    freeze,
)
from jointbench.signal.modal.local_fit import Group, WholeFit
from jointbench.signal.modal.missing_modes import (
    refined_group,
    trial_group,
    trial_starts,
)
from jointbench.signal.modal.refined_pole_covariance import RefinedPoles, unresolved

# Probability that noise anywhere in the band hints at a neighbour.
_CHANCE = 0.01
_TRIALS = 10
# Weight of a neighbour from which it is stated.
_STATED = 0.5


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


def doubtful_neighbours(whole: WholeFit, covariance: FloatArray) -> DoubtfulNeighbours:
    """Try one more mode wherever the residual hints at one.

    Args:
        whole: final fit of all lines.
        covariance: of (Re p, Im p) of each mode in it, shape (n_modes, 2, 2).

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
        weight = _weight(group, without, fitted)
        _widen(
            shift, weight * _change(whole.pole, fitted, group, covariance), group.modes
        )
        if weight > _STATED:
            places.append(float(pole[0].imag) / (2.0 * np.pi))
    return DoubtfulNeighbours(np.sort(np.array(places, float)), shift)


def _weight(group: Group, without: RefinedPoles, fitted: RefinedPoles) -> float:
    """Return the Akaike weight of the model with one more mode [-].

    Chi-squared counts in units of what that model leaves: noise, or what neither has.
    """
    before, after = (
        float(np.sum(np.abs(f.residual) ** 2 / group.noise)) for f in (without, fitted)
    )
    n_frf, n_lines = group.noise.shape
    gain = 2.0 * (before - after) / max(1.0, after / (n_frf * n_lines))
    parameters = 2 * (n_frf + 1)
    return float(scipy.special.expit(0.5 * gain - parameters))


def _change(
    pole: ComplexArray, fitted: RefinedPoles, group: Group, covariance: FloatArray
) -> FloatArray:
    """Return squared shift and growth of the variance, shape (n_members, 2, 2)."""
    moved = (fitted.pole[:-1] - pole[group.modes]).view(np.float64).reshape(-1, 2)
    own = fitted.covariance[:-1] * fitted.inflation[:-1, None, None]
    grown = own - covariance[group.modes]
    both = np.arange(2)
    larger = np.zeros_like(grown)
    larger[:, both, both] = np.maximum(grown[:, both, both], 0.0)
    return np.asarray(moved[:, :, None] * moved[:, None, :] + larger)


def _widen(shift: FloatArray, change: FloatArray, modes: IntArray) -> None:
    """Keep the larger change of each mode, by its trace."""
    known = np.trace(shift[modes], axis1=1, axis2=2)
    more = np.trace(change, axis1=1, axis2=2) > known
    shift[modes[more]] = change[more]
