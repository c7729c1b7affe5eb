# SPDX-License-Identifier: MIT
"""The loop: base, null test, race, gate, name, add, repeat, take back."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.analysis.gap.bench import Bench
from jointbench.analysis.gap.descent import BASE_STAGES, fit_stages, minimise
from jointbench.analysis.gap.effects import Candidate
from jointbench.analysis.gap.fit import Fit, make_problem
from jointbench.analysis.gap.naming import Gate, gate, rivals, without_twins
from jointbench.analysis.gap.race import Progress, finish, race, score, started
from jointbench.analysis.gap.screening import Screening, screen

REFINEMENTS = 12
SETTLED = 0.5
"""Change of the cost below which noise, scatter and fit agree with each other."""
MOST_HELD_BACK = 2
REJUDGED = 12
AGREED = 2.0
"""Change of a winner's cost below which it agrees with the noise estimated at it."""
OVERTAKEN = 2
MOST_EFFECTS = 3
FIRSTS = 3
HOPEFUL = 4.0
"""Cost over the best first's above which a first is not given a second."""
SECONDS = 4
CLOSE = 1000.0
"""Score behind the winner up to which a rival is fitted again with the new noise."""
CLOSE_FAILED = 100.0
"""The same where the winner itself does not explain the records."""
MIN_GAIN = 35.0
"""Chi2 that a further effect must take, beyond its charge."""


@dataclass(frozen=True, slots=True, eq=False)
class Outcome:
    """What the loop found, before it is put into words.

    Attributes:
        bench: with its noise as estimated at the end.
        base: fit without effects.
        base_gate: the null test.
        base_screening: its directed tests.
        best: the winning fit; the base where nothing is missing.
        gate: its judgement.
        ranked: rivals of the last round, best first.
        level: rivals that are not told apart, the winner first.
    """

    bench: Bench
    base: Fit
    base_gate: Gate
    base_screening: Screening
    best: Fit
    gate: Gate
    ranked: tuple[Fit, ...]
    level: tuple[Fit, ...]


def investigate(bench: Bench, progress: Progress) -> Outcome:
    """Run the whole loop on a bench."""
    progress("base")
    bench, base = fit_base(bench)
    screening = screen(bench, base, bench.candidates)
    first = gate(bench, base, base, screening)
    if first.passed:
        return Outcome(bench, base, first, screening, base, first, (), (base,))
    fits = race(bench, base, screening, bench.candidates, progress)
    refined, fits, judged = judge(bench, fits, base, progress, screening)
    for count in range(1, MOST_EFFECTS):
        if not judged.unexplained or not fits or len(fits[0].candidates) < count:
            break
        firsts = fits[: FIRSTS if count == 1 else 1]
        if count > 1 and not _apart(firsts[0]):
            break
        more = add_another(refined, firsts, progress)
        if not more:
            break
        merged = sorted([*fits, *more], key=lambda f: score(refined, f))
        merged = take_back(refined, merged, progress)
        again, merged, rejudged = judge(refined, merged, base, progress)
        if not _worthwhile(again, merged[0], fits[0]):
            break
        refined, fits, judged = again, merged, rejudged
    fits = without_twins(refined, fits)
    best = fits[0] if fits else base
    level = tuple(rivals(refined, fits))
    return Outcome(refined, base, first, screening, best, judged, tuple(fits), level)


def _apart(fit: Fit) -> bool:
    """Tell whether no link bears two effects: three at one link explain anything."""
    links = [c.site for c in fit.candidates if c.site.kind == "link"]
    return len(set(links)) == len(links)


def fit_base(bench: Bench) -> tuple[Bench, Fit]:
    """Fit the base coarse to fine, estimate the noise there, and settle."""
    problem = make_problem(bench, ())
    fit = fit_stages(problem, np.zeros(problem.n_base), BASE_STAGES)
    for _ in range(REFINEMENTS):
        before = fit.cost
        bench = bench.refine(fit.base, ())
        fit = minimise(make_problem(bench, ()), fit.x)
        if abs(fit.cost - before) < SETTLED:
            break
    return bench, fit


def judge(
    bench: Bench,
    fits: Sequence[Fit],
    base: Fit,
    progress: Progress,
    hopes: Screening | None = None,
) -> tuple[Bench, list[Fit], Gate]:
    """Estimate the noise at the winner, refit the leaders there and judge.

    Noise, scatter and settling of the hits are known no better than the fit at which
    they were estimated, so they and the winner are brought to agree. Rivals are then
    fitted with the same noise; one that overtakes is judged in its turn. Where the
    winner fails, those that were held back are settled each by itself.
    """
    if not fits:
        return bench, [], gate(bench, base, base, None)
    ranked = list(fits)
    for _ in range(OVERTAKEN):
        found = _judged(bench, ranked, base, progress)
        if hopes is not None and not found.gate.passed:
            found = _own_settling(found, ranked, base, hopes, progress)
        bench = found.bench
        reach = CLOSE if found.gate.passed else CLOSE_FAILED
        close = score(bench, found.first) + reach
        ranked = [found.fit] + [
            finish(bench, make_problem(bench, f.candidates), f.x, progress)
            if score(bench, f) < close or _part_of(f, found.fit)
            else f
            for f in ranked
            if f is not found.first
        ]
        ranked.sort(key=lambda f: score(bench, f))
        if ranked[0] is found.fit:
            break
    return bench, ranked, gate(bench, ranked[0], base, found.left, ranked)


