# SPDX-License-Identifier: MIT
"""Judge the best fit: noise estimated at it, rivals refitted, criteria applied."""

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
from jointbench.analysis.gap.search.hit_stiffness import settled_near
from jointbench.analysis.gap.search.restarts import caught_up
from jointbench.analysis.gap.search.screening import Screening, screen
from jointbench.analysis.gap.search.selection_round import Progress, finish, score

OVERTAKEN = JUDGEMENT.overtaking_rounds


@dataclass(frozen=True, slots=True, eq=False)
class PredictedGains:
    """Gains that directed tests of a fit predict for one more effect.

    Attributes:
        onto: fit that the effect is added to.
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
    """Estimate the noise at the best fit, refit its rivals with that noise, and judge.

    Noise, scatter and settling of the hits are only as accurate as the fit at which
    they are estimated, so fit and estimates are iterated to convergence. Rivals are
    then fitted with the same noise; a rival that overtakes the best fit is judged next.
    If the best fit fails, fits that its noise estimate may have disadvantaged are
    judged, each with its own noise estimate.
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
    """Return whether the residual of a fit is many times the noise."""
    return fit.chi2 > bench.policy.far_chi2 * bench.blocks.dof


def _brought_near(
    bench: Bench, fit: Fit, progress: Progress
) -> tuple[Bench, Fit] | None:
    """Return the fit on a bench where it is near the records, or None if there is none.

    Noise and scatter cannot be estimated far from the records. In a quiet campaign the
    scatter alone may cause the distance; then the model is expanded about the settling
    of each hit.
    """
    if not far_off(bench, fit):
        return bench, fit
    there = bench.refine(fit.base, fit.terms)
    r = there.residual(fit.base, fit.terms, FULL)
    if float(r @ r) < bench.policy.far_chi2 * bench.blocks.dof:
        return bench, fit
    near = settled_near(bench, fit.base, fit.terms)
    if near is None:
        return None
    there, base = near
    start = np.concatenate([base, fit.x[base.size :]])
    again = finish(make_problem(there, fit.candidates), start, progress)
    return None if far_off(there, again) else (there, again)


def _close(found: "_Judged", rest: Sequence[Fit]) -> list[Fit]:
    """Return the rivals that may still overtake the best fit.

    The gain of the best fit by its own noise estimate is also possible for the next
    few: their costs are based on a noise estimate at a worse fit.
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
    """A fit before and after convergence with its noise, and its judgement.

    Attributes:
        first: the fit before.
        fit: the fit after.
        bench: with the noise estimated at it.
        base: fit without effects, for comparison.
        left: directed tests of its residual.
        acceptance: result of the acceptance criteria.
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
    """Iterate the first fit with its noise, and judge it."""
    bench, fit = _settled(bench, ranked[0], progress)
    left = _left_by(bench, fit)
    base = _alike(bench, fit, base)
    judgement = accept(bench, fit, base, left, ranked)
    return _Judged(ranked[0], fit, bench, base, left, judgement)


def _alike(bench: Bench, fit: Fit, base: Fit) -> Fit:
    """Return the base, refitted with the noise of a fit whose effect may be zero.

    A trend over the records that no effect of the catalogue describes may be counted as
    scatter once any effect is fitted. Compared with the earlier base, without scatter,
    that effect would appear necessary although its amplitude is zero.
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
    """Return the first fit accepted with its own noise estimate, or the failed one.

    The fits judged are added to `tried`.
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
    """Return the fits whose predicted gain exceeds the gain of the best fit.

    An expansion about one fit is a disadvantage for others, which may have been dropped
    in the selection rounds. Scatter cannot be estimated at a fit that does not explain
    the records. Fits that were tried alone before are skipped.
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
    """Return whether a fit is another one without some of its effects.

    The gain of an effect is computed from such a fit, so its noise must be the same.
    """
    return labels_of(fewer.candidates) < labels_of(more.candidates)


def _settled(bench: Bench, fit: Fit, progress: Progress) -> tuple[Bench, Fit]:
    """Alternate fit and noise estimate until they converge or the fit diverges.

    A trend that counts as scatter in every other round makes the iteration alternate
    without end, and a law that leaves a residual makes it wander. Then the fit with the
    higher cost is used: it has the least scatter.
    """
    rounds: list[tuple[Bench, Fit]] = []
    costs = [np.inf, fit.cost]
    for _ in range(JUDGEMENT.settling_rounds):
        bench = bench.refine(fit.base, fit.terms)
        problem = make_problem(bench, fit.candidates)
        fit = finish(problem, fit.x, progress)
        rounds = [*rounds, (bench, fit)][-JUDGEMENT.wandering_rounds :]
        alternates = (
            abs(fit.cost - costs[-2]) < JUDGEMENT.repeated_cost and fit.cost > costs[-1]
        )
        converged = abs(fit.cost - costs[-1]) < JUDGEMENT.settled_cost
        if converged or alternates or far_off(bench, fit):
            break
        costs.append(fit.cost)
        if _wanders(costs[2:], bench.blocks.dof):
            return max(rounds, key=lambda found: found[1].cost)
    return bench, fit


def _wanders(costs: Sequence[float], dof: int) -> bool:
    """Return whether rounds far above the noise no longer approach the records."""
    count = JUDGEMENT.wandering_rounds
    if len(costs) <= count:
        return False
    lately, before = min(costs[-count:]) - dof, min(costs[:-count]) - dof
    return (
        lately > JUDGEMENT.wandering_excess * dof
        and lately > JUDGEMENT.approach_share * before
    )


def _left_by(bench: Bench, fit: Fit) -> Screening:
    """Test the residual of a fit for all other effects and the probes."""
    others = [c for c in bench.candidates if c not in fit.candidates]
    return screen(bench, fit, [*others, *bench.probes])
