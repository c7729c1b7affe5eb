# SPDX-License-Identifier: MIT
"""Causes at a joint, one after the other, and the factor of each on its stiffness.

Bodies, bolts and waves act on a joint together, so that a joint of machines mostly
needs more than one effect of the contact bench.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.tail_probabilities import chi2_limit
from jointbench.analysis.gap.chain.chain_settings import CHAIN
from jointbench.analysis.gap.contact_bench.contact_bench import ContactBench
from jointbench.analysis.gap.contact_bench.contact_settings import CONTACT
from jointbench.analysis.gap.contact_bench.held_out_torques import (
    HeldOutTorques,
    hold_out_torques,
)
from jointbench.analysis.gap.diagnosis.loop import SearchOutcome
from jointbench.analysis.gap.judgement.naming import Acceptance
from jointbench.analysis.gap.law_diagnosis.contact_search import accept_contact
from jointbench.analysis.gap.model.effect import Candidate, Term
from jointbench.analysis.gap.residuals.evaluation_resolutions import FULL
from jointbench.analysis.gap.residuals.fit_records import Fit, split
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.search.descent import minimise
from jointbench.analysis.gap.search.screening import screen, start_grid
from jointbench.analysis.gap.search.selection_round import Progress, score


@dataclass(frozen=True, slots=True)
class Cause:
    """One effect and what it does to the stiffness.

    Attributes:
        name: of the effect.
        factor: stiffness with it over that without it, causes before it acting [-].
        low: 2.5 % point of it.
        high: 97.5 % point.
    """

    name: str
    factor: float
    low: float
    high: float


@dataclass(frozen=True, slots=True, eq=False)
class SeveralCauses:
    """Effects that together explain a joint.

    Attributes:
        bench: of the fit.
        fit: with all effects.
        acceptance: of that fit.
        causes: in the order in which they act.
        known: what is there whatever is missing: waves longer than what was
            measured, bolts; only what the base of the bench has.
        product: of the factors of causes and what is known.
        rest: factor of what the base took up: inputs of the law, assemblies.
        measured: stiffness over that of the law with nominal inputs [-].
        reference: index of the state at which the factors hold.
        held: each torque predicted from the others.
        rivals: other sets of effects that explain it equally well, in words.
    """

    bench: ContactBench
    fit: Fit
    acceptance: Acceptance
    causes: tuple[Cause, ...]
    known: tuple[Cause, ...]
    product: Cause
    rest: float
    measured: float
    reference: int
    held: HeldOutTorques
    rivals: tuple[tuple[str, ...], ...]


def add_causes(outcome: SearchOutcome, progress: Progress) -> SeveralCauses | None:
    """Add effects to those of a search until they explain the joint together.

    Args:
        outcome: of a search with one effect at a time.
        progress: receives one line for each set.

    Returns:
        The fewest effects that are accepted together; None if no set is, or if fewer
        of them explain the joint nearly as well.
    """
    bench = outcome.bench
    if not isinstance(bench, ContactBench):
        raise TypeError("the search must be one of the contact bench")
    base = outcome.base
    fits = list(outcome.ranked)
    if fits and explains_plainly(bench, fits[0]):
        return None
    for _ in range(1, CHAIN.most_causes):
        before = min((score(bench, f) for f in fits), default=np.inf)
        fits = _one_more(bench, fits[: CHAIN.pair_fits], progress)
        judged = [(f, _accepted(bench, f, base)) for f in fits[: CHAIN.pair_fits]]
        passed = [(f, o) for f, o in judged if o.passed and explains_plainly(bench, f)]
        if passed:
            if before - score(bench, passed[0][0]) < CHAIN.further_gain:
                return None
            limit = score(bench, passed[0][0]) + bench.policy.rival_score
            near = [f for f, _ in passed[1:] if score(bench, f) < limit]
            return _explained(bench, *passed[0], near)
    return None


def causes_of(
    bench: ContactBench, fit: Fit, acceptance: Acceptance, near: list[Fit]
) -> SeveralCauses:
    """Return the factors of the effects of a fit that was accepted.

    Args:
        bench: of the fit.
        fit: with one effect or several.
        acceptance: of the fit.
        near: fits that explain the joint equally well.
    """
    return _explained(bench, fit, acceptance, near)


def _one_more(bench: ContactBench, fits: list[Fit], progress: Progress) -> list[Fit]:
    """Return the fits with one effect more, best score first."""
    found: dict[frozenset[str], Fit] = {}
    for fit in fits:
        for candidate in bench.candidates:
            both = (*fit.candidates, candidate)
            key = frozenset(c.label for c in both)
            if candidate in fit.candidates or key in found:
                continue
            progress(" + ".join(sorted(key)))
            found[key] = _fitted(bench, fit, both)
    return sorted(found.values(), key=lambda f: score(bench, f))


def _fitted(bench: ContactBench, fit: Fit, both: tuple[Candidate, ...]) -> Fit:
    """Fit a set of effects from that of which it has one more."""
    problem = make_problem(bench, both)
    added, starts = both[-1], []
    for point in start_grid(added)[: CHAIN.pair_starts]:
        # An amplitude with a prior starts at its median.
        for amplitude in added.effect.parameters[0].far or (float(point[0]),):
            first = np.array(point, dtype=float)
            first[0] = amplitude
            starts.append(np.concatenate([fit.x, first]))
    tried = [
        minimise(problem, x, FULL, iterations=CONTACT.first_steps, exact_slopes=False)
        for x in starts
    ]
    best = min(tried, key=lambda f: f.cost)
    return minimise(problem, best.x, FULL, iterations=CONTACT.descent_steps)


def explains_plainly(bench: ContactBench, fit: Fit) -> bool:
    """Return whether the cost of a fit is within noise and priors alone.

    A single effect may leave a share of what the base leaves, because its formula is
    not the physics; where that share is large, a second effect may explain it.

    Args:
        bench: of the fit.
        fit: with or without effects.
    """
    return fit.cost <= chi2_limit(CONTACT.fit_chance, max(bench.blocks.dof, 1))


def _accepted(bench: ContactBench, fit: Fit, base: Fit) -> Acceptance:
    tested = [*bench.candidates, *bench.probes]
    left = screen(bench, fit, [c for c in tested if c not in fit.candidates])
    return accept_contact(bench, fit, base, left)


def _explained(
    bench: ContactBench, fit: Fit, acceptance: Acceptance, near: list[Fit]
) -> SeveralCauses:
    order = np.argsort([bench.entries[c.label].place for c in fit.candidates])
    states = bench.data.states
    rising = np.flatnonzero(~states.falling)
    log_p = bench.nominal.log_preload
    reference = int(rising[np.argsort(log_p[rising])[rising.size // 2]])
    draws = _draws(fit)
    factors = np.array([_factors(bench, fit, x, order, reference) for x in draws])
    names = [fit.candidates[k].effect.name for k in order]
    factors = np.column_stack([factors, np.prod(factors, axis=1)])
    low, high = np.quantile(factors[1:], [0.025, 0.975], axis=0)
    *found, product = (
        Cause(name, float(f), float(a), float(b))
        for name, f, a, b in zip(
            [*_before(bench), *names, *_after(bench), "product"],
            factors[0],
            low,
            high,
            strict=True,
        )
    )
    alone = _alone(bench, np.zeros(fit.n_base))
    nominal = _stiffness(bench, alone, fit, (), reference)
    base = _stiffness(bench, _alone(bench, fit.base), fit, (), reference)
    rows = bench.data.rows
    own = np.flatnonzero(rows.state == reference)[0]
    return SeveralCauses(
        bench,
        fit,
        acceptance,
        tuple(one for one in found if one.name in names),
        tuple(one for one in found if one.name not in names),
        product,
        base / nominal,
        float(np.exp(rows.value[own])) / nominal,
        reference,
        hold_out_torques(bench, fit),
        tuple(tuple(sorted(c.effect.name for c in f.candidates)) for f in near),
    )


def _draws(fit: Fit) -> FloatArray:
    """Return the fit and draws of its posterior, shape (1 + n_draws, n)."""
    random = np.random.default_rng(CHAIN.seed)
    value, vector = np.linalg.eigh(fit.covariance)
    root = vector * np.sqrt(np.maximum(value, 0.0))
    drawn = fit.x + random.standard_normal((CHAIN.draws, value.size)) @ root.T
    bounds = [p.bounds for c in fit.candidates for p in c.effect.parameters]
    if bounds:
        low, high = np.array(bounds).T
        drawn[:, fit.n_base :] = np.clip(drawn[:, fit.n_base :], low, high)
    return np.vstack([fit.x, drawn])


def _factors(
    bench: ContactBench, fit: Fit, x: FloatArray, order: IntArray, state: int
) -> list[float]:
    """Return the factors of what is known, effects between them, as they act."""
    base = _alone(bench, x[: fit.n_base])
    terms = split(x, fit.n_base, fit.candidates)
    kept: tuple[int, ...] = ()
    at = [_stiffness(bench, base, fit, kept, state, terms)]
    for one in _before(bench).values():
        base[one] = x[one]
        at.append(_stiffness(bench, base, fit, kept, state, terms))
    for effect in order:
        kept = (*kept, int(effect))
        at.append(_stiffness(bench, base, fit, kept, state, terms))
    for one in _after(bench).values():
        base[one] = x[one]
        at.append(_stiffness(bench, base, fit, kept, state, terms))
    return [later / earlier for earlier, later in pairwise(at)]


def _before(bench: ContactBench) -> dict[str, int]:
    """Return what is known to act on the contact, with its coordinate."""
    at = bench.layout.waves
    return {"unmeasured_waves": at} if at >= 0 else {}


def _after(bench: ContactBench) -> dict[str, int]:
    """Return what is known to act in parallel, with its coordinate."""
    at = bench.layout.bolts
    return {"bolts": at} if at >= 0 else {}


def _alone(bench: ContactBench, base: FloatArray) -> FloatArray:
    """Return base coordinates of the contact law alone."""
    found = base.copy()
    found[[*_before(bench).values(), *_after(bench).values()]] = -np.inf
    return found


def _stiffness(
    bench: ContactBench,
    base: FloatArray,
    fit: Fit,
    kept: tuple[int, ...],
    state: int,
    terms: tuple[Term, ...] = (),
) -> float:
    """Return the stiffness of the first quantity of a state with some effects."""
    chosen = [fit.terms[k] if not terms else terms[k] for k in kept]
    row = int(bench.data.rows.quantity.min())
    return float(bench.joint(base, chosen).table[row, state])
