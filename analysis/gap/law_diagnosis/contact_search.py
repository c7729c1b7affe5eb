# SPDX-License-Identifier: MIT
"""Search for the effect that a contact law lacks to explain a measured joint.

A fit costs milliseconds, so every effect of the catalogue is fitted from several
starts. Every base parameter has a prior: the cost at a minimum is chi2 distributed with
as many degrees of freedom as there are values, which gives the tests their limits.
"""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.contact_bench.contact_bench import ContactBench
from jointbench.analysis.gap.contact_bench.contact_settings import CONTACT
from jointbench.analysis.gap.diagnosis.loop import SearchOutcome
from jointbench.analysis.gap.judgement.naming import Acceptance
from jointbench.analysis.gap.law_diagnosis.law_acceptance import LawCriteria, accept_law
from jointbench.analysis.gap.law_diagnosis.law_outcome import TestedBase
from jointbench.analysis.gap.model.effect import Candidate
from jointbench.analysis.gap.residuals.evaluation_resolutions import FULL
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.candidate_starts import along
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.search.screening import Screening, screen, start_grid
from jointbench.analysis.gap.search.selection_round import Progress, score

_LIMITS = LawCriteria(
    null_chance=CONTACT.null_chance,
    fit_chance=CONTACT.fit_chance,
    null_factor=CONTACT.null_factor,
    prior_limit=CONTACT.prior_limit,
    amplitude_limit=CONTACT.amplitude_limit,
    cost="values and priors",
    rows="values",
)


def search_contact(bench: ContactBench, progress: Progress) -> SearchOutcome:
    """Fit the base, and search for a missing effect if it does not explain the joint.

    Args:
        bench: as made.
        progress: receives one line for each step.
    """
    progress("base")
    bench, base = fit_contact_base(bench)
    tested = [*bench.candidates, *bench.probes]
    screening = screen(bench, base, tested)
    first = accept_contact(bench, base, base, screening)
    if first.passed:
        return TestedBase(base, screening, first).complete(bench)
    fits = fit_each(bench, base, screening, progress)
    bench, base, fits = _again(bench, base, fits)
    judged = _judged(bench, base, fits)
    return TestedBase(base, screening, first).outcome(bench, judged, fits)


def _judged(
    bench: ContactBench, base: Fit, fits: Sequence[Fit]
) -> list[tuple[Fit, Acceptance]]:
    """Judge the fits that cannot be distinguished by score, accepted ones first.

    A fit that leaves a shape in the residual is no explanation, even where its score
    is a little better than that of one with more parameters.
    """
    if not fits:
        return []
    limit = score(bench, fits[0]) + bench.policy.rival_score
    found = []
    for fit in (f for f in fits if score(bench, f) < limit):
        tested = [*bench.candidates, *bench.probes]
        left = screen(bench, fit, [c for c in tested if c not in fit.candidates])
        found.append((fit, accept_contact(bench, fit, base, left)))
    return sorted(found, key=lambda pair: not pair[1].passed)


def fit_contact_base(bench: ContactBench) -> tuple[ContactBench, Fit]:
    """Fit the base, linearise its law there, and fit again.

    Args:
        bench: as made.
    """
    start = np.zeros(bench.base_sd.size)
    fit = _minimum(bench, (), start)
    bench = bench.refine(fit.base, ())
    return bench, _minimum(bench, (), fit.x)


def fit_each(
    bench: ContactBench, base: Fit, screening: Screening, progress: Progress
) -> list[Fit]:
    """Fit every effect of the catalogue to all values, best score first.

    Args:
        bench: with the law linearised at the base.
        base: fit without effects.
        screening: directed tests of the base.
        progress: receives the label of each effect.
    """
    fits = []
    for candidate in bench.candidates:
        progress(candidate.label)
        fits.append(fit_effect(bench, base, screening, candidate))
    return sorted(fits, key=lambda f: score(bench, f))


def _minimum(
    bench: ContactBench, candidates: Sequence[Candidate], start: FloatArray
) -> Fit:
    problem = make_problem(bench, candidates)
    return minimise(problem, start, FULL, iterations=CONTACT.descent_steps)


def fit_effect(
    bench: ContactBench, base: Fit, screening: Screening, candidate: Candidate
) -> Fit:
    """Fit one effect from its directed tests and from far starts.

    Args:
        bench: with the law linearised at the base.
        base: fit without effects.
        screening: directed tests of the base.
        candidate: the effect.
    """
    problem = make_problem(bench, (candidate,))
    starts = [
        along(problem, base, d, FULL).x
        for d in screening.best(candidate, CONTACT.starts)
    ]
    for amplitude in candidate.effect.parameters[0].far:
        for point in start_grid(candidate):
            # From the nominal base: that of the fit has given way to the effect.
            far = np.array(point)
            far[0] = amplitude
            starts.append(np.concatenate([np.zeros(base.n_base), far]))
    fits = [
        minimise(problem, x, FULL, iterations=CONTACT.first_steps, exact_slopes=False)
        for x in starts
    ]
    return _minimum(bench, (candidate,), min(fits, key=lambda f: f.cost).x)


def _again(
    bench: ContactBench, base: Fit, fits: list[Fit]
) -> tuple[ContactBench, Fit, list[Fit]]:
    """Linearise the law at the best fit, and fit the base and the close rivals."""
    if not fits:
        return bench, base, fits
    bench = bench.refine(fits[0].base, ())
    close = [_minimum(bench, f.candidates, f.x) for f in fits[: CONTACT.close_fits]]
    base = _minimum(bench, (), base.x)
    return (
        bench,
        base,
        sorted([*close, *fits[CONTACT.close_fits :]], key=lambda f: score(bench, f)),
    )


def accept_contact(
    bench: ContactBench, fit: Fit, base: Fit, left: Screening
) -> Acceptance:
    """Judge a fit by its cost, its directed tests, its priors and its size.

    Args:
        bench: of the fit.
        fit: with or without an effect.
        base: fit without effects.
        left: directed tests of the fit by other effects and by probes.
    """
    model = 0.0
    if fit.candidates:
        own = fit.candidates[-1].effect.model_error
        share = CONTACT.model_error if own is None else own
        model = share * max(base.cost - max(bench.blocks.dof, 1), 0.0)
    return accept_law(bench, fit, base, left, _LIMITS, model=model)
