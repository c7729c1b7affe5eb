# SPDX-License-Identifier: MIT
"""Joint least squares of base and effects: the problem, and a minimum of it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.arrays import FloatArray
from jointbench.analysis.gap.bench import Bench, Stage
from jointbench.analysis.gap.effects import Candidate, Term


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
    def pulls(self) -> FloatArray:
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
class Problem:
    """A bench with chosen effects, as a least-squares problem."""

    bench: Bench
    candidates: tuple[Candidate, ...]
    lower: FloatArray
    upper: FloatArray
    prior: FloatArray
    centre: FloatArray
    n_base: int

    def residual(self, x: FloatArray, stage: Stage) -> FloatArray:
        """Return the whitened residual at x."""
        terms = split(x, self.n_base, self.candidates)
        return self.bench.residual(x[: self.n_base], terms, stage)

    def penalty(self, x: FloatArray) -> float:
        """Return the priors' share of the cost."""
        return float(np.sum(self.prior * (x - self.centre) ** 2))


def make_problem(bench: Bench, candidates: Sequence[Candidate]) -> Problem:
    """Collect bounds and priors of base and effects."""
    n_base = bench.base_sd.size
    lower, upper = [-3.0] * n_base, [3.0] * n_base
    prior = list(1.0 / bench.base_sd**2)
    centre = [0.0] * n_base
    for candidate in candidates:
        for p in candidate.effect.parameters:
            low, high = p.bounds
            lower.append(low)
            upper.append(high)
            prior.append(0.0 if p.prior is None else 1.0 / p.prior[1] ** 2)
            centre.append(0.0 if p.prior is None else p.encode(p.prior[0]))
    return Problem(
        bench,
        tuple(candidates),
        np.array(lower),
        np.array(upper),
        np.array(prior),
        np.array(centre),
        n_base,
    )
