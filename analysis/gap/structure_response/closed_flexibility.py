# SPDX-License-Identifier: MIT
"""Closed flexibility of the modes, from which responses of many effects follow.

Directed tests evaluate hundreds of effects at one state of the joints. Sensors, laws
and what is attached at a place leave the closure of the joints as it is: their
responses are products with the flexibility of the modes, which is closed once.
"""

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.analysis.gap.structure_response.added_to_bodies import (
    ends_with_added,
    with_added,
)
from jointbench.analysis.gap.structure_response.closed_response import close
from jointbench.analysis.gap.structure_response.joint_state import JointState
from jointbench.analysis.gap.structure_response.jointed_bodies import JointedBodies
from jointbench.analysis.gap.structure_response.tuned_modes import TunedStiffness

_BESIDE = {"attached", "cables", "gain", "lag", "laws", "points", "sensors"}
"""Fields of a state that leave the closure of joints and bodies as it is."""


@dataclass(frozen=True, slots=True, eq=False)
class ClosedFlexibility:
    """Displacement of the free modes per modal force, joints closed, modes tuned.

    Attributes:
        state: of the joints and bodies.
        s: Laplace variable, shape (n_lines,).
        modes: nothing attached, shape (n_modes, n_modes, n_lines).
    """

    state: JointState
    s: ComplexArray
    modes: ComplexArray

    def holds(self, state: JointState, s: ComplexArray) -> bool:
        """Return whether a state has the same joints and bodies, on the same lines."""
        closing = (f.name for f in fields(state) if f.name not in _BESIDE)
        return s is self.s and all(
            np.array_equal(a, b)
            for name in closing
            for a, b in zip(
                _numbers(getattr(self.state, name)),
                _numbers(getattr(state, name)),
                strict=True,
            )
        )

    def response(
        self, bodies: JointedBodies, state: JointState, columns: FloatArray
    ) -> ComplexArray:
        """Return the closed response between the sensors and force columns.

        Args:
            bodies: modes and rows.
            state: with these joints and bodies.
            columns: force rows in modes, shape (n_columns, n_modes).

        Returns:
            Displacement per force [m/N], shape (n_lines, n_rows, n_columns).
        """
        added = replace(state, tuned=None)
        rows, columns = ends_with_added(bodies, added, columns)
        modes = self.modes.shape[0]
        # Rows and columns are real: a real product is a quarter of a complex one.
        flat = self.modes.view(np.float64)
        moved = (columns @ flat.reshape(modes, -1)).reshape(len(columns), modes, -1)
        found = (rows @ moved).view(np.complex128)
        return with_added(bodies, added, self.s, found.transpose(2, 1, 0))


def closed_flexibility(
    bodies: JointedBodies, state: JointState, s: ComplexArray
) -> ClosedFlexibility | None:
    """Return the closed flexibility at a state; None where it follows the torque.

    Args:
        bodies: modes and rows.
        state: of the model.
        s: Laplace variable, shape (n_lines,).
    """
    if state.exponent or state.damping_exponent or state.bodies is not None:
        return None
    each = np.eye(bodies.omega.size)
    bare = replace(state, sensors=each, attached=())
    closed = close(bodies, bare, s, each)
    modes = np.ascontiguousarray(closed.transpose(1, 2, 0))
    return ClosedFlexibility(state, s, modes)


def _numbers(value: Any) -> tuple[Any, Any]:
    """Return the numbers of a field of a state."""
    if isinstance(value, TunedStiffness):
        return value.rows, value.stiffness
    return value, None
