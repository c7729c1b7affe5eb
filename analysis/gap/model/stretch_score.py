# SPDX-License-Identifier: MIT
"""Scores of a model on stretches of a record that no fit has seen."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class StretchScore:
    """Prediction error on a stretch that was not used for the fit.

    Attributes:
        name: of the stretch.
        rms: of the measured output.
        before: rms error of the base.
        after: rms error of the base with the effects found.
    """

    name: str
    rms: float
    before: float
    after: float

    @property
    def shrink(self) -> float:
        """1 - after / before [-]."""
        return 1.0 - self.after / self.before if self.before > 0 else 0.0
