# SPDX-License-Identifier: MIT
"""The stiffness of a joint from its structure, as data of the contact bench."""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.array_checks import require_shape
from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
from jointbench.analysis.gap.chain.chain_records import JointReading
from jointbench.analysis.gap.chain.chain_settings import CHAIN
from jointbench.analysis.gap.contact_bench.joint_states import (
    QUANTITIES,
    ContactQuantity,
    JointData,
    JointFacts,
    JointRows,
    JointStates,
)


@dataclass(frozen=True, slots=True, eq=False)
class BoltedStates:
    """States of a bolted joint in the order in which they were measured.

    Attributes:
        name: of the measurement.
        facts: bolts, area, materials.
        preload: by the nominal nut factor [N], shape (n_states,).
        assembly: number of the assembly, from 0, same shape.
        quantity: which stiffness the structure gives.
    """

    name: str
    facts: JointFacts
    preload: FloatArray
    assembly: IntArray
    quantity: ContactQuantity = ContactQuantity.NORMAL

    def __post_init__(self) -> None:
        """Check shapes and make the arrays read-only."""
        require_shape("assembly", self.assembly, (len(self.preload),))
        freeze(self, "preload", "assembly")

    @property
    def torque(self) -> FloatArray:
        """On each bolt [N m], shape (n_states,)."""
        f = self.facts
        return np.asarray(self.preload * f.nut_factor * f.diameter / f.bolts)

    @property
    def log_range(self) -> tuple[float, float]:
        """Smallest and largest ln P [ln N]."""
        log_p = np.log(self.preload)
        return float(log_p.min()), float(log_p.max())


def joint_data(states: BoltedStates, reading: JointReading) -> JointData:
    """Return the joint over its preload, as the contact bench takes it.

    The torque is taken as measured, so that all states share the nut factor.

    Args:
        states: of the joint.
        reading: its stiffness by the structure.
    """
    count = len(states.preload)
    unknown = np.full(count, np.nan)
    falling = np.array(
        [
            bool(np.any(states.preload[:k][_same(states, k)] > one * (1 + 1e-6)))
            for k, one in enumerate(states.preload)
        ]
    )
    floor = np.eye(count) * CHAIN.reading_sd**2
    return JointData(
        states.name,
        states.facts,
        JointStates(
            states.torque,
            unknown,
            np.zeros(count),
            states.assembly,
            falling,
            unknown,
            unknown,
            unknown,
        ),
        JointRows(
            np.arange(count),
            np.full(count, QUANTITIES.index(states.quantity)),
            reading.log_stiffness,
            reading.covariance + floor,
            np.zeros(count, dtype=bool),
        ),
    )


def _same(states: BoltedStates, k: int) -> FloatArray:
    return np.asarray(states.assembly[:k] == states.assembly[k])


def with_common_error(reading: JointReading, sd: float) -> JointReading:
    """Return a reading whose values share an error, of sd `sd` of ln k [-]."""
    return replace(reading, covariance=reading.covariance + sd**2)
