# SPDX-License-Identifier: MIT
"""When a fit is a name: rules that a smaller gap alone does not meet."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.analysis.gap.bench import Bench
from jointbench.analysis.gap.fit import Fit
from jointbench.analysis.gap.race import score
from jointbench.analysis.gap.screening import Screening

RIVAL_WITHIN = 15.0
"""Score within which a rival is not told apart."""
CROWDED_WITHIN = 60.0
"""The same where one site bears two effects: two laws together bend as many do."""
TWIN_WITHIN = 0.5
"""Score within which the same fault at one channel and at all is one statement."""
EVERYWHERE = "all"
AMPLITUDE_SD = 4.0
PULL_LIMIT = 4.0
GLOBAL_SD = 4.5
RECORDS_SD = 4.5
NOISE_SHARE = 0.2
"""Share of the spectrum from which the noise is estimated."""
WIDENED = 1.3
"""Room over the linearised null quantile, for the shapes between the grid's points."""
MODEL_ERROR = 2e-5
"""Share of the base's excess chi2 that a right nonlinear law may leave: kinks between
steps, the anti-alias filter."""
BENT = {"stiffness", "contact"}
"""Families of nonlinear laws without memory."""
FRICTION_ERROR = 1e-4
"""The same for sliders, whose distribution is never that of the model."""
EXACT_ERROR = 1e-6
"""The same for effects that are linear or act on a channel: they are exact, and would
otherwise hide a second effect behind a great first one."""


@dataclass(frozen=True, slots=True)
class Gate:
    """Whether a fit explains the measurement.

    Attributes:
        passed: all rules met.
        reason: the first rule that was not, or empty.
        excess: chi2/dof - 1 [-].
        allowed: what noise and model error allow of it [-].
        remaining: largest directed drop that is left.
    """

    passed: bool
    reason: str
    excess: float
    allowed: float
    remaining: float


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
    share = _model_error(fit)
    dof = bench.blocks.dof
    excess = fit.chi2 / dof - 1.0
    base_excess = max(base.chi2 / dof - 1.0, 0.0)
    allowed = GLOBAL_SD * noise_sd(bench) + share * base_excess
    remaining, limit = 0.0, np.inf
    if left is not None and bench.blocks.white:
        remaining, limit = _worst(fit, left, base_excess * dof)
    reason = ""
    if excess > allowed:
        reason = f"chi2/dof is {1 + excess:.4f}, noise allows {1 + allowed:.4f}"
    elif remaining > limit:
        reason = f"a further effect would take {remaining:.0f} units of chi2"
    elif (odd := _unlike_records(bench, fit)) > RECORDS_SD + share * base_excess * dof:
        reason = f"records want parameters of their own ({odd:.1f} sd beyond noise)"
    elif np.abs(fit.pulls).max() > PULL_LIMIT:
        reason = f"the base is pulled {np.abs(fit.pulls).max():.1f} sigma off its sheet"
    elif fit.candidates and weakest(fit, (base, *others)) < AMPLITUDE_SD:
        sure = weakest(fit, (base, *others))
        reason = f"an effect is only {sure:.1f} sigma from off"
    return Gate(not reason, reason, excess, allowed, remaining)


def _model_error(fit: Fit) -> float:
    families = {c.effect.family for c in fit.candidates}
    if "friction" in families:
        return FRICTION_ERROR
    return MODEL_ERROR if families & BENT else EXACT_ERROR


def _worst(fit: Fit, left: Screening, base_excess: float) -> tuple[float, float]:
    """Return the directed drop that exceeds its limit most, and that limit.

    What a law of friction leaves looks like other laws of the same link: its sliders
    are not those of the joint. Anywhere else nothing of it should be seen.
    """
    rubbed = {c.site for c in fit.candidates if c.effect.family == "friction"}
    elsewhere = min(_model_error(fit), MODEL_ERROR)
    worst, at = (0.0, WIDENED * left.threshold), -np.inf
    for d in left.directions:
        if d.suggested:
            continue
        share = FRICTION_ERROR if d.candidate.site in rubbed else elsewhere
        limit = WIDENED * left.threshold + share * base_excess
        if d.drop - limit > at:
            worst, at = (d.drop, limit), d.drop - limit
    return worst


def _unlike_records(bench: Bench, fit: Fit) -> float:
    """Return how much better every record could be fitted by itself, in sd of noise.

    A law that imitates the true one leaves misfits that no effect of the catalogue
    takes, but that differ from level to level: parameters that fit all records are
    not the best of any.
    """
    if not bench.blocks.white or not fit.candidates:
        return 0.0
    size = np.maximum(np.linalg.norm(fit.jacobian, axis=0), 1e-300)
    taken, free = 0.0, -fit.x.size
    for group in np.unique(bench.blocks.group):
        rows = bench.blocks.group == group
        u, s, _ = np.linalg.svd(fit.jacobian[rows] / size, full_matrices=False)
        u = u[:, s > 1e-6 * s[0]]
        taken += float(np.sum((u.T @ fit.residual[rows]) ** 2))
        free += u.shape[1]
    return (taken - free) / float(np.sqrt(2.0 * max(free, 1)))


def noise_sd(bench: Bench) -> float:
    """Return the sd of chi2/dof under noise, that of the noise estimate included.

    The noise is estimated from a share of the same samples, so that what both hold
    cancels.
    """
    return float(np.sqrt(2.0 / bench.blocks.dof * (1.0 / NOISE_SHARE - 1.0)))


def weakest(fit: Fit, others: Sequence[Fit]) -> float:
    """Return how many sd the weakest effect of a fit is from being off.

    By the rise of the cost where a fit without it is at hand, else by its amplitude:
    the amplitude of a weak law of friction is loose although the law is needed.
    """
    own, sure = _labels(fit), []
    for candidate in fit.candidates:
        rest = own - {candidate.label}
        without = [f.cost for f in others if _labels(f) == rest]
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


def rivals(bench: Bench, fits: Sequence[Fit]) -> list[Fit]:
    """Return the fits that the best one is not told apart from, it included.

    An explanation that holds the best one and more is no rival of it: what it adds
    did not earn its charge.
    """
    if not fits:
        return []
    best, own = score(bench, fits[0]), _labels(fits[0])
    sites = [c.site for c in fits[0].candidates]
    near = RIVAL_WITHIN if len(set(sites)) == len(sites) else CROWDED_WITHIN
    return [
        f
        for f in fits
        if score(bench, f) < best + near and (f is fits[0] or not own < _labels(f))
    ]


def _labels(fit: Fit) -> set[str]:
    return {c.label for c in fit.candidates}


def without_twins(bench: Bench, fits: Sequence[Fit]) -> list[Fit]:
    """Drop fits that say the same as a fault of all channels alike.

    A range of the converter that only one channel reaches is the range of all.
    """
    common = [
        f
        for f in fits
        if len(f.candidates) == 1 and f.candidates[0].site.name == EVERYWHERE
    ]
    return [
        f
        for f in fits
        if not any(
            f is not c
            and len(f.candidates) == 1
            and f.candidates[0].effect.name == c.candidates[0].effect.name
            and abs(score(bench, f) - score(bench, c)) < TWIN_WITHIN
            for c in common
        )
    ]
