# SPDX-License-Identifier: MIT
"""Loads over time: harmonic parts, and tables that are piecewise linear."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from jointbench.acquisition.basics.array_checks import (
    require_ascending,
    require_finite,
    require_shape,
)
from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData


class Begin(StrEnum):
    """State of the structure when a transient begins."""

    REST = "rest"
    STEADY = "steady"


@dataclass(frozen=True, slots=True)
class HarmonicLoad:
    """A force amplitude sin(rate t + phase) along an input.

    Attributes:
        input: number of the input.
        amplitude: [N].
        rate: circular frequency [rad/s].
        phase: [rad]; pi/2 makes it a cosine.
    """

    input: int
    amplitude: float
    rate: float
    phase: float = 0.0

    def __post_init__(self) -> None:
        """Check the sign of the frequency."""
        if not self.rate >= 0.0:
            raise BadData(f"a load of {self.rate:g} rad/s; it must not be negative")


@dataclass(frozen=True, slots=True, eq=False)
class TableLoad:
    """A force along an input, linear between the points of a table.

    Attributes:
        input: number of the input.
        time: ascending [s], shape (n_points,); the first and last values hold outside.
        force: [N], shape (n_points,).
    """

    input: int
    time: FloatArray
    force: FloatArray

    def __post_init__(self) -> None:
        """Check the order of the times; make the arrays read-only."""
        require_ascending("time", self.time)
        require_finite("time", self.time)
        require_finite("force", self.force)
        require_shape("force", self.force, (self.time.size,))
        freeze(self, "time", "force")

    def at(self, time: FloatArray) -> FloatArray:
        """Return the force at times [N]."""
        return np.asarray(np.interp(time, self.time, self.force))


Load = HarmonicLoad | TableLoad
