# SPDX-License-Identifier: MIT
"""How thoroughly a residual is evaluated, from a first look to the last digit."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Stage:
    """How thoroughly a residual is evaluated.

    Attributes:
        window: decay of the exponential window [s], or None for the whole record;
            short windows make the cost of a misplaced resonance smooth.
        oversampling: steps of the nonlinear march per sample.
    """

    window: float | None = None
    oversampling: int = 4


MIDDLE = Stage(oversampling=2)
FULL = Stage()
FINE = Stage(oversampling=8)
EVERYDAY = 30.0
"""Chi2 over dof beyond which a misfit is a missing effect of everyday size: directed
tests may point the wrong way, and nothing can be told of noise, settling or filter."""
