# SPDX-License-Identifier: MIT
"""What other assemblies of a joint will show, from those that were measured."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq
from scipy.special import ndtr

from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.gap.reassembly.assembly_scatter import (
    ScatterPosterior,
    covariances,
    trend,
)
from jointbench.analysis.gap.reassembly.reassembly_settings import REASSEMBLY


@dataclass(frozen=True, slots=True, eq=False)
class Expected:
    """Expected values under each pair of scatters.

    Attributes:
        weight: probability of the pair, shape (n_pairs,).
        mean: of the logarithms, shape (n_pairs, n).
        covariance: of the logarithms, shape (n_pairs, n, n).
    """

    weight: FloatArray
    mean: FloatArray
    covariance: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "weight", "mean", "covariance")


def expected_values(
    known: ScatterPosterior,
    level: FloatArray,
    assembly: IntArray,
    measured: FloatArray,
) -> Expected:
    """Return mean and covariance of further values, given those that are known.

    Universal kriging: the trend is unknown, deviations are predicted where the assembly
    is one of those measured (Cressie 1993, Statistics for Spatial Data, eq. 3.4.2).

    Args:
        known: posterior of the scatters, with the values that it stands on.
        level: of the further values, shape (n,).
        assembly: their assemblies; a number that is not among those known is a new
            assembly, shape (n,).
        measured: covariance of their measurement errors, shape (n, n).

    Raises:
        BadData: a level is too far from those measured.
    """
    rows = known.rows
    _check_reach(rows.levels, level)
    reference = float(rows.level[0])
    old = trend(rows.level, reference, known.degree)
    new = trend(level, reference, known.degree)
    ids = np.concatenate([rows.assembly, assembly])
    size = rows.value.size
    errors = np.zeros((ids.size, ids.size))
    errors[:size, :size], errors[size:, size:] = rows.covariance, measured
    stack = covariances(errors, ids, known.between, known.within)
    cross, pairs = stack[:, size:, :size], len(stack)
    columns = np.column_stack([old, rows.value])
    same = np.broadcast_to(columns, (pairs, *columns.shape))
    turned = cross.transpose(0, 2, 1)
    white = np.linalg.solve(
        stack[:, :size, :size], np.concatenate([same, turned], axis=2)
    )
    trended, value, further = np.split(white, [old.shape[1], old.shape[1] + 1], axis=2)
    normal = old.T @ trended
    fitted = np.linalg.solve(normal, old.T @ value)
    mean = new @ fitted + cross @ (value - trended @ fitted)
    rest = new - cross @ trended
    covariance = stack[:, size:, size:] - cross @ further
    covariance += rest @ np.linalg.solve(normal, rest.transpose(0, 2, 1))
    return Expected(known.weight, mean[..., 0], covariance)


def quantiles(found: Expected, probability: tuple[float, ...]) -> FloatArray:
    """Return quantiles of each value: of a mixture of normal distributions.

    Args:
        found: expected values.
        probability: of the quantiles.

    Returns:
        Of the logarithms, shape (n_probabilities, n).
    """
    sd = np.sqrt(np.diagonal(found.covariance, axis1=1, axis2=2))
    low = (found.mean - REASSEMBLY.bracket * sd).min(axis=0)
    high = (found.mean + REASSEMBLY.bracket * sd).max(axis=0)

    def excess(at: float, j: int, share: float) -> float:
        below = ndtr((at - found.mean[:, j]) / sd[:, j])
        return float(found.weight @ below) - share

    return np.array(
        [
            [brentq(excess, low[j], high[j], args=(j, share)) for j in range(low.size)]
            for share in probability
        ]
    )


def _check_reach(measured: FloatArray, asked: FloatArray) -> None:
    lowest = float(measured[0]) / REASSEMBLY.extrapolation
    highest = float(measured[-1]) * REASSEMBLY.extrapolation
    if measured.size == 1:
        margin = np.exp(REASSEMBLY.same_level)
        lowest, highest = float(measured[0]) / margin, float(measured[0]) * margin
    for level in asked:
        if not lowest <= level <= highest:
            raise BadData(
                f"the level {level:g} is too far from those measured, "
                f"{measured[0]:g} to {measured[-1]:g}; ask for {lowest:.3g} to "
                f"{highest:.3g}, or measure it"
            )
