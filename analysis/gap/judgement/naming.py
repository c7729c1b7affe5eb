# SPDX-License-Identifier: MIT
"""When a fit is a name: rules that a smaller gap alone does not meet."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.analysis.gap.judgement.own_parameters import most_unlike
from jointbench.analysis.gap.model.effect import PROBE_FAMILY, labels_of
from jointbench.analysis.gap.residuals.bench_protocol import Bench
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.search.screening import Direction, Screening
from jointbench.analysis.gap.search.selection_round import score

_RIVAL_WITHIN = 15.0
"""Score within which a rival is not told apart."""
CROWDED_WITHIN = 60.0
"""The same where one site bears two effects: two laws together bend as many do."""
_TWIN_WITHIN = 0.5
"""Score within which the same fault at one channel and at all is one statement."""
_EVERYWHERE = "all"
AMPLITUDE_SD = 4.0
PULL_LIMIT = 4.0
GLOBAL_SD = 4.5
UNLIKE_CHANCE = 3e-4
"""Chance below which parts of the records want parameters of their own."""
UNLIKE_BASE_CHANCE = 3e-5
"""The same before anything is named: a base that is complete must stay so."""
_NOISE_SHARE = 0.2
"""Share of the samples that the noise estimate is worth: 0.39 of the spectrum, halved
by the taper."""
_WIDENED = 1.3
"""Room over the linearised null quantile, for the shapes between the grid's points."""
MODEL_ERROR = {
    "iwan": 5e-5,
    "coulomb": 1e-5,
    "friction": 1e-6,
    "stiffness": 1e-7,
    "contact": 1e-6,
    "damping": 1e-6,
    "converter": 5e-6,
}
"""Share of the base's excess chi2 that a right law may leave, by its name or family:
an Iwan element has as many sliders as its maker gave it, a stop closes between steps,
a smooth law is as exact as its march, and linear damping has the share of its family;
scatter carries samples over the edge of a clip,
which its slope does not tell."""
EXACT = 1e-9
"""The same for what is linear or acts on a channel: it is as exact as the base, and
any more would hide a second effect behind a great first one."""
_ELSEWHERE = 2e-5
"""The most that a law may leave of its error at other places than its own."""
_AT_THE_END = 1e-3
"""Share of its range within which a parameter counts as standing at its end."""
_LOOSE = 0.3
"""Sd over the range beyond which a parameter stands nowhere in particular."""


@dataclass(frozen=True, slots=True, eq=False)
class Gate:
    """Whether a fit explains the measurement.

    Attributes:
        passed: all rules met.
        reason: the first rule that was not, or empty.
        excess: chi2/dof - 1 [-].
        allowed: what noise and model error allow of it [-].
        remaining: drop of the directed test that comes closest to its limit, or
            exceeds it most; None where there is none.
        remaining_allowed: limit of that test; 0 where there is none.
        unexplained: records or sheet hold more than the fit explains, so that a
            further effect may help.
        left: directed tests of what the fit leaves, None where there are none.
    """

    passed: bool
    reason: str
    excess: float
    allowed: float
    remaining: float | None
    remaining_allowed: float
    unexplained: bool
    left: Screening | None


def gate(
    bench: Bench,
    fit: Fit,
    base: Fit,
    left: Screening | None,
    others: Sequence[Fit] = (),
) -> Gate:
    """Judge a fit.

    Args:
        bench: with the noise re-estimated at the fit.
        fit: of that bench.
        base: fit without effects, of the bench as it was.
        left: directed tests of the fit; None to pass them over.
        others: what else was fitted, for what the fit would be without an effect.
    """
    dof = bench.blocks.dof
    excess = fit.chi2 / dof - 1.0
    model = forgiven(fit, (base, *others), dof)
    allowed = GLOBAL_SD * noise_sd(bench) + model / dof
    worst, beyond = None, -np.inf
    if left is not None and bench.blocks.white:
        elsewhere = min(model, _ELSEWHERE * max(base.chi2 - dof, 0.0))
        worst, beyond = _worst(fit, left, model, elsewhere)
    reason = ""
    if excess > allowed:
        reason = f"chi2/dof is {1 + excess:.4f}, noise allows {1 + allowed:.4f}"
    elif worst and beyond > 0.0:
        reason = _looks_like(worst)
    elif unlike := _unlike(bench, fit, model):
        reason = unlike
    elif np.abs(fit.pulls).max() > PULL_LIMIT:
        reason = f"the base is pulled {np.abs(fit.pulls).max():.1f} sigma off its sheet"
    unexplained = bool(reason)
    reason = reason or _doubt(fit, (base, *others))
    return Gate(
        passed=not reason,
        reason=reason,
        excess=excess,
        allowed=allowed,
        remaining=worst.drop if worst else None,
        remaining_allowed=worst.drop - beyond if worst else 0.0,
        unexplained=unexplained,
        left=left,
    )


def _doubt(fit: Fit, others: Sequence[Fit]) -> str:
    """Say why a fit that explains everything is no name yet, if so."""
    if fit.candidates and (sure := weakest(fit, others)) < AMPLITUDE_SD:
        return f"an effect is only {sure:.1f} sigma from off"
    return at_the_end(fit)


def forgiven(fit: Fit, others: Sequence[Fit], dof: int) -> float:
    """Return the chi2 that a right fit may leave: of each effect a share of its own.

    An effect is no textbook law, so a share of what it explains may be left; of what
    another one explains, nothing. Else a second effect of a loose law would excuse
    whatever the first one leaves.

    Args:
        fit: of any effects.
        others: the base, and what else was fitted; where the fit without an effect is
            not among them, the base stands for it.
        dof: degrees of freedom.
    """
    own, allowed = labels_of(fit.candidates), 0.0
    for candidate in fit.candidates:
        effect = candidate.effect
        share = MODEL_ERROR.get(effect.name, MODEL_ERROR.get(effect.family, EXACT))
        rest = own - {candidate.label}
        without = [f.chi2 for f in others if labels_of(f.candidates) == rest]
        left = min(without, default=others[0].chi2) - dof
        allowed = max(allowed, share * left)
    return allowed


