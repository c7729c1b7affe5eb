# SPDX-License-Identifier: MIT
"""Fit of the base alone, with the noise estimated at it."""

import numpy as np

from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.analysis.gap.diagnosis.diagnosis_settings import DIAGNOSIS
from jointbench.analysis.gap.judgement.winner_judging import far_off
from jointbench.analysis.gap.residuals.bench_protocol import Bench
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import (
    BASE_RESOLUTIONS,
    fit_coarse_to_fine,
    minimise,
)
from jointbench.analysis.gap.search.hit_stiffness import settled_near


@one_thread()
def fit_base(bench: Bench) -> tuple[Bench, Fit]:
    """Fit the base coarse to fine, and iterate with the noise estimated at it.

    The last resolution does not account for scatter. In a quiet campaign the fit may
    follow the settling of the hits, and end too far from the records for a noise
    estimate. Then the fit of the previous resolution, with a more tolerant window, is
    continued with the joint's stiffness in each hit.
    """
    problem = make_problem(bench, ())
    early = fit_coarse_to_fine(problem, np.zeros(problem.n_base), BASE_RESOLUTIONS[:-1])
    late = minimise(problem, early.x)
    found = settled_base(bench, late)
    if not far_off(*found):
        return found
    near = settled_near(bench, early.base, ())
    if near is None:
        return found
    expanded, start = near
    again = minimise(make_problem(expanded, ()), start)
    if again.chi2 > DIAGNOSIS.settled_share * found[1].chi2:
        return found
    settled = settled_base(expanded, again)
    return (expanded, again) if far_off(*settled) else settled


def settled_base(bench: Bench, fit: Fit) -> tuple[Bench, Fit]:
    """Alternate base fit and noise estimate until they converge.

    Far from the records they do not: the scatter found at one base moves the next. The
    alternation then ends when it has ceased to approach the records.
    """
    for _ in range(DIAGNOSIS.base_rounds):
        before = fit.cost
        bench = bench.refine(fit.base, ())
        fit = minimise(make_problem(bench, ()), fit.x)
        apart = (
            far_off(bench, fit) and fit.cost > DIAGNOSIS.base_approach_share * before
        )
        if apart or abs(fit.cost - before) < DIAGNOSIS.base_settled_cost:
            break
    return bench, fit
