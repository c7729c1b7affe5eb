# SPDX-License-Identifier: MIT
"""Fit base and force laws under one discrepancy, estimated at the best law."""

from dataclasses import dataclass

import numpy as np

from jointbench.analysis.gap.model.effect import Candidate
from jointbench.analysis.gap.model_error.discrepancy import (
    Discrepancy,
    estimate_discrepancy,
    no_discrepancy,
)
from jointbench.analysis.gap.model_error.law_descent import quick_fit
from jointbench.analysis.gap.model_error.model_error_settings import (
    MODEL_ERROR_SETTINGS,
)
from jointbench.analysis.gap.model_error.spectral_frame import (
    SpectralFrame,
    spectral_frame,
)
from jointbench.analysis.gap.model_error.whitened_bench import (
    WhitenedBench,
    whitened_bench,
)
from jointbench.analysis.gap.residuals.bench_protocol import MeasuredBench
from jointbench.analysis.gap.residuals.evaluation_resolutions import MIDDLE
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.gap.residuals.lumped_residual import settle
from jointbench.analysis.gap.search.candidate_starts import along
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.search.screening import Screening, screen
from jointbench.analysis.gap.search.selection_round import Progress


@dataclass(frozen=True, slots=True, eq=False)
class LawFits:
    """Fits of the base and of each law under one discrepancy.

    Attributes:
        bench: with the whitening of the fits.
        discrepancy: estimated at the best law.
        base: fit without a law.
        laws: fit of each law, lowest cost first.
    """

    bench: WhitenedBench
    discrepancy: Discrepancy
    base: Fit
    laws: tuple[Fit, ...]


def fit_laws(inner: MeasuredBench, start: Fit, progress: Progress) -> LawFits:
    """Fit the base and every force law under the discrepancy at the best law.

    Args:
        inner: measurement and model.
        start: fit of the base alone.
        progress: receives the label of each law.
    """
    inner = settle(inner, None) if isinstance(inner, LumpedBench) else inner
    frame = spectral_frame(inner)
    progress("base under model error")
    bench, base = _settled_base(inner, frame, start)
    screening = screen(bench, base, bench.candidates)
    laws = []
    for candidate in bench.candidates:
        progress(f"{candidate.label} under model error")
        laws.append(_started(bench, base, screening, candidate))
    if not laws:
        return LawFits(bench, no_discrepancy(frame), base, ())
    best = min(laws, key=lambda f: f.cost)
    found = estimate_discrepancy(frame, bench.spectrum(best.base, best.terms, MIDDLE))
    bench = whitened_bench(inner, frame, found)
    fits = [_fitted(bench, f) for f in (base, *_contenders(laws))]
    ranked = sorted(fits[1:], key=lambda f: f.cost)
    return LawFits(bench, found, fits[0], tuple(ranked))


def _contenders(laws: list[Fit]) -> list[Fit]:
    """Return the best fits of each family."""
    kept: dict[str, list[Fit]] = {}
    for fit in sorted(laws, key=lambda f: f.cost):
        own = kept.setdefault(fit.candidates[0].effect.family, [])
        if len(own) < MODEL_ERROR_SETTINGS.members:
            own.append(fit)
    return [fit for own in kept.values() for fit in own]


def _settled_base(
    inner: MeasuredBench, frame: SpectralFrame, start: Fit
) -> tuple[WhitenedBench, Fit]:
    """Alternate fits of the base and estimates of the discrepancy."""
    bench, x = whitened_bench(inner, frame, no_discrepancy(frame)), start.base
    for _ in range(MODEL_ERROR_SETTINGS.base_rounds):
        found = estimate_discrepancy(frame, bench.spectrum(x, (), MIDDLE))
        bench = whitened_bench(inner, frame, found)
        base = minimise(
            make_problem(bench, ()),
            x,
            MIDDLE,
            iterations=MODEL_ERROR_SETTINGS.base_iterations,
        )
        x = base.x
    return bench, base


def _started(
    bench: WhitenedBench, base: Fit, screening: Screening, candidate: Candidate
) -> Fit:
    """Return the fit of a law from the best of its starts."""
    problem = make_problem(bench, (candidate,))
    least = _least_drop(bench)
    fits = [
        quick_fit(problem, base, along(problem, base, d, MIDDLE).x, least)
        for d in screening.best(candidate, MODEL_ERROR_SETTINGS.starts)
    ]
    return min(fits, key=lambda f: f.cost)


def _fitted(bench: WhitenedBench, fit: Fit) -> Fit:
    """Return a fit continued under another discrepancy."""
    return minimise(
        make_problem(bench, fit.candidates),
        np.array(fit.x),
        MIDDLE,
        iterations=MODEL_ERROR_SETTINGS.law_iterations,
        least_drop=_least_drop(bench),
    )


def _least_drop(bench: WhitenedBench) -> float:
    """Return the drop of the cost below which a fit has converged."""
    return MODEL_ERROR_SETTINGS.least_drop_share * bench.blocks.dof