def _looks_like(left: Direction) -> str:
    """Say what a fit leaves, by the directed test that sees most of it."""
    if left.candidate.effect.family != PROBE_FAMILY:
        return f"a further effect would take {left.drop:.0f} units of chi2"
    kind = left.candidate.effect.name
    return (
        f"{left.drop:.0f} units of chi2 are left that look like: {kind}, "
        f"{left.candidate.site}"
    )


def _worst(
    fit: Fit, left: Screening, here: float, elsewhere: float
) -> tuple[Direction | None, float]:
    """Return the directed test that exceeds its limit most, and by how much.

    What a law leaves looks like other laws of the same site: its sliders are not
    those of the joint. Anywhere else less of it should be seen.
    """
    own = {c.site for c in fit.candidates}
    worst, beyond = None, -np.inf
    for d in left.directions:
        if d.suggested:
            continue
        model = here if d.candidate.site in own else elsewhere
        limit = _WIDENED * left.threshold + model
        if d.drop - limit > beyond:
            worst, beyond = d, d.drop - limit
    return worst, beyond


def _unlike(bench: Bench, fit: Fit, allowed: float) -> str:
    """Say which parts of the records the fit does not hold for alike, if any."""
    if not bench.blocks.white:
        return ""
    worst = most_unlike(bench, fit, allowed)
    if worst.chance > (UNLIKE_CHANCE if fit.candidates else UNLIKE_BASE_CHANCE):
        return ""
    return f"{worst.excess:.0f} units of chi2 are left by {worst.view}"


def at_the_end(fit: Fit) -> str:
    """Say which shape of a law is driven to the end of its range, if any is.

    Such a law is stretched over another one: a Bouc-Wen element of a very sharp corner
    is a Jenkins slider.
    """
    sd, at = np.sqrt(np.maximum(np.diag(fit.covariance), 0.0)), fit.n_base
    for term in fit.terms:
        for k, p in enumerate(term.candidate.effect.parameters):
            low, high = p.bounds
            span, u = high - low, term.coordinates[k]
            if k and sd[at + k] < _LOOSE * span and np.isfinite(span):
                if min(u - low, high - u) < _AT_THE_END * span:
                    return f"{p.name} of {term.candidate.label} is at its limit"
        at += len(term.coordinates)
    return ""


def noise_sd(bench: Bench) -> float:
    """Return the sd of chi2/dof under noise, that of the noise estimate included.

    The noise is estimated from a share of the same samples, so that what both hold
    cancels.
    """
    return float(np.sqrt(2.0 / bench.blocks.dof * (1.0 / _NOISE_SHARE - 1.0)))


def weakest(fit: Fit, others: Sequence[Fit]) -> float:
    """Return how many sd the weakest effect of a fit is from being off.

    By the rise of the cost where a fit without it is at hand, else by its amplitude:
    the amplitude of a weak law of friction is loose although the law is needed.
    """
    own, sure = labels_of(fit.candidates), []
    for candidate in fit.candidates:
        rest = own - {candidate.label}
        without = [f.cost for f in others if labels_of(f.candidates) == rest]
        if not without:
            return weakest_amplitude(fit)
        sure.append(np.sqrt(max(min(without) - fit.cost, 0.0)))
    return float(min(sure, default=np.inf))


def weakest_amplitude(fit: Fit) -> float:
    """Return the smallest distance of an amplitude from OFF, in sd."""
    sd = np.sqrt(np.maximum(np.diag(fit.covariance), 1e-300))
    at, worst = fit.n_base, np.inf
    for candidate in fit.candidates:
        first = candidate.effect.parameters[0]
        if first.upper - first.lower > 1e-3:
            worst = min(worst, abs(fit.x[at]) / sd[at])
        at += len(candidate.effect.parameters)
    return float(worst)


def rival_within(best: Fit) -> float:
    """Return the score behind the best within which a rival is not told apart."""
    sites = [c.site for c in best.candidates]
    return _RIVAL_WITHIN if len(set(sites)) == len(sites) else CROWDED_WITHIN


def rivals(bench: Bench, fits: Sequence[Fit]) -> list[Fit]:
    """Return the fits that the best one is not told apart from, it included.

    An explanation that holds the best one and more is no rival of it: what it adds
    did not earn its charge.
    """
    if not fits:
        return []
    best, own = score(bench, fits[0]), labels_of(fits[0].candidates)
    near = rival_within(fits[0])
    return [
        f
        for f in fits
        if score(bench, f) < best + near
        and (f is fits[0] or not own < labels_of(f.candidates))
    ]


def without_twins(bench: Bench, fits: Sequence[Fit]) -> list[Fit]:
    """Drop fits that say the same as a fault of all channels alike.

    A range of the converter that only one channel reaches is the range of all.
    """
    return [
        f
        for f in fits
        if not any(
            _twin_of(f, c) and abs(score(bench, f) - score(bench, c)) < _TWIN_WITHIN
            for c in fits
        )
    ]


def _twin_of(fit: Fit, common: Fit) -> bool:
    """Tell whether a fit is another one with a fault of all at one channel only."""
    own = [c for c in fit.candidates if c not in common.candidates]
    other = [c for c in common.candidates if c not in fit.candidates]
    if len(own) != 1 or len(other) != 1 or other[0].site.name != _EVERYWHERE:
        return False
    return own[0].effect.name == other[0].effect.name
