# SPDX-License-Identifier: MIT
"""Hits of the hammer as they are: where they land, their direction, their pulses."""

from dataclasses import dataclass
from enum import StrEnum

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.simulators.flexible.flexible_specimen import Vector
from jointbench.simulators.measuring.hammer import Pulse, pulse_force

SAMPLE_RATE, SAMPLES, PRETRIGGER = 25600.0, 8192, 512


class BadHit(StrEnum):
    """What makes a hit useless."""

    DOUBLE = "double"
    OVERLOAD = "overload"
    GLANCING = "glancing"


@dataclass(frozen=True, slots=True)
class HitRecord:
    """One hit.

    Attributes:
        point: index of the point under the hammer.
        torque: on each bolt [N m].
        level: peak force that the operator aims for [N].
        time: since the first hit [s].
        offset: of the landing point from the aimed one [m].
        direction: of the force, unit vector.
        pulses: the contact, and a second one of a double hit; times in the record.
        bad: None for a good hit.
    """

    point: int
    torque: float
    level: float
    time: float
    offset: Vector
    direction: Vector
    pulses: tuple[Pulse, ...]
    bad: BadHit | None = None

    def force(self, times: FloatArray) -> FloatArray:
        """Return the force at ascending times of the record [N]."""
        return pulse_force(self.pulses, times)
