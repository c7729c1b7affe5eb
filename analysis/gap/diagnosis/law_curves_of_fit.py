# SPDX-License-Identifier: MIT
"""Draw the force laws of a fit as curves, with bands from the covariance of the fit."""

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.analysis.gap.diagnosis.diagnosis_settings import DIAGNOSIS
from jointbench.analysis.gap.judgement.stated_covariance import stated_covariance
from jointbench.analysis.gap.model.effect import Term
from jointbench.analysis.gap.model.law_curves import LawCurves
from jointbench.analysis.gap.residuals.fit_records import Fit, split
from jointbench.analysis.gap.residuals.joint_fit import make_problem
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.analysis.gap.response.dynamic_stiffness import Action
from jointbench.analysis.gap.response.effect_hooks import HitConditions
from jointbench.analysis.gap.response.law_loops import Loops, harmonic_loops
from jointbench.analysis.gap.response.link_modes import link_modes
from jointbench.analysis.gap.response.predict_records import motion, undamped

# Poles with less imaginary part relative to their size are real, by rounding apart: a
# Maxwell element has one.
_REAL = 1e-9

_Drawn = tuple[FloatArray, FloatArray, FloatArray]
"""Force of the loops, frequencies and damping ratios of one draw."""


def law_curves(bench: LumpedBench, fit: Fit) -> tuple[LawCurves, ...]:
    """Return the curves of every force law of a fit; none for linear effects.

    Args:
        bench: measurement and model.
        fit: the explanation.
    """
    actions = bench.actions(fit.terms)
    bent = [k for k, a in enumerate(actions) if a.entry.law is not None]
    if not bent:
        return ()
    draws = fit_draws(bench, fit)
    return tuple(_curves(bench, fit, k, draws) for k in bent)


def fit_draws(bench: LumpedBench, fit: Fit) -> list[FloatArray]:
    """Return coordinates drawn from the covariance of the fit, within their bounds."""
    problem = make_problem(bench, fit.candidates)
    values, vectors = np.linalg.eigh(stated_covariance(fit, bench.blocks))
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    rng = np.random.default_rng(0)
    normal = rng.standard_normal((DIAGNOSIS.curve_draws, values.size))
    normal -= normal.mean(axis=0)
    return [np.clip(fit.x + root @ z, problem.lower, problem.upper) for z in normal]


def _curves(
    bench: LumpedBench, fit: Fit, index: int, draws: list[FloatArray]
) -> LawCurves:
    """Return the curves of the law of that index."""
    largest = _largest_motion(bench, fit, index)
    count = DIAGNOSIS.curve_amplitudes
    amplitude = largest * np.geomspace(DIAGNOSIS.least_amplitude, 1.0, count)
    loops, own = _drawn(bench, fit.base, fit.terms, index, amplitude)
    others = []
    for x in draws:
        terms = split(x, fit.n_base, fit.candidates)
        drawn = _drawn(bench, x[: fit.n_base], terms, index, amplitude)[1]
        others.append((drawn[0], _rows(drawn[1], own[1]), _rows(drawn[2], own[2])))
    sd = [np.std([drawn[k] for drawn in others], axis=0, ddof=1) for k in range(3)]
    shown = slice(None, None, -DIAGNOSIS.curve_every)
    return LawCurves(
        label=fit.candidates[index].label,
        source=fit.candidates[index].effect.source,
        motion=loops.motion[shown],
        force=own[0][shown],
        force_sd=sd[0][shown],
        amplitude=amplitude,
        frequency=own[1],
        frequency_sd=sd[1],
        damping=own[2],
        damping_sd=sd[2],
    )


def _rows(drawn: FloatArray, own: FloatArray) -> FloatArray:
    """Return the modes of a draw, as many as the fit has; NaN where one is missing."""
    found = np.full_like(own, np.nan)
    count = min(drawn.shape[0], own.shape[0])
    found[:count] = drawn[:count]
    return found


def _largest_motion(bench: LumpedBench, fit: Fit, index: int) -> float:
    """Return the largest motion across the link of a law in all records [m]."""
    actions, model = bench.actions(fit.terms), bench.campaign.model
    theta = bench.theta(fit.base)
    x = motion(model, theta, bench.excitation, actions, oversampling=2)
    first, second = model.ends(actions[index].index)
    r = x[second] - (x[first] if first >= 0 else 0.0)
    return float(np.abs(undamped(r, bench.excitation)).max())


def _drawn(
    bench: LumpedBench,
    base: FloatArray,
    terms: tuple[Term, ...],
    index: int,
    amplitude: FloatArray,
) -> tuple[Loops, _Drawn]:
    """Return the loops of a law, with frequencies and damping of the modes."""
    actions, theta = bench.actions(terms), bench.theta(base)
    action = actions[index]
    if action.entry.law is None:
        raise ValueError(f"{action.entry.name} has no law")
    law = action.entry.law(action.values)
    linear = _modes(bench, theta, actions, action.index)
    frequency = np.empty((linear.size, amplitude.size))
    damping = np.empty_like(frequency)
    for m, pole in enumerate(linear):
        loops = harmonic_loops(law, amplitude, float(abs(pole)))
        for k in range(amplitude.size):
            moved = theta.copy()
            at = len(bench.campaign.model.bodies) + action.index
            moved[at] += loops.stiffness[k]
            moved[at + len(bench.campaign.model.links)] += loops.damping[k]
            poles = _modes(bench, moved, actions, action.index)
            # Python's abs of a complex NaN may raise for an error of an earlier call.
            found = poles[m] if m < poles.size else np.complex128(np.nan)
            frequency[m, k] = abs(found) / (2.0 * np.pi)
            damping[m, k] = -found.real / abs(found)
    loops = harmonic_loops(law, amplitude, float(abs(linear[0])))
    return loops, (np.array(loops.force), frequency, damping)


def _modes(
    bench: LumpedBench, theta: FloatArray, actions: list[Action], link: int
) -> ComplexArray:
    """Return the upper poles at the reference preload, ascending, shape (n_modes,)."""
    conditions = HitConditions(np.ones(1), np.zeros(1))
    modes = link_modes(bench.campaign.model, theta, conditions, [link], actions)
    upper = modes.poles[modes.poles.imag > _REAL * np.abs(modes.poles)]
    return np.asarray(upper[np.argsort(np.abs(upper))])
