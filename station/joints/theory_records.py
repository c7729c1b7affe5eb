# SPDX-License-Identifier: MIT
"""A joint as identified beside the joint as predicted: the records."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

from jointbench.analysis.contact.torque_to_preload import Preload


class JointQuantity(StrEnum):
    """What is compared, as a joint's parameters end."""

    NORMAL_STIFFNESS = "normal_stiffness"
    TANGENTIAL_1_STIFFNESS = "tangential_1_stiffness"
    TANGENTIAL_2_STIFFNESS = "tangential_2_stiffness"
    NORMAL_DAMPING = "normal_damping"


@dataclass(frozen=True, slots=True)
class StateEstimate:
    """A value with its 95 % interval; ends are None where it is open or unknown.

    Attributes:
        value: [N/m] or [N s/m].
        low: lower end, same unit.
        high: upper end, same unit.
    """

    value: float
    low: float | None
    high: float | None

    def overlaps(self, other: "StateEstimate") -> bool | None:
        """Return whether two intervals overlap; None where one is not known."""
        ends = (self.low, self.high, other.low, other.high)
        if self.low is None or self.high is None or None in ends:
            return None
        assert other.low is not None
        assert other.high is not None
        return max(self.low, other.low) <= min(self.high, other.high)


@dataclass(frozen=True, slots=True)
class IdentifiedState:
    """What was identified of a joint in one state.

    Attributes:
        label: of the state.
        preload: on the joint, with what is uncertain of it.
        frequency: at which the law's loss becomes a damping coefficient [Hz], or None.
        values: identified, with their intervals.
        doubtful: those of them that the measurement does not determine.
    """

    label: str
    preload: Preload
    frequency: float | None
    values: Mapping[JointQuantity, StateEstimate]
    doubtful: frozenset[JointQuantity] = frozenset()


@dataclass(frozen=True, slots=True)
class TheoryRow:
    """One quantity of one state, identified and predicted.

    Attributes:
        state: its label.
        preload: on the joint [N].
        preload_sd: its standard uncertainty, part of the predictions' intervals [N].
        torque: on each bolt [N m], or None.
        quantity: what is compared.
        identified: from the measurement.
        identifiable: whether the measurement determines it.
        predicted: by model name; None where the model does not apply.
    """

    state: str
    preload: float
    preload_sd: float
    torque: float | None
    quantity: JointQuantity
    identified: StateEstimate
    identifiable: bool
    predicted: Mapping[str, StateEstimate | None]
