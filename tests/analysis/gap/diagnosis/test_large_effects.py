# SPDX-License-Identifier: MIT
"""Laws of many thousands of times the noise: their residual is noise as well."""

import gap_bench as made
import numpy as np

from jointbench.analysis.gap.judgement.expected_residual import noise_sd
from jointbench.analysis.gap.model.effect import Term
from jointbench.analysis.gap.model.policy import STANDARD
from jointbench.analysis.gap.residuals.bench_noise import refine_noise
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import FitProblem, make_problem
from jointbench.analysis.gap.residuals.make_bench import make_bench
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.search.selection_round import finish

BASE = made.BASE
NOISE = 0.04
QUIET = 0.002
STEPS = 32
"""A sample, for what is taken as the truth."""


def fits_of_a_stop(stiffness: float) -> tuple[FitProblem, Fit, Fit]:
    """Return the problem of a stop, and its fits at four and at the required steps."""
    bench = make_bench(made.quiet_campaign())
    stop = made.term_of(bench, "gap", "link:joint", [stiffness, 2e-6])
    clean = bench.response(BASE, [stop], STEPS)
    rng = np.random.default_rng(11)
    seen = clean + NOISE * rng.standard_normal(clean.shape)
    noisy = refine_noise(make_bench(made.quiet_campaign(seen)), BASE, [stop])
    problem = make_problem(noisy, (stop.candidate,))
    start = np.concatenate([BASE, stop.coordinates])
    four = minimise(problem, start, iterations=8)
    return problem, four, finish(problem, start, lambda line: None)


def test_a_large_stop_is_integrated_as_finely_as_it_needs() -> None:
    """Four steps per sample leave more than noise, the chosen number does not."""
    problem, four, needed = fits_of_a_stop(4e8)
    dof = problem.bench.blocks.dof
    allowed = STANDARD.chi2_limit * noise_sd(problem.bench)
    assert four.chi2 / dof - 1.0 > allowed
    assert needed.chi2 / dof - 1.0 < allowed


def test_clipped_samples_do_not_scatter_with_the_force() -> None:
    """Hits that were harder than measured leave only noise in clipped samples."""
    whole = make_bench(made.quiet_campaign()).response(BASE, [])
    limit = 0.6 * np.abs(whole).max()
    factors = 1.0 + 2e-3 * np.array([0.3, -1.0, 0.9, -0.4, 0.8, 1.2, -0.7, 0.2])
    clean = np.clip(whole * factors[:, None, None], -limit, limit)
    rng = np.random.default_rng(12)
    seen = clean + QUIET * rng.standard_normal(clean.shape)
    bench = make_bench(made.quiet_campaign(seen))
    clip = made.term_of(bench, "saturation", "channel:all", [1.0 / limit])
    noisy = refine_noise(bench, BASE, [clip])
    problem = make_problem(noisy, (clip.candidate,))
    fit = finish(problem, np.concatenate([BASE, clip.coordinates]), lambda line: None)
    assert fit.chi2 / noisy.blocks.dof - 1.0 < STANDARD.chi2_limit * noise_sd(noisy)


def test_gains_that_move_samples_across_the_limit_leave_only_noise() -> None:
    """Hits whose channels scatter by 3 % are explained beside a clipped channel.

    The slopes of the gains alone leave a hundred times the noise near the limit. The
    mean of the masses is off by as much as that of the gains, and must be free to move.
    """
    whole = make_bench(made.quiet_campaign()).response(BASE, [])
    limit = 0.4 * np.abs(whole).max()
    rng = np.random.default_rng(31)
    gains = 1.0 + 0.03 * rng.standard_normal(whole.shape[:2])
    clean = np.clip(whole * gains[:, :, None], -limit, limit)
    seen = clean + QUIET * rng.standard_normal(clean.shape)
    bench = make_bench(made.quiet_campaign(seen))
    clip = made.term_of(bench, "saturation", "channel:all", [1.0 / limit])
    coordinates = np.concatenate([BASE, clip.coordinates])
    for _ in range(2):
        noisy = refine_noise(
            bench,
            coordinates[: BASE.size],
            [Term(clip.candidate, coordinates[BASE.size :])],
        )
        problem = make_problem(noisy, (clip.candidate,))
        fit = finish(problem, coordinates, lambda line: None)
        coordinates, bench = fit.x, noisy
    assert fit.chi2 / noisy.blocks.dof - 1.0 < STANDARD.chi2_limit * noise_sd(noisy)
    assert np.all(np.abs(fit.prior_deviations) < STANDARD.prior_limit)
