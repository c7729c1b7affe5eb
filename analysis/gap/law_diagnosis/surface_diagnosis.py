# SPDX-License-Identifier: MIT
"""Diagnosis of a measured surface: what a self-affine surface lacks to explain it."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.acquisition.records.surfaces import Surface
from jointbench.analysis.gap.diagnosis.loop import SearchOutcome
from jointbench.analysis.gap.diagnosis.verdict_and_advice import DiagnosisVerdict
from jointbench.analysis.gap.judgement.fit_summaries import largest_deviation
from jointbench.analysis.gap.law_diagnosis.law_explanations import (
    separating_steps,
    verdict_on_level,
)
from jointbench.analysis.gap.law_diagnosis.law_outcome import (
    LawReport,
    fit_shown,
    law_diagnosis,
)
from jointbench.analysis.gap.law_diagnosis.surface_search import search_surface
from jointbench.analysis.gap.model.diagnosis_record import (
    Diagnosis,
    Estimate,
    Finding,
    Gap,
)
from jointbench.analysis.gap.model.effect import words_of
from jointbench.analysis.gap.model.policy import STANDARD, Policy
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.search.selection_round import Progress, score
from jointbench.analysis.gap.surface_bench.held_out_waves import (
    HeldOutWaves,
    hold_out_waves,
)
from jointbench.analysis.gap.surface_bench.surface_bench import (
    SurfaceBench,
    make_surface_bench,
)
from jointbench.analysis.gap.surface_bench.surface_rows import surface_rows
from jointbench.analysis.gap.surface_bench.surface_settings import SURFACE
from jointbench.analysis.gap.surface_bench.surface_summary import summary_word
from jointbench.analysis.gap.surface_bench.surface_views import surface_views
from jointbench.signal.fractal.verdict_records import SurfaceVerdict

MORE_SURFACE = "measure a longer profile with a finer pitch at another place"


@dataclass(frozen=True, slots=True, eq=False)
class SurfaceDiagnosis:
    """Result on a measured surface.

    Attributes:
        found: verdict and evidence.
        before: bins of wavelength predicted from the others by the base.
        after: the same with the effects; that of the base where none is named.
        bench: of the fits.
        base: fit of the base.
        best: fit that is shown; the base unless effects are accepted.
        level: explanations that cannot be distinguished, the best first.
        summary: verdict word.
    """

    found: Diagnosis
    before: HeldOutWaves
    after: HeldOutWaves
    bench: SurfaceBench
    base: Fit
    best: Fit
    level: tuple[Fit, ...]
    summary: SurfaceVerdict


@one_thread()
def diagnose_surface(
    surfaces: Surface | Sequence[Surface],
    *,
    degree: int = 1,
    without: frozenset[str] = frozenset(),
    policy: Policy = STANDARD,
    progress: Progress | None = None,
) -> SurfaceDiagnosis:
    """Find and name what a self-affine surface lacks to explain a measured one.

    Args:
        surfaces: a profile or map as read, or independent profiles of one surface and
            one pitch.
        degree: of the form that was removed before [-].
        without: names of effects to leave out of the catalogue.
        policy: thresholds of the verdict.
        progress: receives one line for each step.

    Raises:
        UsageError: `without` holds an unknown name, lines shorter than 64 points, or
            several maps.
        SurfaceTooSmall: too few measured points.
    """
    given = [surfaces] if not isinstance(surfaces, Sequence) else list(surfaces)
    rows = surface_rows(given, degree=degree)
    bench = make_surface_bench(rows, without=without, policy=policy)
    outcome = search_surface(bench, progress or _silent)
    tolerance = 0.0
    if not outcome.acceptance.passed:
        for one in SURFACE.tolerances:
            wider = make_surface_bench(
                rows.tolerant(one), without=without, policy=policy
            )
            tried = search_surface(wider, progress or _silent)
            if tried.acceptance.passed:
                bench, outcome, tolerance = wider, tried, one
                break
    return _conclude(outcome, bench, tolerance)


def _silent(line: str) -> None:
    """Show no progress."""


def _conclude(
    outcome: SearchOutcome, bench: SurfaceBench, tolerance: float
) -> SurfaceDiagnosis:
    """Derive the diagnosis from the outcome of a search."""
    verdict = surface_verdict(outcome, bench, tolerance)
    base, best = outcome.base, fit_shown(outcome, verdict.finding)
    before = hold_out_waves(bench, base)
    after = before if best is base else hold_out_waves(bench, best)
    report = LawReport(
        (_gap(bench, base, before), _gap(bench, best, after)),
        base_estimates(bench, best),
        {
            "sigma_min": 1.0,
            "sigma_max": 1.0,
            "force_sigma_N": 0.0,
            "scatter_gain": 0.0,
            "scatter_joint": 0.0,
        },
        partial(score, bench),
    )
    found = law_diagnosis(outcome, bench, verdict, report)
    names = [c.effect.name for c in best.candidates]
    return SurfaceDiagnosis(
        found,
        before,
        after,
        bench,
        base,
        best,
        outcome.level,
        summary_word(verdict.finding, names),
    )


def surface_verdict(
    outcome: SearchOutcome, bench: SurfaceBench, tolerance: float = 0.0
) -> DiagnosisVerdict:
    """Return the verdict on a search on a surface.

    Args:
        outcome: of the search.
        bench: of its fits.
        tolerance: sd of ln density that the rows allow beyond chance [-].
    """
    acceptance, best = outcome.acceptance, outcome.best
    if not acceptance.passed:
        reason = f"no effect of the catalogue explains the surface: {acceptance.reason}"
        return DiagnosisVerdict(Finding.UNKNOWN, reason, MORE_SURFACE, unexplained=True)
    chi2 = f"chi2 {best.cost:.1f} for {bench.blocks.dof} rows"
    if tolerance > 0:
        return _mostly(outcome, f"{chi2}, {outcome.base.cost:.1f} without", tolerance)
    if not best.candidates:
        reason = f"a self-affine surface explains the heights: {chi2}"
        step = "none required; a longer profile would show smaller effects"
        return DiagnosisVerdict(Finding.NONE, reason, step)
    explains = f"explains the surface: {chi2}, {outcome.base.cost:.1f} without it"
    return verdict_on_level(outcome, bench, explains, MORE_SURFACE)


def _mostly(outcome: SearchOutcome, chi2: str, tolerance: float) -> DiagnosisVerdict:
    """Return the verdict on rows that are explained within a tolerance only."""
    within = f"within {100 * tolerance:.0f} % of the spectrum, not to its noise: {chi2}"
    if len(outcome.level) == 1 and outcome.best.candidates:
        reason = f"explains the surface {within}"
        return DiagnosisVerdict(Finding.MOSTLY, reason, MORE_SURFACE)
    names = " or ".join(words_of(f.candidates) or "none" for f in outcome.level)
    reason = f"{names} fit {within}; a name needs more"
    steps = separating_steps(outcome, MORE_SURFACE)
    return DiagnosisVerdict(Finding.UNKNOWN, reason, steps)


def _gap(bench: SurfaceBench, fit: Fit, held: HeldOutWaves) -> Gap:
    words = (
        f"{held.omega.size} bins of wavelength in {SURFACE.folds} parts, each "
        f"predicted from the others, {100 * held.share_inside:.0f} % within their "
        "95 % interval; marks and shapes as fitted"
    )
    deviation = largest_deviation(fit)
    views = surface_views(bench.rows, fit.residual)
    return Gap(held.gap, held.chi2_per_dof, deviation, views, words)


def base_estimates(bench: SurfaceBench, fit: Fit) -> tuple[Estimate, ...]:
    """Return H and the density at the pivot, with their standard deviations.

    Args:
        bench: of the fit.
        fit: with or without effects.
    """
    sd = np.sqrt(np.maximum(np.diag(fit.covariance), 0.0))
    widened = float(np.sqrt(max(fit.chi2 / max(bench.blocks.dof, 1), 1.0)))
    unit = bench.rows.sample.scale**2 * bench.rows.sample.pitch
    level = unit * float(np.exp(bench.level + fit.base[0]))
    hurst = float(SURFACE.hurst + fit.base[1])
    return (
        Estimate("hurst", hurst, float(sd[1] * widened), "-"),
        Estimate("density_at_pivot", level, float(sd[0] * widened) * level, "m^3"),
    )
