# SPDX-License-Identifier: MIT
"""Joint least-squares problem of base and effects."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Candidate
from jointbench.analysis.gap.residuals.bench_protocol import Bench, SlopedBench
from jointbench.analysis.gap.residuals.evaluation_resolutions import Resolution
from jointbench.analysis.gap.residuals.fit_records import split
from jointbench.analysis.gap.residuals.slopes import SlopeArray


@dataclass(frozen=True, slots=True, eq=False)
class FitProblem:
    """A bench with chosen effects, as a least-squares problem.

    Attributes:
        bench: measurement and model.
        candidates: effects.
        lower: bounds of the coordinates, shape (n,).
        upper: likewise.
        prior: diagonal of the prior's precision, shape (n,).
        centre: of the prior, shape (n,).
        n_base: number of base coordinates.
        own: number of coordinates, the last ones, that each change one record alone,
            in the order of the records.
    """

    bench: Bench
    candidates: tuple[Candidate, ...]
    lower: FloatArray
    upper: FloatArray
    prior: FloatArray
    centre: FloatArray
    n_base: int
    own: int = field(default=0, kw_only=True)

    def residual(self, x: FloatArray, resolution: Resolution) -> FloatArray:
        """Return the whitened residual at x."""
        terms = split(x, self.n_base, self.candidates)
        return self.bench.residual(x[: self.n_base], terms, resolution)

    def base_slopes(self, x: FloatArray, resolution: Resolution) -> SlopeArray | None:
        """Return the slopes of the residual by the base, shape (n_rows, n_base).

        None if the bench has none of its own. A bench may add columns by the
        coordinates of the effects, all of them; NaN in those that it does not know.
        """
        if not isinstance(self.bench, SlopedBench):
            return None
        terms = split(x, self.n_base, self.candidates)
        return self.bench.slopes(x[: self.n_base], terms, resolution)

    def penalty(self, x: FloatArray) -> float:
        """Return the priors' share of the cost."""
        return float(np.sum(self.prior * (x - self.centre) ** 2))


def make_problem(bench: Bench, candidates: Sequence[Candidate]) -> FitProblem:
    """Collect bounds and priors of base and effects."""
    n_base = bench.base_sd.size
    lower, upper = [-3.0] * n_base, [3.0] * n_base
    if isinstance(bench, SlopedBench):
        lower, upper = (list(limit) for limit in bench.base_limits)
    prior = list(1.0 / bench.base_sd**2)
    centre = [0.0] * n_base
    for candidate in candidates:
        for p in candidate.effect.parameters:
            low, high = p.bounds
            lower.append(low)
            upper.append(high)
            prior.append(0.0 if p.prior is None else 1.0 / p.prior[1] ** 2)
            centre.append(0.0 if p.prior is None else p.encode(p.prior[0]))
    return FitProblem(
        bench,
        tuple(candidates),
        np.array(lower),
        np.array(upper),
        np.array(prior),
        np.array(centre),
        n_base,
    )
