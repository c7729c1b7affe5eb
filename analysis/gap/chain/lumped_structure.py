# SPDX-License-Identifier: MIT
"""What hits on a lumped bench say of its joint in each state, and of its structure.

The joint's stiffness and damping are free in each state, so that a fault of the contact
law or of the surfaces cannot appear as one of the structure.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.signal import argrelmin

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.analysis.gap.catalogue.catalogue import CATALOGUE
from jointbench.analysis.gap.chain.chain_records import (
    JointReading,
    LinkTest,
    StructureReading,
)
from jointbench.analysis.gap.chain.chain_settings import CHAIN
from jointbench.analysis.gap.diagnosis.base_fit import fit_base
from jointbench.analysis.gap.diagnosis.diagnose import conclude
from jointbench.analysis.gap.diagnosis.loop import investigate
from jointbench.analysis.gap.judgement.campaign_limits import campaign_limits
from jointbench.analysis.gap.judgement.naming import accept
from jointbench.analysis.gap.model.campaign import Campaign
from jointbench.analysis.gap.model.diagnosis_record import Diagnosis, Finding
from jointbench.analysis.gap.model.effect import Candidate, Term
from jointbench.analysis.gap.residuals.bench_protocol import values_of
from jointbench.analysis.gap.residuals.evaluation_resolutions import Resolution
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.gap.residuals.make_bench import make_bench
from jointbench.analysis.gap.response.effect_hooks import LumpedEffect
from jointbench.analysis.gap.search.descent import (
    BASE_RESOLUTIONS,
    fit_coarse_to_fine,
    minimise,
)
from jointbench.analysis.gap.search.screening import screen

Progress = Callable[[str], None]
_PRELOAD_FAMILY = "preload"
"""Effects of the preload belong to the contact law: the joint is free in each state."""


@dataclass(frozen=True, slots=True, eq=False)
class FittedState:
    """The hits of one state with the fits of the structure.

    Attributes:
        bench: hits and model of the state.
        before: fit of the model as it is.
        after: fit with the effects of the structure; None where none is named.
        corrected: bench with the noise estimated at that fit.
    """

    bench: LumpedBench
    before: Fit
    after: Fit | None = None
    corrected: LumpedBench | None = None

    @property
    def best(self) -> Fit:
        """The fit with the effects, if there are any."""
        return self.before if self.after is None else self.after


@dataclass(frozen=True, slots=True, eq=False)
class LumpedStructure:
    """Hits of all states, and what they say.

    Attributes:
        reading: of structure and joint.
        states: fits, in the order of the states.
        link: index of the joint among the links of the model.
        diagnosis: of the state with most hits; None where no effect was sought.
    """

    reading: StructureReading
    states: tuple[FittedState, ...]
    link: int
    diagnosis: Diagnosis | None


@one_thread()
def read_lumped(
    campaigns: Sequence[Campaign],
    *,
    link: int,
    without: frozenset[str] = frozenset(),
    entries: tuple[LumpedEffect, ...] = CATALOGUE,
    progress: Progress = lambda line: None,
) -> LumpedStructure:
    """Fit the structure to the hits of every state, and test it.

    Args:
        campaigns: the hits of each state, with one preload each.
        link: index of the joint among the links of the model.
        without: names of effects to leave out of the catalogue.
        entries: the catalogue; effects of the preload are left out.
        progress: receives one line per step.

    Raises:
        BadData: a state has too few hits.
    """
    own = tuple(e for e in entries if e.effect.family != _PRELOAD_FAMILY)
    kept = without & {e.effect.name for e in own}
    states = []
    for campaign in campaigns:
        progress(f"fitting the hits at {campaign.preload[0]:.4g} N")
        states.append(_fitted(campaign, link, kept, own))
    richest = int(np.argmax([len(c.hit) for c in campaigns]))
    progress(f"testing the structure at {campaigns[richest].preload[0]:.4g} N")
    found, reading = _test(states[richest].bench, progress)
    if found is not None and found.verdict is not Finding.NAMED:
        others = [one for k, one in enumerate(states) if k != richest]
        if (test := repeated_elsewhere(reading.test, others, progress)).passed:
            found, reading = None, replace(reading, test=test)
    before = _joint(states, link, reading.test)
    if found is None or found.verdict is not Finding.NAMED:
        finding = Finding.NONE if found is None else found.verdict
        return LumpedStructure(
            StructureReading(
                before,
                finding=finding,
                effects=() if found is None else found.effects,
                reason=reading.test.reason if found is None else found.reason,
                experiment="" if found is None else found.experiment,
                family=_family(found),
            ),
            tuple(states),
            link,
            found,
        )
    for k, state in enumerate(states):
        progress(f"fitting the hits at {campaigns[k].preload[0]:.4g} N again")
        states[k] = _with_effects(state, reading.bench, reading.fit, link)
    after = _joint(states, link, reading.after)
    structure = StructureReading(
        before, after, found.verdict, found.effects, found.reason, found.experiment
    )
    return LumpedStructure(structure, tuple(states), link, found)


@dataclass(frozen=True, slots=True, eq=False)
class _StructureTest:
    """Outcome of the test of the structure at one state."""

    bench: LumpedBench
    fit: Fit
    test: LinkTest
    after: LinkTest


def _test(
    bench: LumpedBench, progress: Progress
) -> tuple[Diagnosis | None, _StructureTest]:
    """Search for an effect of the structure; no diagnosis where none is missing."""
    outcome = investigate(bench, progress)
    final = outcome.bench
    if not isinstance(final, LumpedBench):
        raise TypeError("the search must return a bench of the type it was given")
    dof = final.blocks.dof
    test = LinkTest(
        outcome.base.cost,
        dof,
        outcome.base_acceptance.passed,
        outcome.base_acceptance.reason or "explains its hits with a free joint",
    )
    charge = bench.policy.parameter_charge * (outcome.best.x.size - outcome.base.x.size)
    after = LinkTest(
        outcome.best.cost, dof, outcome.acceptance.passed, "with the effects", charge
    )
    tested = _StructureTest(final, outcome.best, test, after)
    if test.passed:
        return None, tested
    limits = campaign_limits(final.campaign, final.policy)
    return conclude(outcome, final, limits=limits, progress=progress), tested


def repeated_elsewhere(
    failed: LinkTest, others: Sequence[FittedState], progress: Progress
) -> LinkTest:
    """Return a failed test of the structure; passed where no other state repeats it.

    Structure and channels are the same at every preload, so that a fault is seen again
    in other hits, and a chance deviation of one state is not.

    Args:
        failed: test at the state with most hits, of an effect that is not named.
        others: all further states.
        progress: receives one line per step.
    """
    if not others:
        return failed
    # That with most hits; its base has been fitted.
    other = max(others, key=lambda one: len(one.bench.campaign.hit))
    bench, fit = other.bench, other.before
    preload = f"{bench.campaign.preload[0]:.4g} N"
    progress(f"testing the structure at {preload}")
    judged = accept(bench, fit, fit, screen(bench, fit, bench.candidates))
    if not judged.passed:
        return failed
    words = (
        f"explains its hits with a free joint; {failed.reason}, but not at {preload}"
    )
    return replace(failed, passed=True, reason=words)


def _fitted(
    campaign: Campaign,
    link: int,
    without: frozenset[str],
    entries: tuple[LumpedEffect, ...],
) -> FittedState:
    """Fit the base to the hits of one state, from stiffnesses that were scanned for."""
    if len(campaign.hit) < CHAIN.least_hits:
        raise BadData(
            f"{len(campaign.hit)} hit at {campaign.preload[0]:.4g} N; at least "
            f"{CHAIN.least_hits} of each preload give a stiffness: add hits"
        )
    free = replace(campaign, preload_reference=float(campaign.preload[0]))
    first = make_bench(_freed(free, link, 1.0), without=without, entries=entries)
    at = len(campaign.model.bodies) + link
    found: list[FittedState] = []
    for start in _scanned(first, link, np.zeros(first.base_sd.size)):
        factor = float(np.exp(start[at]))
        own = _freed(free, link, factor)
        bench = make_bench(own, without=without, entries=entries)
        settled, fit = fit_base(bench)
        if not isinstance(settled, LumpedBench):
            raise TypeError("a fit must return a bench of the type it was given")
        state = FittedState(settled, fit)
        if fit.chi2 <= CHAIN.least_explained * settled.blocks.dof:
            return state
        found.append(state)
    # With an effect to be found none explains its hits, and their noise hides which is
    # the least poor.
    return found[0]


def _freed(campaign: Campaign, link: int, factor: float) -> Campaign:
    """Return a campaign whose joint has any stiffness and damping."""
    links = list(campaign.model.links)
    one = links[link]
    links[link] = replace(
        one,
        stiffness=one.stiffness * factor,
        damping=one.damping * np.sqrt(factor),
        stiffness_spread=CHAIN.free_stiffness_sd,
        damping_spread=CHAIN.free_stiffness_sd,
    )
    return replace(campaign, model=replace(campaign.model, links=tuple(links)))


def _scanned(
    bench: LumpedBench, link: int, base: FloatArray, terms: Sequence[Term] = ()
) -> list[FloatArray]:
    """Return bases whose joint's stiffness explains the first milliseconds, best first.

    A joint that is far too stiff or soft fits a short window almost as well as the
    right one: every minimum along the stiffness is a start, of two windows.
    """
    at = len(bench.campaign.model.bodies) + link
    damping = at + len(bench.campaign.model.links)
    steps = np.linspace(-CHAIN.scan_reach, CHAIN.scan_reach, CHAIN.scan_points)
    tried = np.tile(base, (steps.size, 1))
    tried[:, at] = steps
    # Damping grows with the root of the stiffness at one damping ratio.
    tried[:, damping] += 0.5 * (steps - base[at])
    ranked: dict[int, float] = {}
    for length in CHAIN.scan_windows:
        window = Resolution(length)
        costs = np.array([_squares(bench.residual(x, terms, window)) for x in tried])
        for step in argrelmin(np.pad(costs, 1, constant_values=np.inf))[0] - 1:
            share = float(costs[step] / costs.min())
            ranked[int(step)] = min(share, ranked.get(int(step), np.inf))
    order = sorted(ranked, key=lambda step: ranked[step])
    return [tried[step] for step in order[: CHAIN.scan_starts]]


def _squares(residual: FloatArray) -> float:
    return float(residual @ residual)


def _family(found: Diagnosis | None) -> str:
    """Return family and site of the law that explains most of the gap, in words."""
    if found is None or found.verdict is not Finding.MOSTLY or found.partial is None:
        return ""
    return f"{found.partial.family} at {found.partial.site}"


def _with_effects(
    state: FittedState, bench: LumpedBench, fit: Fit, link: int
) -> FittedState:
    """Fit a state with the effects found at another one."""
    own, base = state.bench, fit.base.copy()
    # Nominal values of the joint differ from state to state.
    at = len(own.campaign.model.bodies) + link
    for k in (at, at + len(own.campaign.model.links)):
        here, there = own.campaign.model.nominal[k], bench.campaign.model.nominal[k]
        base[k] += np.log(there / here)
    terms = tuple(
        Term(t.candidate, _coordinates(own, t.candidate, values_of(bench, t)))
        for t in fit.terms
    )
    known = base.copy()
    known[[at, at + len(own.campaign.model.links)]] = state.before.base[
        [at, at + len(own.campaign.model.links)]
    ]
    problem = make_problem(own, fit.candidates)
    tried = []
    for near in (known, *_scanned(own, link, base, terms)):
        start = np.concatenate([near, *(t.coordinates for t in terms)])
        tried.append(fit_coarse_to_fine(problem, start, BASE_RESOLUTIONS))
        if tried[-1].chi2 <= CHAIN.least_explained * own.blocks.dof:
            break
    finite = [one for one in tried if np.isfinite(one.residual).all()]
    for early in sorted(finite, key=lambda one: one.cost):
        # Scatter and noise at a fit that lacks the effect hide what it explains.
        refined = own.refine(early.base, early.terms)
        after = minimise(make_problem(refined, fit.candidates), early.x)
        if after.chi2 <= CHAIN.least_explained * refined.blocks.dof:
            return replace(state, after=after, corrected=refined)
    return state


def _coordinates(
    bench: LumpedBench, candidate: Candidate, values: FloatArray
) -> FloatArray:
    """Return the coordinates of values [SI] on a bench, shape (n_parameters,)."""
    return np.array(
        [
            p.encode(float(v) / bench.scale(p.scale))
            for p, v in zip(candidate.effect.parameters, values, strict=True)
        ]
    )


def _joint(states: Sequence[FittedState], link: int, test: LinkTest) -> JointReading:
    """Return ln k of the joint in each state, with its variance."""
    values, variances = [], []
    corrected = any(state.after is not None for state in states)
    for state in states:
        model = state.bench.campaign.model
        at = len(model.bodies) + link
        fit = state.best
        values.append(np.log(model.links[link].stiffness) + fit.base[at])
        # A state that the effects do not fit leaves the joint open.
        lost = corrected and state.after is None
        variance = CHAIN.free_stiffness_sd**2 if lost else fit.covariance[at, at]
        variances.append(float(variance))
    return JointReading(np.array(values), np.diag(variances), test)
