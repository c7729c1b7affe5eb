# SPDX-License-Identifier: MIT
"""Judging: noise estimated at the winner, rivals fitted again there, and the gate."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.analysis.gap.judgement.amplitudes import weakest_amplitude
from jointbench.analysis.gap.judgement.judgement_settings import JUDGEMENT
from jointbench.analysis.gap.judgement.naming import Acceptance, accept
from jointbench.analysis.gap.model.effect import PROBE_FAMILY, labels_of
from jointbench.analysis.gap.residuals.bench_protocol import Bench
from jointbench.analysis.gap.residuals.evaluation_resolutions import FULL
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.candidate_starts import started
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.search.restarts import caught_up
from jointbench.analysis.gap.search.screening import Screening, screen
from jointbench.analysis.gap.search.selection_round import Progress, finish, score

OVERTAKEN = JUDGEMENT.overtaking_rounds


@dataclass(frozen=True, slots=True, eq=False)
class PredictedGains:
    """What directed tests of a fit foretold of one more effect on it.

    Attributes:
        onto: the fit.
        screening: its directed tests.
    """

    onto: Fit
    screening: Screening


def judge(
    bench: Bench,
    fits: Sequence[Fit],
    base: Fit,
    progress: Progress,
    predicted_gains: PredictedGains | None = None,
) -> tuple[Bench, list[Fit], Acceptance]:
    """Estimate the noise at the winner, refit the leaders there and judge.

    Noise, scatter and settling of the hits are known no better than the fit at which
    they were estimated, so they and the winner are brought to agree. Rivals are then
    fitted with the same noise; one that overtakes is judged in its turn. Where the
    winner fails, those that were held back are settled each by itself.
    """
    if not fits:
        return bench, [], accept(bench, base, base, None)
    met = _brought_near(bench, fits[0], progress)
    if met is None:
        return bench, list(fits), accept(bench, fits[0], base, None, fits)
    bench, first = met
    ranked, tried = [first, *fits[1:]], set[frozenset[str]]()
    for _ in range(OVERTAKEN):
        found = _judged(bench, ranked, base, progress)
        if predicted_gains is not None and not found.acceptance.passed:
            held = _held_back(found, ranked, predicted_gains, tried)
            found = _own_settling(found, held, ranked, base, progress, tried)
        bench = found.bench
        rest = [f for f in ranked if f is not found.first]
        close = _close(found, rest)
        ranked = [found.fit] + [
            caught_up(bench, f, found.fit, progress)
            if f in close or _part_of(f, found.fit)
            else f
            for f in rest
        ]
        ranked.sort(key=lambda f: score(bench, f))
        if ranked[0] is found.fit:
            break
    best = ranked[0]
    if best is found.fit:
        return bench, ranked, accept(bench, best, found.base, found.left, ranked)
    base, left = _alike(bench, best, base), _left_by(bench, best)
    return bench, ranked, accept(bench, best, base, left, ranked)


def far_off(bench: Bench, fit: Fit) -> bool:
    """Tell whether a fit leaves a misfit of many times the noise."""
    return fit.chi2 > bench.policy.far_chi2 * bench.blocks.dof


def _brought_near(
    bench: Bench, fit: Fit, progress: Progress
) -> tuple[Bench, Fit] | None:
    """Return a fit on a bench where it is not far off, or None where it always is.

    Nothing can be learnt of noise and scatter there, and rivals are no better. In a
    quiet campaign the scatter alone may lead it off; then it is fitted about the hits
    as they settled.
    """
    if not far_off(bench, fit):
        return bench, fit
    there = bench.refine(fit.base, fit.terms)
    r = there.residual(fit.base, fit.terms, FULL)
    if float(r @ r) < bench.policy.far_chi2 * bench.blocks.dof:
        return bench, fit
    there = bench.refine(fit.base, fit.terms, diverged=True)
    if not there.expanded:
        return None
    again = finish(make_problem(there, fit.candidates), fit.x, progress)
    return None if far_off(there, again) else (there, again)


def _close(found: "_Judged", rest: Sequence[Fit]) -> list[Fit]:
    """Return the fits behind the winner that may still overtake it.

    What the winner gained by being settled, the next few may gain too: their costs
    are those under a noise that was estimated where less was explained.
    """
    reach = (
        JUDGEMENT.refit_score
        if found.acceptance.passed
        else JUDGEMENT.refit_score_failed
    )
    gained = max(found.first.cost - found.fit.cost, 0.0)
    delta_score = [
        score(found.bench, f) - score(found.bench, found.first) for f in rest
    ]
    near = [f for f, b in zip(rest, delta_score, strict=True) if b < reach]
    wide = [
        f
        for f, b in zip(rest, delta_score, strict=True)
        if b < JUDGEMENT.gain_share * gained
    ]
    return near + wide[: JUDGEMENT.hidden_rivals]


@dataclass(frozen=True, slots=True, eq=False)
class _Judged:
    """A fit before and after it was settled, with all that it was judged by.

    Attributes:
        first: the fit before.
        fit: the fit after.
        bench: with the noise estimated at it.
        base: fit without effects that it is held against.
        left: directed tests of what it leaves.
        acceptance: its judgement.
    """

    first: Fit
    fit: Fit
    bench: Bench
    base: Fit
    left: Screening
    acceptance: Acceptance


def _judged(
    bench: Bench, ranked: Sequence[Fit], base: Fit, progress: Progress
) -> _Judged:
    """Settle the first of some fits and judge it."""
    bench, fit = _settled(bench, ranked[0], progress)
    left = _left_by(bench, fit)
    base = _alike(bench, fit, base)
    judgement = accept(bench, fit, base, left, ranked)
    return _Judged(ranked[0], fit, bench, base, left, judgement)


def _alike(bench: Bench, fit: Fit, base: Fit) -> Fit:
    """Return the base under the noise of a fit, where its effect may be worth nothing.

    A trend over the records that is in no catalogue was taken for scatter once any
    effect was in. The base of before, to which there was no scatter, then makes that
    effect look needed, though its amplitude is none.
    """
    limit = bench.policy.amplitude_limit
    if len(fit.candidates) != 1 or weakest_amplitude(fit) > limit:
        return base
    return minimise(make_problem(bench, ()), fit.base)


def _own_settling(
    failed: _Judged,
    held: Sequence[Fit],
    ranked: Sequence[Fit],
    base: Fit,
    progress: Progress,
    tried: set[frozenset[str]],
) -> _Judged:
    """Return the first of those held back that passes by itself, or what failed.

    Those that were reached are added to `tried`.
    """
    for f in held:
        tried.add(labels_of(f.candidates))
        rest = [r for r in ranked if r is not f]
        found = _judged(failed.bench, [f, *rest], base, progress)
        if found.acceptance.passed:
            return found
    return failed


def _held_back(
    failed: _Judged,
    ranked: Sequence[Fit],
    predicted_gains: PredictedGains,
    tried: Collection[frozenset[str]],
) -> list[Fit]:
    """Return the fits of which their directed tests foretold more than was gained.

    An expansion about another fit holds back one that differs from it; it may even
    have lost the race. What scatters cannot be told where a fit misses by more than
    noise. What was tried by itself before comes out the same.
    """
    if (
        not failed.bench.expanded
        or failed.acceptance.excess > failed.acceptance.allowed
    ):
        return []
    onto, gained = predicted_gains.onto, predicted_gains.onto.cost - failed.first.cost
    fits = {labels_of(f.candidates): f for f in ranked}
    held: dict[frozenset[str], Fit] = {}
    for d in predicted_gains.screening.directions:
        both = labels_of((*onto.candidates, d.candidate))
        fair = not d.suggested and d.candidate.effect.family != PROBE_FAMILY
        if fair and d.drop > gained and both not in held and both not in tried:
            held[both] = fits.get(both) or started(failed.bench, onto, d)
    fresh = [f for f in held.values() if f is not failed.first]
    return fresh[: JUDGEMENT.own_noise_fits]


def _part_of(fewer: Fit, more: Fit) -> bool:
    """Tell whether a fit is another one without some of its effects.

    What an effect is worth is read from such a fit, so its noise must be the same.
    """
    return labels_of(fewer.candidates) < labels_of(more.candidates)


def _settled(bench: Bench, fit: Fit, progress: Progress) -> tuple[Bench, Fit]:
    """Bring a fit and the noise estimated at it to agree, unless it runs away.

    A trend that is scatter by one fit and none by the next goes to and fro for ever.
    Then the fit that leaves more is taken: there the least is called scatter.
    """
    earlier, before = np.inf, fit.cost
    for _ in range(JUDGEMENT.settling_rounds):
        bench = bench.refine(fit.base, fit.terms)
        problem = make_problem(bench, fit.candidates)
        fit = finish(problem, fit.x, progress)
        to_and_fro = (
            abs(fit.cost - earlier) < JUDGEMENT.repeated_cost and fit.cost > before
        )
        if (
            abs(fit.cost - before) < JUDGEMENT.settled_cost
            or to_and_fro
            or far_off(bench, fit)
        ):
            break
        earlier, before = before, fit.cost
    return bench, fit


def _left_by(bench: Bench, fit: Fit) -> Screening:
    """Test what a fit leaves for all other effects and the probes."""
    others = [c for c in bench.candidates if c not in fit.candidates]
    return screen(bench, fit, [*others, *bench.probes])
