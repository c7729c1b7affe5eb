# SPDX-License-Identifier: MIT
"""Modes over their amplitude for tables and JSON."""

from collections.abc import Sequence
from math import isfinite

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.signal.amplitude.amplitude_curve import AmplitudeMode, LawFit

COLUMNS = (
    "mode [Hz]",
    "on amplitude",
    "frequency, soft to hard [Hz]",
    "damping, soft to hard [%]",
    "best law",
    "reason",
)
"""Headings of `amplitude_rows`."""


def amplitude_rows(found: Sequence[AmplitudeMode]) -> tuple[tuple[str, ...], ...]:
    """Return a row of texts a mode."""
    return tuple(_row(mode) for mode in found)


def _row(mode: AmplitudeMode) -> tuple[str, ...]:
    curve, law = mode.curve, mode.laws[0] if mode.laws else None
    frequency = damping = "-"
    if curve is not None:
        frequency = f"{curve.frequency[0]:.6g} to {curve.frequency[-1]:.6g}"
        first, last = 100 * curve.damping_ratio[[0, -1]]
        damping = f"{first:.3g} to {last:.3g}"
    merged = len(mode.replaces) > 1
    reason = mode.reason
    if merged:
        reason += f"; {len(mode.replaces)} poles on one curve"
    return (
        f"{mode.soft.frequency:.6g}",
        mode.dependence.value,
        frequency,
        damping,
        "-" if law is None else law_words(law),
        reason,
    )


def law_words(law: LawFit) -> str:
    """Return a law with its exponent (or threshold) and standard uncertainty."""
    if law.exponent_sd > 0:
        return f"{law.name}, {law.exponent:.3g} ± {law.exponent_sd:.1g}"
    return f"{law.name}, exponent {law.exponent:g}"


def amplitude_json(found: Sequence[AmplitudeMode]) -> list[dict[str, object]]:
    """Return the records of ``modal --json``, one a mode."""
    return [_mode_json(mode) for mode in found]


def _mode_json(mode: AmplitudeMode) -> dict[str, object]:
    return {
        "outcome": mode.dependence.value,
        "reason": mode.reason,
        "poles_hz": list(mode.replaces),
        "soft": {
            "frequency_hz": mode.soft.frequency,
            "frequency_sd_hz": mode.soft.frequency_sd,
            "damping_ratio": mode.soft.damping_ratio,
            "damping_ratio_sd": mode.soft.damping_sd,
        },
        "frequency_change": mode.frequency_change,
        "frequency_change_sd": mode.frequency_change_sd,
        "damping_change": mode.damping_change,
        "damping_change_sd": mode.damping_change_sd,
        "chance": _number(mode.significance),
        "residual_ratio": _number(mode.residual_ratio),
        "linear_residual_ratio": _number(mode.linear_residual_ratio),
        "family": mode.family,
        "damping_over_softening": _number(mode.ratio),
        "laws": [
            {
                "name": law.name,
                "parameter": law.exponent,
                "parameter_sd": _number(law.exponent_sd),
                "chi2": law.chi2,
                "criterion": law.criterion,
            }
            for law in mode.laws
        ],
        "curve": _curve_json(mode),
    }


def _curve_json(mode: AmplitudeMode) -> dict[str, object] | None:
    curve = mode.curve
    if curve is None:
        return None
    return {
        "channel": curve.channel,
        "unit": curve.unit,
        "amplitude": _list(curve.amplitude),
        "frequency_hz": _list(curve.frequency),
        "frequency_sd_hz": _list(curve.frequency_sd),
        "damping_ratio": _list(curve.damping_ratio),
        "damping_ratio_sd": _list(curve.damping_sd),
        "frequency_noise_sd_hz": _list(curve.frequency_noise_sd),
        "damping_ratio_noise_sd": _list(curve.damping_noise_sd),
    }


def _list(values: FloatArray) -> list[float]:
    return [float(value) for value in values]


def _number(value: float) -> float | None:
    """Return a number that JSON can hold, None for one that is not known."""
    return float(value) if isfinite(value) else None
