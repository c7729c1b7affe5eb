# SPDX-License-Identifier: MIT
"""Values of one quantity of a joint, by assembly and level."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.array_checks import require_finite, require_shape
from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.gap.contact_bench.joint_states import (
    QUANTITIES,
    ContactQuantity,
    JointData,
)
from jointbench.analysis.gap.reassembly.reassembly_settings import REASSEMBLY


@dataclass(frozen=True, slots=True, eq=False)
class AssemblyRows:
    """Values of one quantity.

    Attributes:
        quantity: what was measured.
        value: natural logarithm of the value in SI units, shape (n,).
        covariance: of the measurement errors of the logarithms, shape (n, n).
        level: torque on each bolt [N m], or preload [N], shape (n,).
        assembly: number of the assembly of each value, in their order, shape (n,).
    """

    quantity: ContactQuantity
    value: FloatArray
    covariance: FloatArray
    level: FloatArray
    assembly: IntArray

    def __post_init__(self) -> None:
        """Check shapes and numbers."""
        n = len(self.value)
        for name in ("level", "assembly"):
            require_shape(name, getattr(self, name), (n,))
        require_shape("covariance", self.covariance, (n, n))
        for name in ("value", "covariance", "level"):
            require_finite(name, getattr(self, name))
        freeze(self, "value", "covariance", "level", "assembly")

    @property
    def assemblies(self) -> IntArray:
        """Numbers of the assemblies in their order, shape (n_assemblies,)."""
        return np.unique(self.assembly)

    @property
    def levels(self) -> FloatArray:
        """Different levels, rising, shape (n_levels,)."""
        ordered = np.sort(self.level)
        apart = np.diff(np.log(ordered)) > REASSEMBLY.same_level
        levels: FloatArray = ordered[np.concatenate([[True], apart])]
        return levels


def assembly_rows(data: JointData) -> dict[ContactQuantity, AssemblyRows]:
    """Return the values of each quantity that several assemblies can be compared by.

    States on the falling branch are left out, as flattened summits make them stiffer
    than those on the rising branch; so are values known from below only.

    Args:
        data: joint over its preload in several assemblies.

    Raises:
        BadData: there is one assembly only, or torques and preloads are mixed.
    """
    states, rows = data.states, data.rows
    known = np.isfinite(states.torque)
    if known.any() and not known.all() and not np.isfinite(states.preload).all():
        raise BadData(
            "some states have a torque only and others a preload only, so that their "
            "levels cannot be compared; give one of both for all states"
        )
    level = states.torque if known.all() else states.preload
    found = {}
    for index, quantity in enumerate(QUANTITIES):
        keep = (rows.quantity == index) & ~rows.bound & ~states.falling[rows.state]
        own = rows.chosen(keep)
        if np.unique(states.assembly[own.state]).size > 1:
            found[quantity] = AssemblyRows(
                quantity,
                own.value,
                own.covariance,
                level[own.state],
                states.assembly[own.state],
            )
    if not found:
        raise BadData(
            "the joint was measured in one assembly only; give the sessions of at "
            "least two, or the key 'assembly' of the states"
        )
    return found
