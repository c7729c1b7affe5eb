# SPDX-License-Identifier: MIT
"""Fit of a base together with the joint's stiffness in each hit."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.model.effect import Term
from jointbench.analysis.gap.residuals.bench_protocol import Bench
from jointbench.analysis.gap.residuals.evaluation_resolutions import Resolution
from jointbench.analysis.gap.residuals.joint_fit import FitProblem
from jointbench.analysis.gap.search.descent import BASE_RESOLUTIONS, fit_coarse_to_fine


@dataclass(frozen=True, slots=True, eq=False)
class HitStiffnessProblem(FitProblem):
    """A bench whose joint has a stiffness of its own in each hit.

    The coordinates are those of the base, then the log stiffness of each hit over that
    of the base.

    Attributes:
        terms: effects, which are given.
    """

    terms: tuple[Term, ...] = field(kw_only=True)

    def residual(self, x: FloatArray, resolution: Resolution) -> FloatArray:
        """Return the residual at x, without whitening of scatter."""
        shared = x.size - self.own
        there = self.bench.at_stiffness(x[shared:])
        return there.residual(x[:shared], self.terms, resolution)


def settled_near(
    bench: Bench, base: FloatArray, terms: Sequence[Term]
) -> tuple[Bench, FloatArray] | None:
    """Return a bench expanded about the stiffness of each hit, and its base.

    Far from the records the response is not linear in the stiffness of the joint: a
    change by a few percent within the campaign moves the end of a record by radians.
    Sizes of scatter estimated there are not those of the hits, and what they whiten is
    lost for the fit. So the stiffness of each hit is fitted first, coarse to fine, with
    the nominal uncertainty of the joint as its prior; scatter is estimated where the
    model is near.

    Args:
        bench: measurement and model.
        base: start, shape (n_base,).
        terms: effects, which are kept.

    Returns:
        None if the bench has no joint that settles, or if the records remain far.
    """
    hits = bench.stiffness_sd
    if not hits.size:
        return None
    start = np.concatenate([base, np.zeros(hits.size)])
    problem = HitStiffnessProblem(
        bench=bench,
        candidates=(),
        lower=np.full(start.size, -3.0),
        upper=np.full(start.size, 3.0),
        prior=np.concatenate([bench.base_sd, hits]) ** -2.0,
        centre=np.zeros(start.size),
        n_base=start.size,
        own=hits.size,
        terms=tuple(terms),
    )
    x = fit_coarse_to_fine(problem, start, BASE_RESOLUTIONS).x
    near, settling = x[: base.size], x[base.size :]
    there = bench.at_stiffness(settling).refine(near, terms)
    return (there, near) if there.expanded else None
