# SPDX-License-Identifier: MIT
"""Curves of modes over amplitude as evidence for or against explanations.

The curves come from the decays after the hits and know neither forces nor laws. They
are compared with those that each explanation predicts; the verdict is not changed.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.diagnosis.diagnosis_settings import DIAGNOSIS
from jointbench.analysis.gap.diagnosis.predicted_modes import (
    MeasuredPlace,
    base_frequencies,
    predicted_curve,
)
from jointbench.analysis.gap.model.curve_records import (
    CurveEvidence,
    CurveMatch,
    ModeEvidence,
    PredictedCurve,
)
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.lumped_bench import LumpedBench
from jointbench.signal.amplitude.amplitude_curve import (
    AmplitudeCurve,
    AmplitudeMode,
    Dependence,
)

CONSISTENT, INCONSISTENT, OPEN = "consistent", "inconsistent", "not decided"
NO_LAW = "none"


@dataclass(frozen=True, slots=True)
class MeasuredCurves:
    """Modes over amplitude, as measured.

    Attributes:
        modes: of the hits at the reference preload; empty where there are none.
        reason: why there are none; empty otherwise.
        hits: number of hits.
    """

    modes: tuple[AmplitudeMode, ...] = ()
    reason: str = ""
    hits: int = 0


def amplitude_evidence(
    bench: LumpedBench, base: Fit, shown: Sequence[Fit], measured: MeasuredCurves
) -> CurveEvidence:
    """Compare measured curves with those that explanations predict.

    Args:
        bench: measurement and model.
        base: fit without effects.
        shown: explanations of the verdict, best first; none for the base alone.
        measured: modes over amplitude.

    Returns:
        One line for each mode of the model, with the curves.
    """
    if not measured.modes:
        words = (f"curves cannot be determined: {measured.reason}",)
        return CurveEvidence((), words, measured.hits)
    modes = tuple(
        _mode(bench, (*shown, base), number, float(frequency), measured.modes)
        for number, frequency in enumerate(base_frequencies(bench, base), 1)
    )
    return CurveEvidence(modes, tuple(mode.words for mode in modes), measured.hits)


def _mode(
    bench: LumpedBench,
    fits: Sequence[Fit],
    number: int,
    frequency: float,
    found: Sequence[AmplitudeMode],
) -> ModeEvidence:
    """Return the evidence of one mode of the model; the last fit is the base."""
    name = f"mode {number} ({frequency:.4g} Hz)"
    near = min(found, key=lambda mode: abs(mode.soft.frequency - frequency))
    if abs(near.soft.frequency - frequency) > DIAGNOSIS.curve_near * frequency:
        words = f"{name}: no measured mode within {DIAGNOSIS.curve_near:.0%}"
        return ModeEvidence(number, frequency, None, (), words)
    curve = near.curve
    body = None if curve is None else _body(bench, curve)
    if curve is None or body is None:
        words = f"{name} {_without_curve(near)}"
        return ModeEvidence(number, frequency, near, (), words)
    place = MeasuredPlace(number - 1, body, curve.amplitude)
    *laws, flat = (_match(bench, fit, place, curve) for fit in fits)
    matches = (*laws, replace(flat, words=_base_outcome(flat, laws)))
    if near.dependence is Dependence.NOT_DECIDED:
        matches = tuple(replace(match, words=OPEN) for match in matches)
    words = f"{name} {_change_words(near, curve, matches)}"
    return ModeEvidence(number, frequency, near, matches, words)


def _without_curve(mode: AmplitudeMode) -> str:
    """Return why a mode has no curve."""
    if mode.dependence is Dependence.NONE:
        return f"does not depend on amplitude: {mode.reason}"
    return f"has no curve, it cannot be determined: {mode.reason}"


def _body(bench: LumpedBench, curve: AmplitudeCurve) -> int | None:
    """Return the body of the channel that a curve was measured with."""
    model = bench.campaign.model
    name = curve.channel.partition("@")[0]
    for channel in model.channels:
        if channel.name == name:
            return model.index(channel.body)
    return None


def _match(
    bench: LumpedBench, fit: Fit, place: MeasuredPlace, curve: AmplitudeCurve
) -> CurveMatch:
    """Return one explanation against a curve; the base is judged by `_base_outcome`."""
    predicted = predicted_curve(bench, fit, place)
    chi2, scale, scale_sd = _deviation(curve, predicted)
    labels = tuple(c.label for c in fit.candidates) or (NO_LAW,)
    change = float(predicted.frequency[-1] / predicted.frequency[0] - 1.0)
    words = _outcome(chi2, scale, scale_sd)
    return CurveMatch(labels, predicted, change, chi2, scale, scale_sd, words)


def _outcome(chi2: float, scale: float, scale_sd: float) -> str:
    """Return whether a predicted change is the measured one."""
    if not scale_sd <= DIAGNOSIS.curve_known:
        return OPEN
    away = abs(scale - 1.0) / np.hypot(scale_sd, DIAGNOSIS.curve_harmonic_error)
    if max(away, np.sqrt(chi2)) > DIAGNOSIS.curve_inconsistent:
        return INCONSISTENT
    good = max(away, np.sqrt(chi2)) <= DIAGNOSIS.curve_consistent
    return CONSISTENT if good else OPEN


def _base_outcome(base: CurveMatch, laws: Sequence[CurveMatch]) -> str:
    """Return whether no change at all is consistent with the measured curve.

    A change along one that a law predicts shows sooner than in chi2.
    """
    away = max((m.scale / m.scale_sd for m in laws if m.scale_sd > 0), default=0.0)
    away = max(away, float(np.sqrt(base.chi2_per_dof)))
    if away > DIAGNOSIS.curve_inconsistent:
        return INCONSISTENT
    return CONSISTENT if away <= DIAGNOSIS.curve_consistent else OPEN


def _deviation(
    curve: AmplitudeCurve, predicted: PredictedCurve
) -> tuple[float, float, float]:
    """Return chi2 per dof of the changes, and measured over predicted change with sd.

    A constant difference of frequency or damping is free: it belongs to the base.
    """
    log = np.log(curve.amplitude)
    count = max(3, round(float(log[-1] - log[0]) / DIAGNOSIS.curve_spacing) + 1)
    at = np.linspace(log[0], log[-1], count)

    def sampled(values: FloatArray) -> FloatArray:
        return np.asarray(np.interp(at, log, values))

    rows = (
        (
            *(curve.frequency, curve.frequency_sd),
            *(predicted.frequency, predicted.frequency_sd),
        ),
        (
            *(curve.damping_ratio, curve.damping_sd),
            *(predicted.damping, predicted.damping_sd),
        ),
    )
    total = along = size = 0.0
    for own, own_sd, other, other_sd in rows:
        weight = 1.0 / (sampled(own_sd) ** 2 + sampled(other_sd) ** 2)
        measured, wanted = (
            sampled(values) - weight @ sampled(values) / weight.sum()
            for values in (own, other)
        )
        total += float(weight @ (measured - wanted) ** 2)
        along += float(weight @ (measured * wanted))
        size += float(weight @ wanted**2)
    chi2 = total / (2 * (count - 1))
    if size <= np.finfo(float).eps:
        return chi2, np.nan, np.nan
    return chi2, along / size, 1.0 / np.sqrt(size)


def _change_words(
    mode: AmplitudeMode, curve: AmplitudeCurve, matches: Sequence[CurveMatch]
) -> str:
    """Return the change, and what each explanation predicts."""
    change = float(curve.frequency[-1] / curve.frequency[0] - 1.0)
    first, last = 100.0 * curve.damping_ratio[[0, -1]]
    motion = matches[0].curve.motion
    low, high = (1e6 * motion if motion.size else curve.amplitude)[[0, -1]]
    span = "µm across the joint" if motion.size else f"{curve.unit} at {curve.channel}"
    words = (
        f"{'falls' if change < 0 else 'rises'} by {abs(100.0 * change):.2g} % from "
        f"{low:.3g} to {high:.3g} {span}, damping ratio {first:.3g} to {last:.3g} %"
    )
    if mode.dependence is Dependence.NOT_DECIDED:
        words += f", not decided: {mode.reason}"
    return "; ".join([words, *(_match_words(match) for match in matches)])


def _match_words(match: CurveMatch) -> str:
    fit = f"chi2 per dof {match.chi2_per_dof:.2g}"
    if match.explanation == (NO_LAW,):
        return f"without a law: {match.words} ({fit})"
    words = f"{' + '.join(match.explanation)} predicts {100.0 * match.change:+.2g} %"
    if np.isfinite(match.scale):
        share = f"{match.scale:.2f} ± {match.scale_sd:.2g}"
        fit = f"measured change {share} of it, {fit}"
    return f"{words}: {match.words} ({fit})"
