# SPDX-License-Identifier: MIT
"""Uncertainty of the inputs of a contact model."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.errors import UsageError


@dataclass(frozen=True, slots=True)
class ContactSpread:
    """Standard deviations of the inputs of a contact model.

    Attributes:
        dimension: of the fractal dimension [-].
        log_roughness: of ln G [-].
        correlation: between dimension and ln G [-]; a structure-function fit has a
            strong one.
        preload: [N].
        hardness: [Pa].
        friction: of the friction factor k_mu [-].
    """

    dimension: float = 0.0
    log_roughness: float = 0.0
    correlation: float = 0.0
    preload: float = 0.0
    hardness: float = 0.0
    friction: float = 0.0

    def __post_init__(self) -> None:
        """Check signs and the correlation."""
        for name in ("dimension", "log_roughness", "preload", "hardness", "friction"):
            if not 0 <= getattr(self, name) < np.inf:
                raise UsageError(
                    f"spread of {name} is {getattr(self, name)!r}, it cannot be "
                    "negative; give a standard deviation or 0"
                )
        if not -1 <= self.correlation <= 1:
            raise UsageError(
                f"correlation is {self.correlation!r}, it must be between -1 and 1"
            )
