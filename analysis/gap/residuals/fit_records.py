# SPDX-License-Identifier: MIT
"""Records of a fit: how its rows belong together, its minimum."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.analysis.gap.model.effect import Candidate, Term


@dataclass(frozen=True, slots=True, eq=False)
class Blocks:
    """Which rows of a residual belong together.

    Attributes:
        group: group of each row (a record), shape (n_rows,), 0-based.
        labels: words of each group by view, for example ``{"level": "300 N"}``.
        dof: number of residual rows with any weight.
        shape: records, channels and samples, whose product is the number of rows.
        white: False where sigma holds a repeatability from a sheet: then a residual
            below it may have any shape, and directed tests say nothing.
    """

    group: IntArray
    labels: tuple[dict[str, str], ...]
    dof: int
    shape: tuple[int, int, int]
    white: bool = True


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """A minimum of the cost.

    Attributes:
        x: base coordinates, then those of each candidate, shape (n,).
        n_base: how many of them belong to the base.
        candidates: the effects switched on.
        residual: whitened, shape (n_rows,).
        jacobian: d residual / d x, shape (n_rows, n).
        cost: chi2 of the data plus that of the priors.
        prior: diagonal of the prior's precision, shape (n,).
        centre: of the prior, shape (n,).
    """

    x: FloatArray
    n_base: int
    candidates: tuple[Candidate, ...]
    residual: FloatArray
    jacobian: FloatArray
    cost: float
    prior: FloatArray
    centre: FloatArray

    @property
    def base(self) -> FloatArray:
        """Base coordinates, shape (n_base,)."""
        return self.x[: self.n_base]

    @property
    def terms(self) -> tuple[Term, ...]:
        """The effects with their coordinates."""
        return split(self.x, self.n_base, self.candidates)

    @property
    def chi2(self) -> float:
        """Of the data alone."""
        return float(self.residual @ self.residual)

    @property
    def covariance(self) -> FloatArray:
        """Of x by the curvature of the cost, shape (n, n)."""
        hessian = self.jacobian.T @ self.jacobian + np.diag(self.prior)
        return np.asarray(np.linalg.pinv(hessian, hermitian=True))

    @property
    def prior_deviations(self) -> FloatArray:
        """Distance of the base from its sheet, in prior sd, shape (n_base,)."""
        scaled = np.sqrt(self.prior[: self.n_base])
        return np.asarray(self.base * scaled)


def split(
    x: FloatArray, n_base: int, candidates: Sequence[Candidate]
) -> tuple[Term, ...]:
    """Cut a coordinate vector into terms."""
    terms, at = [], n_base
    for candidate in candidates:
        n = len(candidate.effect.parameters)
        terms.append(Term(candidate, x[at : at + n]))
        at += n
    return tuple(terms)


@dataclass(frozen=True, slots=True, eq=False)
class Settled:
    """An expansion of the model about the joint's stiffness as it was in each hit.

    The data know that stiffness far better than its mean, so the mean must move
    without it: the response is taken at the stiffness of each hit, and mean and
    scatter about it enter by the slope. A record of a hundred radians bends within
    the scatter; what does not bend cannot leave the base stuck.

    Attributes:
        anchor: base at which the model was expanded, shape (n_base,).
        slope: change of the response with it, shape of the response.
        rise: what laws added to the joint's stiffness there [-], (n_records,).
    """

    anchor: FloatArray
    slope: FloatArray
    rise: FloatArray