@dataclass(frozen=True, slots=True, eq=False)
class _Judged:
    """A fit before and after it was settled, its bench, directed tests and gate."""

    first: Fit
    fit: Fit
    bench: Bench
    left: Screening
    gate: Gate


def _judged(
    bench: Bench, ranked: Sequence[Fit], base: Fit, progress: Progress
) -> _Judged:
    """Settle the first of some fits and judge it."""
    bench, fit = _settled(bench, ranked[0], progress)
    left = screen(bench, fit, [*_others(bench, fit), *bench.probes])
    return _Judged(ranked[0], fit, bench, left, gate(bench, fit, base, left, ranked))


def _own_settling(
    failed: _Judged,
    ranked: Sequence[Fit],
    base: Fit,
    hopes: Screening,
    progress: Progress,
) -> _Judged:
    """Return the first of those held back that passes by itself, or what failed.

    What scatters cannot be told where a fit misses by more than noise.
    """
    if not failed.bench.expanded or failed.gate.excess > failed.gate.allowed:
        return failed
    for f in _held_back(failed, ranked, base, hopes):
        rest = [r for r in ranked if r is not f]
        found = _judged(failed.bench, [f, *rest], base, progress)
        if found.gate.passed:
            return found
    return failed


def _held_back(
    failed: _Judged, ranked: Sequence[Fit], base: Fit, hopes: Screening
) -> list[Fit]:
    """Return the fits of which their directed tests foretold more than was gained.

    An expansion about another fit holds back one that differs from it; it may even
    have lost the race.
    """
    gained = base.cost - failed.first.cost
    fits = {f.candidates[-1].label: f for f in ranked}
    held: dict[str, Fit] = {}
    for d in hopes.directions:
        label = d.candidate.label
        if d.drop > gained and not d.suggested and label not in held:
            held[label] = fits.get(label) or started(failed.bench, base, d)
    return [f for f in held.values() if f is not failed.first][:MOST_HELD_BACK]


def _part_of(fewer: Fit, more: Fit) -> bool:
    """Tell whether a fit is another one without some of its effects.

    What an effect is worth is read from such a fit, so its noise must be the same.
    """
    labels = {c.label for c in more.candidates}
    return {c.label for c in fewer.candidates} < labels


def _settled(bench: Bench, fit: Fit, progress: Progress) -> tuple[Bench, Fit]:
    """Bring a fit and the noise estimated at it to agree."""
    for _ in range(REJUDGED):
        before = fit.cost
        bench = bench.refine(fit.base, fit.terms)
        problem = make_problem(bench, fit.candidates)
        fit = finish(bench, problem, fit.x, progress)
        if abs(fit.cost - before) < AGREED:
            break
    return bench, fit


def take_back(bench: Bench, fits: Sequence[Fit], progress: Progress) -> list[Fit]:
    """Take effects of the best fit away that a later one has made needless."""
    best, found = fits[0], list(fits)
    for k in range(len(best.candidates)):
        kept = tuple(c for i, c in enumerate(best.candidates) if i != k)
        if not kept:
            continue
        coordinates = [t.coordinates for i, t in enumerate(best.terms) if i != k]
        start = np.concatenate([best.base, *coordinates])
        found.append(finish(bench, make_problem(bench, kept), start, progress))
    return _best_of_each(sorted(found, key=lambda f: score(bench, f)))


def _best_of_each(fits: Sequence[Fit]) -> list[Fit]:
    best: dict[frozenset[str], Fit] = {}
    for f in fits:
        best.setdefault(frozenset(c.label for c in f.candidates), f)
    return list(best.values())


def _others(bench: Bench, fit: Fit) -> list[Candidate]:
    return [c for c in bench.candidates if c not in fit.candidates]


def add_another(bench: Bench, fits: Sequence[Fit], progress: Progress) -> list[Fit]:
    """Try the best further effects on the best fits."""
    found: list[Fit] = []
    tried: set[frozenset[str]] = set()
    hopeful = [f for f in fits if f.cost < HOPEFUL * fits[0].cost]
    for first in hopeful:
        screening = screen(bench, first, _others(bench, first))
        chosen = [
            c
            for c in _seconds(bench, first, screening)
            if frozenset((*(x.label for x in first.candidates), c.label)) not in tried
        ]
        tried |= {
            frozenset((*(x.label for x in first.candidates), c.label)) for c in chosen
        }
        found += race(bench, first, screening, chosen, progress)
    return found


def _seconds(bench: Bench, first: Fit, screening: Screening) -> list[Candidate]:
    """Choose seconds by predicted drop, and those that only the priors see."""
    pulled = np.abs(first.pulls).max() > 3.5
    chosen: list[Candidate] = []
    for d in screening.directions:
        if d.candidate not in chosen and len(chosen) < SECONDS:
            chosen.append(d.candidate)
    for c in _others(bench, first):
        if pulled and c.effect.by_prior and c not in chosen:
            chosen.append(c)
    return chosen


def _worthwhile(bench: Bench, more: Fit, fewer: Fit) -> bool:
    gain = MIN_GAIN if len(more.candidates) > len(fewer.candidates) else 0.0
    return score(bench, more) + gain < score(bench, fewer)
