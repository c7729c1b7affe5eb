# SPDX-License-Identifier: MIT
"""The law of an effect as curves: loops, and natural frequencies over amplitude."""

from dataclasses import dataclass
from typing import Any

from jointbench.acquisition.basics.arrays import FloatArray, freeze


@dataclass(frozen=True, slots=True, eq=False)
class LawCurves:
    """A fitted force law, with the uncertainty of its parameters and of the base.

    Attributes:
        label: effect and site.
        motion: across the link over one cycle [m], shape (n_loops, n_points).
        force: of the law, without the linear link [N], same shape.
        force_sd: its standard deviation [N], same shape.
        amplitude: of harmonic motion across the link, up to the largest in the records
            [m], shape (n_amplitudes,).
        frequency: of each mode by the first harmonic of the law [Hz], shape (n_modes,
            n_amplitudes).
        frequency_sd: [Hz], same shape.
        damping: damping ratio of each mode likewise [-], same shape.
        damping_sd: [-], same shape.
    """

    label: str
    motion: FloatArray
    force: FloatArray
    force_sd: FloatArray
    amplitude: FloatArray
    frequency: FloatArray
    frequency_sd: FloatArray
    damping: FloatArray
    damping_sd: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "motion", "force", "force_sd", "amplitude")
        freeze(self, "frequency", "frequency_sd", "damping", "damping_sd")


def law_curves_json(curves: LawCurves) -> dict[str, Any]:
    """Return frequencies and damping over amplitude as JSON types, without loops."""
    return {
        "effect": curves.label,
        "amplitude_m": curves.amplitude.tolist(),
        "frequency_Hz": curves.frequency.tolist(),
        "frequency_sd_Hz": curves.frequency_sd.tolist(),
        "damping_ratio": curves.damping.tolist(),
        "damping_ratio_sd": curves.damping_sd.tolist(),
    }
