# SPDX-License-Identifier: MIT
"""Laws of a joint's stiffness are found although it settles in each hit."""

import gap_bench as made
import numpy as np
import pytest

from jointbench.analysis.gap.catalogue.linear_effects import LINEAR
from jointbench.analysis.gap.diagnosis.base_fit import fit_base
from jointbench.analysis.gap.diagnosis.diagnose import diagnose
from jointbench.analysis.gap.judgement.winner_judging import far_off
from jointbench.analysis.gap.model.campaign import Campaign
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.gap.residuals.lumped_residual import settle
from jointbench.analysis.gap.residuals.make_bench import make_bench
from jointbench.analysis.gap.search.descent import (
    BASE_RESOLUTIONS,
    fit_coarse_to_fine,
    minimise,
)

SETTLING = 1.5e-3 * np.array([0.4, -1.1, 0.8, 1.3, -0.6, 0.2, -0.9, 0.1])
BASE = made.BASE


def settled_campaign(exponent: float) -> Campaign:
    """Return hits of a joint that settles, and stiffens with preload^exponent."""
    bench = make_bench(made.quiet_campaign())
    law = made.term_of(bench, "preload_stiffness", "link:joint", [exponent])
    clean = settle(bench, SETTLING).response(BASE, [law])
    rng = np.random.default_rng(4)
    return made.quiet_campaign(clean + 0.05 * rng.standard_normal(clean.shape))


def fitted(exponent: float) -> tuple[LumpedBench, float, float, float]:
    """Return the bench, the exponent found, its sd and its drop of chi2."""
    bench, base = fit_base(make_bench(settled_campaign(exponent)))
    assert isinstance(bench, LumpedBench)
    law = made.term_of(bench, "preload_stiffness", "link:joint", [0.0])
    problem = make_problem(bench, (law.candidate,))
    fit = minimise(problem, np.concatenate([base.x, [0.0]]))
    sd = float(np.sqrt(fit.covariance[-1, -1]))
    return bench, float(fit.x[-1]), sd, base.cost - fit.cost


@pytest.mark.parametrize(("seed", "noise"), [(4, 0.02), (2, 0.005)])
def test_a_quiet_base_is_found_though_every_hit_settles(
    seed: int, noise: float
) -> None:
    """With a scatter of 0.2 %, a fit of the whole records alone does not find it."""
    rng = np.random.default_rng(seed)
    plain = make_bench(made.quiet_campaign(samples=2048))
    settling = 2e-3 * rng.standard_normal(len(SETTLING))
    clean = settle(plain, settling).response(BASE, [])
    noisy = clean + noise * rng.standard_normal(clean.shape)
    start = make_bench(made.quiet_campaign(noisy, samples=2048))
    late = fit_coarse_to_fine(
        make_problem(start, ()), np.zeros(BASE.size), BASE_RESOLUTIONS
    )
    assert far_off(start.refine(late.base, ()), late)
    bench, base = fit_base(start)
    assert base.chi2 == pytest.approx(bench.blocks.dof, rel=0.05)
    assert base.x == pytest.approx(BASE, abs=4e-3)


@pytest.mark.parametrize("exponent", [0.0, 0.02, -0.02])
def test_a_preload_law_is_found_within_the_scatter_of_the_hits(exponent: float) -> None:
    """Its sd is that of the one hit at the higher preload, its value within 4 of it."""
    bench, found, sd, _ = fitted(exponent)
    assert bench.expanded
    assert 1e-3 < sd < 6e-3
    assert found == pytest.approx(exponent, abs=4 * sd)


@pytest.mark.parametrize("loosened", [0.045, 0.06])
def test_a_joint_that_loosens_far_beyond_its_scatter_is_named(loosened: float) -> None:
    """By 30 and 40 sd of a scatter of 0.15 %, in a campaign so quiet that it shows."""
    bench = make_bench(made.quiet_campaign(samples=2048))
    law = made.term_of(bench, "loosening", "link:joint", [loosened])
    clean = settle(bench, SETTLING).response(BASE, [law])
    rng = np.random.default_rng(4)
    noisy = clean + 0.02 * rng.standard_normal(clean.shape)
    found = diagnose(made.quiet_campaign(noisy, samples=2048), entries=LINEAR)
    assert [e.name for e in found.effects] == ["loosening"]
    value = found.effects[0].parameters[0]
    assert value.value == pytest.approx(loosened, abs=4 * value.sd)


def test_the_drop_of_a_trend_within_the_scatter_matches_its_significance() -> None:
    """The drop of chi2 is the squared distance from zero, in sd."""
    _, found, sd, drop = fitted(0.004)
    assert drop == pytest.approx((found / sd) ** 2, rel=0.1, abs=0.1)
