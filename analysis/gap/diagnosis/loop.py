# SPDX-License-Identifier: MIT
"""The search: base, null test, selection, judgement, further effects, removal."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.analysis.gap.diagnosis.base_fit import fit_base, settled_base
from jointbench.analysis.gap.diagnosis.diagnosis_settings import DIAGNOSIS
from jointbench.analysis.gap.judgement.amplitudes import weakest_amplitude
from jointbench.analysis.gap.judgement.naming import Acceptance, accept
from jointbench.analysis.gap.judgement.rivals import rivals, without_duplicates
from jointbench.analysis.gap.judgement.winner_judging import (
    PredictedGains,
    far_off,
    judge,
)
from jointbench.analysis.gap.model.effect import Candidate, labels_of, may_join
from jointbench.analysis.gap.residuals.bench_protocol import Bench
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.response.search_effort import (
    Effort,
    SearchExhausted,
    counted,
    limited,
)
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.search.exchange import exchanged
from jointbench.analysis.gap.search.far_pairs import far_pairs
from jointbench.analysis.gap.search.restarts import crossed, other_sliders
from jointbench.analysis.gap.search.screening import Screening, screen
from jointbench.analysis.gap.search.selection_round import (
    Progress,
    continue_selection,
    finish,
    run_selection,
    score,
)


@dataclass(frozen=True, slots=True, eq=False)
class SearchOutcome:
    """Result of the search, from which a diagnosis is derived.

    Attributes:
        bench: with its final noise estimate.
        base: fit without effects.
        base_acceptance: the null test.
        base_screening: its directed tests.
        best: the best fit; the base if no effect is missing.
        acceptance: its judgement.
        ranked: fits of the last round, best first.
        level: fits that cannot be distinguished, the best first.
        given_up: whether the search for a further effect reached its effort limit.
    """

    bench: Bench
    base: Fit
    base_acceptance: Acceptance
    base_screening: Screening
    best: Fit
    acceptance: Acceptance
    ranked: tuple[Fit, ...]
    level: tuple[Fit, ...]
    given_up: bool = False


def investigate(bench: Bench, progress: Progress) -> SearchOutcome:
    """Run the search on a bench."""
    with counted() as effort:
        return _investigate(bench, progress, effort)


def _investigate(bench: Bench, progress: Progress, effort: Effort) -> SearchOutcome:
    progress("base")
    bench, base = fit_base(bench)
    screening = screen(bench, base, bench.candidates)
    first = accept(bench, base, base, screening)
    if first.passed:
        return SearchOutcome(bench, base, first, screening, base, first, (), (base,))
    fits = run_selection(bench, base, screening, bench.candidates, progress)
    found = _Round(*judge(bench, fits, base, progress, PredictedGains(base, screening)))
    found = _other_sliders(found, base, progress)
    grown: set[frozenset[str]] = set()
    given_up = False
    for count in range(1, DIAGNOSIS.most_effects):
        firsts = found.fits[: DIAGNOSIS.first_effects if count == 1 else 1]
        known = bool(firsts) and labels_of(firsts[0].candidates) in grown
        if known or not _worth_more(found, base):
            break
        grown |= {labels_of(f.candidates) for f in firsts}
        try:
            with limited(effort, bench.policy.most_samples):
                after = _one_more(found, firsts, base, progress)
        except SearchExhausted:
            given_up = True
            break
        if after is None:
            break
        found = after
    if again := _base_again(found, base, progress):
        return again
    fits = without_duplicates(found.bench, found.fits)
    best = fits[0] if fits else base
    level = tuple(rivals(found.bench, fits))
    return SearchOutcome(
        bench=found.bench,
        base=base,
        base_acceptance=first,
        base_screening=screening,
        best=best,
        acceptance=found.acceptance,
        ranked=tuple(fits),
        level=level,
        given_up=given_up,
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Round:
    """Result of a round: bench with its noise, fits (best first), acceptance."""

    bench: Bench
    fits: list[Fit]
    acceptance: Acceptance


def _one_more(
    found: _Round, firsts: Sequence[Fit], base: Fit, progress: Progress
) -> _Round | None:
    """Add one more effect to some fits; None if the gain of each is insufficient."""
    bench, alone = found.bench, len(firsts[0].candidates) == 1
    if alone and far_off(bench, firsts[0]):
        more = continue_selection(bench, far_pairs(bench, progress), progress)
    else:
        more = _add_another(bench, firsts, progress)
    if not more:
        return None
    more = crossed(bench, more, progress)
    merged = sorted([*found.fits, *more], key=lambda f: score(bench, f))
    merged = _take_back(bench, merged, progress)
    left = found.acceptance.left
    predicted_gains = (
        PredictedGains(firsts[0], left) if alone and left is not None else None
    )
    after = judged(bench, merged, base, progress, predicted_gains)
    if not _worthwhile(after.bench, after.fits[0], found.fits[0]):
        return None
    if after.acceptance.unexplained and len(after.fits[0].candidates) > 1:
        return _exchange(after, base, progress)
    return after


def judged(
    bench: Bench,
    fits: Sequence[Fit],
    base: Fit,
    progress: Progress,
    predicted_gains: PredictedGains | None = None,
) -> _Round:
    """Judge, and remove effects that have become unnecessary.

    A delay may move the base to where a relaxation becomes visible, and then end at
    amplitude zero. It may also describe a hit that the noise estimate at the pair
    takes out: then it is not distinct from zero.
    """
    found = _Round(*judge(bench, fits, base, progress, predicted_gains))
    best = found.fits[0]
    gained = fits[0].cost - best.cost >= DIAGNOSIS.needless_gain
    weak = weakest_amplitude(best) < bench.policy.amplitude_limit
    if len(best.candidates) == 1 or not (gained or weak):
        return found
    merged = _take_back(found.bench, found.fits, progress)
    if merged[0] is best:
        return found
    return _Round(*judge(found.bench, merged, base, progress))


def _other_sliders(found: _Round, base: Fit, progress: Progress) -> _Round:
    """Start other slider laws from one that does not explain the records."""
    if found.acceptance.passed or not found.fits or far_off(found.bench, found.fits[0]):
        return found
    more = other_sliders(found.bench, found.fits[0], progress)
    merged = sorted([*more, *found.fits], key=lambda f: score(found.bench, f))
    if merged[0] is found.fits[0]:
        return found
    return _Round(*judge(found.bench, _best_of_each(merged), base, progress))


def _exchange(found: _Round, base: Fit, progress: Progress) -> _Round:
    """Replace each effect of the best fit by others, if that lowers the score.

    Fits that cannot be distinguished from the best were refitted when it was judged.
    """
    near = score(found.bench, found.fits[0]) + found.bench.policy.rival_score_one_site
    close = [f for f in found.fits if score(found.bench, f) < near]
    known = {labels_of(f.candidates) for f in close}
    more = exchanged(found.bench, found.fits[0], known, progress)
    merged = sorted([*found.fits, *more], key=lambda f: score(found.bench, f))
    if merged[0] is found.fits[0]:
        return found
    return judged(found.bench, _best_of_each(merged), base, progress)


def _worth_more(found: _Round, base: Fit) -> bool:
    """Return whether one more effect is added to the best fit.

    Three effects at one link can imitate any law, and a pair that leaves a large
    residual is not part of the correct explanation.
    """
    if not found.acceptance.unexplained or not found.fits:
        return False
    fit = found.fits[0]
    if len(fit.candidates) == 1:
        return True
    links = [c.site for c in fit.candidates if c.site.kind == "link"]
    apart = len(set(links)) == len(links)
    dof = found.bench.blocks.dof
    share = found.bench.policy.third_effect_share
    return apart and fit.chi2 - dof < share * (base.chi2 - dof)


def _base_again(found: _Round, base: Fit, progress: Progress) -> SearchOutcome | None:
    """Return the null result if the base alone fits from the base of the best fit.

    In a quiet campaign with a joint that settles from hit to hit, the fit of the base
    may stop in a wrong minimum (3 of 1,500 campaigns without an effect). An effect that
    moves the base out of it would appear to explain the whole residual.
    """
    if (
        not found.fits
        or base.chi2 < DIAGNOSIS.wrong_minimum_chi2 * found.bench.blocks.dof
    ):
        return None
    progress("base again")
    fit = minimise(make_problem(found.bench, ()), found.fits[0].base)
    if fit.chi2 > DIAGNOSIS.wrong_minimum_chi2 * found.bench.blocks.dof:
        return None
    bench, fit = settled_base(found.bench, fit)
    screening = screen(bench, fit, bench.candidates)
    null = accept(bench, fit, fit, screening)
    if not null.passed:
        return None
    return SearchOutcome(bench, fit, null, screening, fit, null, (), (fit,))


def _take_back(bench: Bench, fits: Sequence[Fit], progress: Progress) -> list[Fit]:
    """Remove effects of the best fit that a later one has made unnecessary."""
    best, found = fits[0], list(fits)
    for k in range(len(best.candidates)):
        kept = tuple(c for i, c in enumerate(best.candidates) if i != k)
        if not kept:
            continue
        coordinates = [t.coordinates for i, t in enumerate(best.terms) if i != k]
        start = np.concatenate([best.base, *coordinates])
        found.append(finish(make_problem(bench, kept), start, progress))
    return _best_of_each(sorted(found, key=lambda f: score(bench, f)))


def _best_of_each(fits: Sequence[Fit]) -> list[Fit]:
    """Return the first fit of each set of effects."""
    best: dict[frozenset[str], Fit] = {}
    for f in fits:
        best.setdefault(labels_of(f.candidates), f)
    return list(best.values())


def _add_another(bench: Bench, fits: Sequence[Fit], progress: Progress) -> list[Fit]:
    """Fit the best further effects on the best fits."""
    found: list[Fit] = []
    tried: set[frozenset[str]] = set()
    for first in _hopeful(bench, fits):
        screening = screen(bench, first, _addable(bench, first))
        chosen = [
            c
            for c in _seconds(bench, first, screening)
            if labels_of((*first.candidates, c)) not in tried
        ]
        tried |= {labels_of((*first.candidates, c)) for c in chosen}
        found += run_selection(bench, first, screening, chosen, progress)
    return sorted(found, key=lambda f: score(bench, f))


def _addable(bench: Bench, fit: Fit) -> list[Candidate]:
    return [c for c in bench.candidates if may_join(c, fit.candidates)]


def _hopeful(bench: Bench, fits: Sequence[Fit]) -> list[Fit]:
    """Return the fits that may become the best with a second effect."""
    dof = bench.blocks.dof
    least = max(fits[0].cost - dof, DIAGNOSIS.noise_excess * dof)
    return [f for f in fits if f.cost - dof < DIAGNOSIS.second_cost_ratio * least]


def _seconds(bench: Bench, first: Fit, screening: Screening) -> list[Candidate]:
    """Choose second effects by predicted drop, and those that only priors show."""
    deviating = np.abs(first.prior_deviations).max() > DIAGNOSIS.prior_candidates_sd
    chosen: list[Candidate] = []
    for d in screening.directions:
        if d.candidate not in chosen and len(chosen) < DIAGNOSIS.second_candidates:
            chosen.append(d.candidate)
    for c in _addable(bench, first):
        if deviating and c.effect.by_prior and c not in chosen:
            chosen.append(c)
    return chosen


def _worthwhile(bench: Bench, more: Fit, fewer: Fit) -> bool:
    added = len(more.candidates) > len(fewer.candidates)
    gain = bench.policy.least_gain if added else 0.0
    return score(bench, more) + gain < score(bench, fewer)
