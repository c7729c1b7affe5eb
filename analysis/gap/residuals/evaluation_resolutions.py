# SPDX-License-Identifier: MIT
"""Resolutions of a residual: window and step of the time integration."""

from dataclasses import dataclass

from jointbench.analysis.gap.residuals.residual_settings import RESIDUALS


@dataclass(frozen=True, slots=True)
class Resolution:
    """Resolution at which a residual is evaluated.

    Attributes:
        window: decay of the exponential window [s], or None for the whole record;
            short windows make the cost of a misplaced resonance smooth.
        oversampling: steps of the time integration per sample.
    """

    window: float | None = None
    oversampling: int = RESIDUALS.full_steps


MIDDLE = Resolution(oversampling=RESIDUALS.middle_steps)
FULL = Resolution()
FINE = Resolution(oversampling=RESIDUALS.fine_steps)
