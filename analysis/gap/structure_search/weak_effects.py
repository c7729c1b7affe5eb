# SPDX-License-Identifier: MIT
"""Weak effects beside a base that explains the hits, the table wrong as bodies are.

Errors of residues are taken as independent in all modes, points and channels, which
holds for any table, and hides what is not larger than they are. A table of bodies has
far fewer errors, each in all records at once (see `body_errors`), and beside these an
effect at one channel or place stands out by much more. No table need be of that kind:
an effect counts only where it leaves no more than such a table does.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.judgement.rivals import rivals
from jointbench.analysis.gap.model.effect import Candidate, Term, words_of
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import FitProblem, make_problem
from jointbench.analysis.gap.residuals.slopes import along_columns, linear_change
from jointbench.analysis.gap.search.candidate_starts import along
from jointbench.analysis.gap.search.descent import Descent, descend
from jointbench.analysis.gap.search.screening import Screening, screen
from jointbench.analysis.gap.search.search_settings import SEARCH
from jointbench.analysis.gap.search.selection_round import Progress, score
from jointbench.analysis.gap.structure_bench.body_errors import (
    responses_to_body_errors,
)
from jointbench.analysis.gap.structure_bench.structure_bench import StructureBench
from jointbench.analysis.gap.structure_response.residue_errors import (
    separable,
    typical_peaks,
)
from jointbench.analysis.gap.structure_search.differences_from_base import differs
from jointbench.analysis.gap.structure_search.fits_from_base import WINDOW
from jointbench.analysis.gap.structure_search.records_of_search import hardest
from jointbench.analysis.gap.structure_search.retuned_modes import retuned
from jointbench.analysis.gap.structure_search.sensors_from_base import within_tolerance
from jointbench.analysis.gap.structure_search.structure_acceptance import (
    accept_structure,
)
from jointbench.analysis.gap.structure_search.structure_fits import settled
from jointbench.analysis.gap.structure_search.structure_search_settings import (
    STRUCTURE_SEARCH,
)
from jointbench.analysis.gap.structure_search.weak_settings import WEAK
from jointbench.analysis.gap.structure_search.whole_records import (
    JudgedFit,
    at_rest,
    best_first,
)


@dataclass(frozen=True, slots=True, eq=False)
class WeakEffects:
    """What is found beside a base, the table wrong as bodies are.

    Attributes:
        few: records of the tests, as the base weighs them.
        x: coordinates of the base in the tests, shape (n_base,).
        left: what it leaves beyond noise.
        cost: of it in the tests.
        tests: directed ones.
        fits: accepted ones of weak effects that the tests do not separate, best first,
            at rest, with the costs of the tests.
        complete: whether no effect counts, and the base leaves no more than errors of
            bodies do, or what it leaves resembles no effect at all.
        suspected: effect that takes part of what the base leaves, none all of it; None
            where no test shows more than errors of tables do.
    """

    few: StructureBench
    x: FloatArray
    left: float
    cost: float
    tests: Screening
    fits: tuple[JudgedFit, ...] = ()
    complete: bool = False
    suspected: Candidate | None = None

    @property
    def explains(self) -> bool:
        """Whether errors of bodies explain what the base leaves, without an effect."""
        return self.complete and self.left < WEAK.left

    def supports(self, fit: Fit) -> bool:
        """Return whether an effect takes a good part of what the base leaves here.

        An effect that explains the hits beside errors of residues of any kind may be
        one that these errors imitate. Where the table is wrong otherwise than bodies
        are, the base leaves much, and an effect that is there takes part of it.

        Args:
            fit: of effects to all records.
        """
        if self.left < WEAK.left:
            return True
        own = weighed_by_bodies(self.few, self.x)
        if own is None:
            return True
        problem = make_problem(own, fit.candidates)
        start = np.concatenate([self.x, fit.x[fit.n_base :]])
        steps = STRUCTURE_SEARCH.approach_iterations
        found = completed(_fitted(problem, start, steps))
        return beyond_noise(own, found) < max(WEAK.left, WEAK.part * self.left)


def weak_effects(
    whole: StructureBench, base: Fit, progress: Progress
) -> WeakEffects | None:
    """Test weak effects beside a base, and fit those that show; None if it cannot be.

    Args:
        whole: all records, on which the base was found and explains them.
        base: fit without effects.
        progress: receives one line for each step.
    """
    progress("directed tests of weak effects")
    few = whole.chosen(hardest(whole.campaign.hits, WEAK.levels))
    few, start = retuned(few, base.x, (), every_pair=True)
    own = weighed_by_bodies(few, start)
    if own is None:
        return None
    steps = WEAK.iterations
    near = _fitted(make_problem(own, ()), start, steps)
    weak = [c for c in own.addable(()) if _may_be_weak(own, c)]
    tests = screen(own.for_tests(near, WINDOW), near, weak, resolution=WINDOW)
    ended = completed(near)
    found = WeakEffects(few, near.x, beyond_noise(own, ended), ended.cost, tests)
    near, best = _explaining(own, near, tests, progress)
    if not best:
        share = tests.largest / found.cost
        much = found.left > WEAK.left
        leader = next(iter(tests.leaders(1)), None)
        return replace(
            found,
            complete=share < WEAK.resemblance or not much,
            suspected=leader if much and share > WEAK.suspicion else None,
        )
    del own
    done = [_in_all_records(whole, base, one, progress) for one in best]
    accepted = best_first([one for one in done if one.acceptance.passed])
    return replace(found, cost=near.cost, fits=tuple(accepted))


def supported_fits(
    done: Sequence[JudgedFit], weak: WeakEffects | None
) -> list[JudgedFit]:
    """Return fits without accepted ones that tests of weak effects do not support.

    Laws and effects of the torque have no such tests.

    Args:
        done: fits to all records, best first.
        weak: these tests; None where there are none.
    """
    if weak is None:
        return list(done)
    return [
        one
        for one in done
        if not one.acceptance.passed
        or one.bench.nonlinear(one.fit.candidates)
        or any(differs(one.bench, c) for c in one.fit.candidates)
        or weak.supports(one.fit)
    ]


def weighed_by_bodies(
    bench: StructureBench, base: FloatArray, terms: Sequence[Term] = ()
) -> StructureBench | None:
    """Return a bench that weighs its table by errors of bodies.

    What these leave, of second order, is a share of the errors of residues and a floor.

    Args:
        bench: some records, about where their hits landed.
        base: coordinates of a fit, shape (n_base,).
        terms: its effects.

    Returns:
        The bench for the window of the tests; None where the joints follow the torque.
    """
    model = bench.model(base, terms, WINDOW.window)
    follows = model.state.exponent or model.state.damping_exponent
    if follows or bench.errors is None:
        return None
    hits = bench.campaign.hits
    peak = typical_peaks(bench.campaign, np.abs(hits.response).max(axis=2))
    floor = WEAK.floor * np.sqrt(bench.coherence) * peak
    sd = WEAK.share * bench.errors.sd
    return replace(
        bench,
        sigma=separable(bench.campaign, np.hypot(hits.noise, floor)),
        errors=replace(bench.errors, sd=sd),
        bodies=responses_to_body_errors(model, bench.landing),
        kept={},
    )


def beyond_noise(bench: StructureBench, fit: Fit) -> float:
    """Return what a fit leaves beyond noise, over as many numbers as records have.

    Args:
        bench: that weighs its table by errors of bodies.
        fit: in a window.
    """
    noise = bench.campaign.hits.noise / bench.sigma
    samples = fit.residual.size / noise.size
    left = fit.chi2 - samples * float(np.sum(noise**2))
    return left * bench.coherence / fit.residual.size


def completed(fit: Fit) -> Fit:
    """Return a fit at the end of the step that its linear model promises.

    Frequencies of closed modes slip by a radian within a thousandth, so that a descent
    creeps where base and effect exchange stiffness or mass, while the cost is nearly
    quadratic in the effect and in what the records determine. The base stays.

    Args:
        fit: with its slopes.
    """
    gradient = along_columns(fit.jacobian, fit.residual)
    gradient += fit.prior * (fit.x - fit.centre)
    step = -fit.covariance @ gradient
    longest = SEARCH.longest_step
    x = fit.x.copy()
    x[fit.n_base :] += np.clip(step[fit.n_base :], -longest, longest)
    return replace(
        fit,
        x=x,
        residual=fit.residual + linear_change(fit.jacobian, step),
        cost=fit.cost + float(gradient @ step),
    )


def _fitted(problem: FitProblem, start: FloatArray, steps: int) -> Fit:
    """Return a fit in the window of the tests, without steps that creep.

    Args:
        problem: on a bench that weighs its table by errors of bodies.
        start: coordinates, shape (n,).
        steps: most steps.
    """
    least = STRUCTURE_SEARCH.table_drop
    how = Descent(WINDOW, iterations=steps, least_drop=least, sparing=True)
    return descend(problem, start, how)


def _may_be_weak(bench: StructureBench, candidate: Candidate) -> bool:
    """Return whether an effect has no tests of its own beside a base.

    Where hits landed is found from them, hit by hit.
    """
    aimed = {e.effect.name for e in bench.entries if e.aimed}
    return candidate.effect.name not in aimed and not differs(bench, candidate)


def _explaining(
    own: StructureBench, near: Fit, found: Screening, progress: Progress
) -> tuple[Fit, list[Fit]]:
    """Return the base, and fits that leave no more than errors of bodies do.

    Of these fits, the best one and those that are not distinguished from it; costs are
    those about the best one where it takes much.

    Args:
        own: records of the tests.
        near: fit without effects.
        found: tests beside it.
        progress: receives one line for each fit.
    """
    fits: list[Fit] = []
    least = max(WEAK.drop, WEAK.rival * found.largest)
    for candidate in found.leaders(STRUCTURE_SEARCH.whole_fits):
        tests = found.best(candidate, STRUCTURE_SEARCH.starts_kept)
        if tests[0].drop < least:
            break
        progress(f"{words_of((candidate,))} as a weak effect")
        problem = make_problem(own, (candidate,))
        starts = [along(problem, near, test, WINDOW) for test in tests]
        start = min(starts, key=lambda one: one.cost)
        steps = STRUCTURE_SEARCH.approach_iterations
        fits.append(_fitted(problem, start.x, steps))
    fits.sort(key=lambda one: score(own, one))
    if fits and fits[0].cost < WEAK.part * near.cost:
        own, near, fits = _once_more(own, near, fits)
    near, fits = completed(near), [completed(one) for one in fits]
    fits.sort(key=lambda one: score(own, one))
    if not fits or not _counts(own, near, fits[0]):
        return near, []
    return near, [one for one in rivals(own, fits) if _counts(own, near, one)]


def _once_more(
    own: StructureBench, near: Fit, fits: Sequence[Fit]
) -> tuple[StructureBench, Fit, list[Fit]]:
    """Return base and fits with what the best one shows: errors, and where hits landed.

    A base without a strong effect is far from that with it, and errors of bodies and
    directions of hits are of first order.

    Args:
        own: records of the tests.
        near: fit without effects.
        fits: of effects, best first.
    """
    best, window = fits[0], WINDOW.window
    landing, _ = own.landed(best.base, best.terms, window)
    about = own.at(best.base, best.terms, landing, own.table_floor, window)
    moved = weighed_by_bodies(about, best.base, best.terms)
    if moved is None:
        return own, near, list(fits)
    steps = STRUCTURE_SEARCH.approach_iterations
    again = [
        _fitted(make_problem(moved, one.candidates), one.x, steps)
        for one in (near, *fits)
    ]
    return moved, again[0], again[1:]


def _counts(own: StructureBench, near: Fit, fit: Fit) -> bool:
    """Return whether a fit takes enough, and leaves no more than errors of bodies."""
    left = beyond_noise(own, fit)
    least = WEAK.drop * max(left, 1.0)
    enough = near.cost - fit.cost > least and not within_tolerance(own, fit)
    return enough and left < WEAK.left


def _in_all_records(
    whole: StructureBench, base: Fit, weak: Fit, progress: Progress
) -> JudgedFit:
    """Return the fit of a weak effect to all records, at rest.

    With errors of residues, these show it less well than the tests do, whose result it
    keeps as a prior.
    """
    candidates = (_as_found(weak),)
    progress(f"{words_of(candidates)} in all records")
    start = np.concatenate([base.base, weak.x[weak.n_base :]])
    bench, fit = settled(whole, start, candidates, near=True)
    judged = accept_structure(bench, fit, base)
    fit = replace(fit, cost=weak.cost)
    return at_rest(JudgedFit(bench.at_rest(), fit, judged))


def _as_found(weak: Fit) -> Candidate:
    """Return the effect of a fit, its parameters with what was found as priors.

    Parameters that change no record keep theirs.
    """
    (candidate,) = weak.candidates
    sd = np.sqrt(np.maximum(np.diag(weak.covariance), 0.0))[weak.n_base :]
    known = zip(candidate.effect.parameters, weak.x[weak.n_base :], sd, strict=True)
    parameters = tuple(
        replace(p, prior=(p.decode(float(np.clip(x, *p.bounds))), float(own)))
        if own > 0.0
        else p
        for p, x, own in known
    )
    return replace(candidate, effect=replace(candidate.effect, parameters=parameters))
