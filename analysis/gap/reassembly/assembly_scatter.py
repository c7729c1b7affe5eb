# SPDX-License-Identifier: MIT
"""How much a joint scatters from assembly to assembly: a hierarchical model.

The logarithm of a stiffness is a trend over the logarithm of the level, plus an offset
of each assembly (sd ``between``), plus a deviation of each tightening (sd ``within``),
plus the measurement error, whose covariance is known. The trend has no prior; the two
scatters have log-normal ones about nominal values and are integrated over on a grid, so
that what few assemblies leave open widens every answer (restricted likelihood:
Patterson and Thompson 1971, Biometrika 58, 545; hierarchical predictions: Gelman 2006,
Bayesian Analysis 1, 515).
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
from jointbench.analysis.gap.reassembly.assembly_rows import AssemblyRows
from jointbench.analysis.gap.reassembly.reassembly_settings import REASSEMBLY


@dataclass(frozen=True, slots=True)
class NominalScatter:
    """Expected scatter of the logarithm before any measurement.

    Attributes:
        between: sd from assembly to assembly [-].
        within: sd from tightening to tightening of one assembly [-].
    """

    between: float
    within: float


@dataclass(frozen=True, slots=True, eq=False)
class ScatterPosterior:
    """Weights of pairs of scatters.

    Attributes:
        rows: values that it stands on.
        degree: of the trend.
        between: sd from assembly to assembly of each pair [-], shape (n_pairs,).
        within: sd from tightening to tightening [-], same shape.
        weight: posterior probability, same shape.
    """

    rows: AssemblyRows
    degree: int
    between: FloatArray
    within: FloatArray
    weight: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "between", "within", "weight")

    def interval(self, name: str) -> tuple[float, float, float]:
        """Return median and interval of ``"between"`` or ``"within"`` [-]."""
        values = getattr(self, name)
        order = np.argsort(values)
        total = np.cumsum(self.weight[order])
        tail = 0.5 * (1.0 - REASSEMBLY.confidence)
        low, middle, high = (
            float(np.interp(at, total, values[order])) for at in (tail, 0.5, 1.0 - tail)
        )
        return middle, low, high


def trend(level: FloatArray, reference: float, degree: int) -> FloatArray:
    """Return the columns of the trend, powers of ln(level/reference).

    Args:
        level: shape (n,).
        reference: level whose logarithm is 0.
        degree: highest power.

    Returns:
        Shape (n, degree + 1).
    """
    return np.vander(np.log(level / reference), degree + 1, increasing=True)


def scatter_posterior(rows: AssemblyRows, nominal: NominalScatter) -> ScatterPosterior:
    """Return the posterior of both scatters from the values of some assemblies.

    With one assembly it is the prior, but for what its levels say of tightenings.

    Args:
        rows: values of one quantity.
        nominal: expected scatters.
    """
    degree = min(rows.levels.size - 1, REASSEMBLY.most_degree)
    steps = np.linspace(-REASSEMBLY.reach, REASSEMBLY.reach, REASSEMBLY.grid)
    factor = np.exp(REASSEMBLY.log_sd * steps)
    one, two = np.meshgrid(factor, factor, indexing="ij")
    between, within = nominal.between * one.ravel(), nominal.within * two.ravel()
    prior = -0.5 * (steps[:, None] ** 2 + steps[None, :] ** 2).ravel()
    columns = trend(rows.level, rows.level[0], degree)
    score = prior + _restricted_likelihood(rows, columns, between, within)
    weight = np.exp(score - score.max())
    return ScatterPosterior(rows, degree, between, within, weight / weight.sum())


def covariances(
    measured: FloatArray, assembly: IntArray, between: FloatArray, within: FloatArray
) -> FloatArray:
    """Return the covariance of the values under each pair of scatters.

    Args:
        measured: covariance of the measurement errors, shape (n, n).
        assembly: number of the assembly of each value, shape (n,).
        between: sd from assembly to assembly, shape (n_pairs,).
        within: sd from tightening to tightening, shape (n_pairs,).

    Returns:
        Shape (n_pairs, n, n).
    """
    together = (assembly[:, None] == assembly[None, :]).astype(np.float64)
    own = np.eye(assembly.size)
    found: FloatArray = (
        measured
        + between[:, None, None] ** 2 * together
        + within[:, None, None] ** 2 * own
    )
    return found


def _restricted_likelihood(
    rows: AssemblyRows, columns: FloatArray, between: FloatArray, within: FloatArray
) -> FloatArray:
    """Return the logarithm of the restricted likelihood of each pair."""
    stack = covariances(rows.covariance, rows.assembly, between, within)
    white = np.linalg.solve(stack, np.column_stack([columns, rows.value]))
    normal = columns.T @ white[..., :-1]
    right = white[..., -1] @ columns
    fitted = np.linalg.solve(normal, right[..., None])[..., 0]
    left = white[..., -1] @ rows.value - (right * fitted).sum(axis=1)
    return np.asarray(-0.5 * left - _half_log(stack) - _half_log(normal))


def _half_log(stack: FloatArray) -> FloatArray:
    """Return half the logarithm of each determinant, shape (n_pairs,)."""
    roots = np.diagonal(np.linalg.cholesky(stack), axis1=1, axis2=2)
    return np.asarray(np.log(roots).sum(axis=1))
