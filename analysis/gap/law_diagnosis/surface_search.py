# SPDX-License-Identifier: MIT
"""Search for what a self-affine surface lacks to explain a measured one."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.diagnosis.loop import SearchOutcome
from jointbench.analysis.gap.judgement.naming import Acceptance
from jointbench.analysis.gap.judgement.rivals import generalises
from jointbench.analysis.gap.law_diagnosis.law_acceptance import LawCriteria, accept_law
from jointbench.analysis.gap.law_diagnosis.law_outcome import TestedBase
from jointbench.analysis.gap.model.effect import (
    Candidate,
    labels_of,
    may_join,
    words_of,
)
from jointbench.analysis.gap.residuals.evaluation_resolutions import FULL
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.candidate_starts import along
from jointbench.analysis.gap.search.descent import cost_at, minimise
from jointbench.analysis.gap.search.screening import Screening, screen, start_grid
from jointbench.analysis.gap.search.selection_round import Progress, score
from jointbench.analysis.gap.surface_bench.surface_bench import SurfaceBench
from jointbench.analysis.gap.surface_bench.surface_settings import SURFACE

_LIMITS = LawCriteria(
    null_chance=SURFACE.null_chance,
    fit_chance=SURFACE.fit_chance,
    null_factor=SURFACE.null_factor,
    prior_limit=SURFACE.prior_limit,
    amplitude_limit=SURFACE.amplitude_limit,
    cost="the rows",
    rows="rows",
)
_Judged = list[tuple[Fit, Acceptance]]


def search_surface(bench: SurfaceBench, progress: Progress) -> SearchOutcome:
    """Fit the base, and search for missing effects if it does not explain the rows.

    Args:
        bench: as made.
        progress: receives one line for each step.
    """
    progress("self-affine surface")
    base = fit_surface(bench, (), np.zeros(2))
    tested = [*bench.candidates, *bench.probes]
    screening = screen(bench, base, tested)
    first = accept_surface(bench, base, base, screening)
    own = TestedBase(base, screening, first)
    if first.passed:
        return own.complete(bench)
    rounds = _Rounds(bench, base, first, progress)
    judged = rounds.grown(_ranked(bench, rounds.added(base, screening)))
    fits = sorted((fit for fit, _ in judged), key=lambda f: score(bench, f))
    return own.outcome(bench, judged, fits)


def fit_surface(
    bench: SurfaceBench, candidates: Sequence[Candidate], start: FloatArray
) -> Fit:
    """Fit base and effects from one start.

    Args:
        bench: rows and catalogue.
        candidates: effects.
        start: coordinates.
    """
    problem = make_problem(bench, candidates)
    return minimise(problem, start, FULL, iterations=SURFACE.descent_steps)


@dataclass(frozen=True, slots=True, eq=False)
class _Rounds:
    """Rounds of one more effect each.

    Attributes:
        bench: rows and catalogue.
        base: fit without effects.
        first: its acceptance.
        progress: receives one line for each fit.
    """

    bench: SurfaceBench
    base: Fit
    first: Acceptance
    progress: Progress

    def grown(self, fits: list[Fit]) -> _Judged:
        """Judge fits, and add effects as long as none explains the rows."""
        judged = self._judged(fits)
        for _ in range(1, SURFACE.most_effects):
            if not judged or judged[0][1].passed or not judged[0][1].unexplained:
                break
            more: list[Fit] = []
            for fit, one in judged[: SURFACE.first_effects]:
                if one.left is not None and one.unexplained:
                    more += self.added(fit, one.left)
            kept = [f for f in more if self._worth(f, judged)]
            if not kept:
                break
            judged = self._judged(_ranked(self.bench, [*kept, *[f for f, _ in judged]]))
        return judged

    def _worth(self, fit: Fit, judged: _Judged) -> bool:
        """Return whether a further effect gains what a name needs."""
        own = labels_of(fit.candidates)
        inner = [f for f, _ in judged if labels_of(f.candidates) < own]
        least = min((score(self.bench, f) for f in inner), default=np.inf)
        return score(self.bench, fit) < least - self.bench.policy.rival_score

    def added(self, fit: Fit, screening: Screening) -> list[Fit]:
        """Return fits with one more effect each."""
        found = []
        for candidate in self.bench.candidates:
            if may_join(candidate, fit.candidates) and _apart(candidate, fit):
                self.progress(
                    " + ".join(c.effect.name for c in (*fit.candidates, candidate))
                )
                found.append(fit_one_more(self.bench, fit, screening, candidate))
        return found

    def _judged(self, fits: list[Fit]) -> _Judged:
        """Judge the best fits, accepted ones first."""
        bench, found = self.bench, []
        tested = [*bench.candidates, *bench.probes]
        limit = score(bench, fits[0]) + bench.policy.rival_score if fits else 0.0
        for number, fit in enumerate(fits):
            if number >= SURFACE.close_fits and score(bench, fit) > limit:
                break
            rest = [c for c in tested if may_join(c, fit.candidates)]
            left = screen(bench, fit, rest)
            one = accept_surface(bench, fit, self.base, left)
            found.append((fit, self._unless_outdone(fit, one, fits)))
        return sorted(found, key=lambda pair: not pair[1].passed)

    def _unless_outdone(
        self, fit: Fit, judged: Acceptance, fits: Sequence[Fit]
    ) -> Acceptance:
        """Refuse a law that a special case of it beats by score.

        What it gains is less than its parameters cost: it bends to the residual of a
        case that was refused for its shape.
        """
        bench = self.bench
        limit = score(bench, fit) - bench.policy.rival_score
        better = [f for f in fits if generalises(fit, f) and score(bench, f) < limit]
        if not (judged.passed and better):
            return judged
        words = words_of(better[0].candidates)
        reason = f"{words}, a case of it, has the better score and is refused"
        return replace(judged, passed=False, unexplained=True, reason=reason)


def _apart(candidate: Candidate, fit: Fit) -> bool:
    """Return whether no law of a fit has the candidate as a special case."""
    name = candidate.effect.name
    return not any(
        name in c.effect.generalises or c.effect.name in candidate.effect.generalises
        for c in fit.candidates
    )


def _ranked(bench: SurfaceBench, fits: Sequence[Fit]) -> list[Fit]:
    """Return fits by score, the best of each set of effects."""
    found: dict[frozenset[str], Fit] = {}
    for fit in sorted(fits, key=lambda f: score(bench, f)):
        found.setdefault(labels_of(fit.candidates), fit)
    return list(found.values())


def fit_one_more(
    bench: SurfaceBench, fit: Fit, screening: Screening, candidate: Candidate
) -> Fit:
    """Fit one more effect from its directed test and from its grid of starts.

    Args:
        bench: rows and catalogue.
        fit: that it is added to.
        screening: directed tests of that fit.
        candidate: the effect.
    """
    problem = make_problem(bench, (*fit.candidates, candidate))
    starts = [along(problem, fit, d, FULL).x for d in screening.best(candidate, 1)]
    for tail in _far_starts(candidate):
        starts.append(np.concatenate([fit.x, tail]))
        if candidate.effect.refit_nominal:
            # What hides an effect in the base is the exponent.
            smooth = starts[-1].copy()
            smooth[1] = SURFACE.smooth_start - SURFACE.hurst
            starts.append(smooth)
    costs = [
        cost_at(problem, np.clip(x, problem.lower, problem.upper), FULL) for x in starts
    ]
    order = np.argsort(costs)[: max(SURFACE.kept_starts, len(starts) // 3)]
    fits = [
        minimise(
            problem,
            starts[k],
            FULL,
            iterations=SURFACE.first_steps,
            exact_slopes=False,
        )
        for k in order
    ]
    best = min(fits, key=lambda f: f.cost)
    return fit_surface(bench, (*fit.candidates, candidate), best.x)


def _far_starts(candidate: Candidate) -> list[FloatArray]:
    """Return the grid of starts of a candidate at all its amplitudes."""
    first, found = candidate.effect.parameters[0], []
    amplitudes = [first.encode(a) for a in first.far]
    for point in start_grid(candidate):
        if first.starts:
            found.append(np.array(point))
        for amplitude in amplitudes:
            found.append(np.array([amplitude, *point[1:]]))
    return found


def accept_surface(
    bench: SurfaceBench, fit: Fit, base: Fit, left: Screening
) -> Acceptance:
    """Judge a fit by its cost, its directed tests, its priors and its size.

    Args:
        bench: of the fit.
        fit: with or without effects.
        base: fit without effects.
        left: directed tests of the fit by other effects and by probes.
    """
    dof, model = max(bench.blocks.dof, 1), 0.0
    if fit.candidates:
        shares = [
            SURFACE.model_error if own is None else own
            for own in (c.effect.model_error for c in fit.candidates)
        ]
        model = max(shares) * max(base.cost - dof, 0.0)
        model = min(model, SURFACE.most_error * dof)
    return accept_law(bench, fit, base, left, _LIMITS, model=model)
