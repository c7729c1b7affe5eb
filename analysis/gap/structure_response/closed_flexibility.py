# SPDX-License-Identifier: MIT
"""Closed flexibility of the modes, from which responses of many effects follow.

Directed tests evaluate hundreds of effects at one state of the joints. Sensors, laws
and what is attached at a place leave the closure of the joints as it is: their
responses are products with the flexibility of the modes, which is closed once.
"""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.analysis.gap.structure_response.added_to_bodies import (
    ends_with_added,
    with_added,
)
from jointbench.analysis.gap.structure_response.closed_response import close
from jointbench.analysis.gap.structure_response.joint_state import JointState
from jointbench.analysis.gap.structure_response.jointed_bodies import JointedBodies


@dataclass(frozen=True, slots=True, eq=False)
class ClosedFlexibility:
    """Displacement of the free modes per modal force, joints closed, modes tuned.

    Attributes:
        state: of the joints and bodies.
        s: Laplace variable, shape (n_lines,).
        modes: nothing attached, shape (n_lines, n_modes, n_modes).
    """

    state: JointState
    s: ComplexArray
    modes: ComplexArray

    def holds(self, state: JointState, s: ComplexArray) -> bool:
        """Return whether a state has the same joints and bodies, on the same lines."""
        one, two = _closed_by(self.state), _closed_by(state)
        same = len(one) == len(two) and s is self.s
        return same and all(np.array_equal(a, b) for a, b in zip(one, two, strict=True))

    def response(
        self, bodies: JointedBodies, state: JointState, columns: FloatArray
    ) -> ComplexArray:
        """Return the closed response between the sensors and force columns.

        Args:
            bodies: modes and rows.
            state: with these joints and bodies.
            columns: force rows in modes, shape (n_columns, n_modes).
        """
        added = replace(state, tuned=None)
        rows, columns = ends_with_added(bodies, added, columns)
        return with_added(bodies, added, self.s, (rows @ self.modes) @ columns.T)


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
    return ClosedFlexibility(state, s, close(bodies, bare, s, each).response)


def _closed_by(state: JointState) -> list[FloatArray]:
    """Return all numbers of a state by which its joints and bodies are closed."""
    own = [state.modulus, state.mass, state.loss, state.compliance, state.damping]
    own += [state.bolt, np.array(state.foot), state.foot_factor]
    own.append(np.array([state.exponent, state.damping_exponent]))
    own.append(np.array([state.bodies is not None], dtype=float))
    if state.rocking is not None:
        own.append(state.rocking)
    if state.tuned is not None:
        own += [state.tuned.rows, state.tuned.stiffness]
    return own
