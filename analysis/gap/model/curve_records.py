# SPDX-License-Identifier: MIT
"""Measured curves of modes over amplitude, next to those that explanations predict."""

from dataclasses import dataclass
from math import isfinite
from typing import Any

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.signal.amplitude.amplitude_curve import AmplitudeMode


@dataclass(frozen=True, slots=True, eq=False)
class PredictedCurve:
    """Frequency and damping of a mode that a fit predicts, at measured amplitudes.

    Attributes:
        motion: across the joint of its first law [m], shape (n,); empty without a law.
        frequency: [Hz], shape (n,).
        frequency_sd: of its change, from the covariance of the fit [Hz], shape (n,).
        damping: damping ratio [-], shape (n,).
        damping_sd: of its change [-], shape (n,).
    """

    motion: FloatArray
    frequency: FloatArray
    frequency_sd: FloatArray
    damping: FloatArray
    damping_sd: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "motion", "frequency", "frequency_sd", "damping", "damping_sd")


@dataclass(frozen=True, slots=True, eq=False)
class CurveMatch:
    """One explanation against the curve of one mode.

    Attributes:
        explanation: labels of its effects; ("none",) for the base.
        curve: what it predicts at the amplitudes of the measured curve.
        change: of frequency from the lowest to the highest amplitude, relative [-].
        chi2_per_dof: squared deviations of the changes of frequency and damping, per
            degree of freedom [-].
        scale: measured change over the predicted one, by least squares [-]; nan where
            nothing is predicted to change.
        scale_sd: its standard uncertainty [-]; nan likewise.
        words: consistent, inconsistent or not decided.
    """

    explanation: tuple[str, ...]
    curve: PredictedCurve
    change: float
    chi2_per_dof: float
    scale: float
    scale_sd: float
    words: str


@dataclass(frozen=True, slots=True, eq=False)
class ModeEvidence:
    """One mode of the model: its measured curve and the explanations.

    Attributes:
        number: of the mode, from 1.
        frequency: of the base [Hz].
        measured: the mode over its amplitude; None where no mode was found there.
        matches: of the explanations, the base last; empty without a curve.
        words: one line.
    """

    number: int
    frequency: float
    measured: AmplitudeMode | None
    matches: tuple[CurveMatch, ...]
    words: str


@dataclass(frozen=True, slots=True)
class CurveEvidence:
    """All modes of a model.

    Attributes:
        modes: by ascending frequency.
        words: one line each; the reason where no curve can be determined.
        hits: number of hits that the curves come from.
    """

    modes: tuple[ModeEvidence, ...]
    words: tuple[str, ...]
    hits: int = 0


def curve_evidence_json(evidence: CurveEvidence | None) -> dict[str, Any] | None:
    """Return the evidence as JSON types."""
    if evidence is None:
        return None
    return {
        "hits": evidence.hits,
        "words": list(evidence.words),
        "modes": [_mode_json(mode) for mode in evidence.modes],
    }


def _mode_json(mode: ModeEvidence) -> dict[str, Any]:
    found = mode.measured
    curve = None if found is None else found.curve
    return {
        "mode": mode.number,
        "frequency_Hz": mode.frequency,
        "outcome": None if found is None else found.dependence.value,
        "reason": "" if found is None else found.reason,
        "words": mode.words,
        "measured": None
        if curve is None
        else {
            "channel": curve.channel,
            "unit": curve.unit,
            "amplitude": curve.amplitude.tolist(),
            "frequency_Hz": curve.frequency.tolist(),
            "frequency_sd_Hz": curve.frequency_sd.tolist(),
            "damping_ratio": curve.damping_ratio.tolist(),
            "damping_ratio_sd": curve.damping_sd.tolist(),
        },
        "predicted": [_match_json(match) for match in mode.matches],
    }


def _match_json(match: CurveMatch) -> dict[str, Any]:
    curve = match.curve
    return {
        "explanation": list(match.explanation),
        "motion_m": curve.motion.tolist(),
        "frequency_Hz": curve.frequency.tolist(),
        "frequency_sd_Hz": curve.frequency_sd.tolist(),
        "damping_ratio": curve.damping.tolist(),
        "damping_ratio_sd": curve.damping_sd.tolist(),
        "change": match.change,
        "chi2_per_dof": match.chi2_per_dof,
        "scale": _number(match.scale),
        "scale_sd": _number(match.scale_sd),
        "outcome": match.words,
    }


def _number(value: float) -> float | None:
    """Return a number that JSON can hold, None for one that is not known."""
    return value if isfinite(value) else None
