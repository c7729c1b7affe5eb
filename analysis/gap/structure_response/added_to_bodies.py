# SPDX-License-Identifier: MIT
"""What is added to closed bodies at a few rows: attached things and tuned modes.

A dynamic stiffness Z on rows P changes the closed response H to

    H' = H - H_P (I + Z H_PP)^-1 Z H_P',

so the rows of what is added stand at the ends of those of the sensors and columns.
"""

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.analysis.gap.structure_response.joint_state import Attached, JointState
from jointbench.analysis.gap.structure_response.jointed_bodies import JointedBodies


def ends_with_added(
    bodies: JointedBodies, state: JointState, columns: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return rows and columns, with those of what is added at their ends."""
    places = added_rows(bodies, state)
    sensors = state.sensors_of(bodies)
    return (
        np.concatenate([sensors, *places]),
        np.concatenate([columns, *places]),
    )


def with_added(
    bodies: JointedBodies, state: JointState, s: ComplexArray, response: ComplexArray
) -> ComplexArray:
    """Return the response of the sensors to the columns with what is added.

    Args:
        bodies: places and rows.
        state: with what is added.
        s: Laplace variable, shape (n_lines,).
        response: without it, its rows and columns at the ends, shape
            (n_lines, n_rows, n_columns).
    """
    if not added_rows(bodies, state):
        return response
    force = _forces_by_column(bodies, state, s, response)
    count = force.shape[1]
    inside = response[:, :-count, :-count]
    return np.asarray(inside - response[:, :-count, -count:] @ force)


def added_rows(bodies: JointedBodies, state: JointState) -> list[FloatArray]:
    """Return the rows of attached things and of tuned modes, (n, n_modes) each."""
    tuned = () if state.tuned is None else (state.tuned.rows,)
    return [*(a.rows(bodies) for a in state.attached), *tuned]


def attached_stiffness(
    bodies: JointedBodies, state: JointState, s: ComplexArray
) -> ComplexArray:
    """Return the stiffness of attached things by row [N/m], shape (n_lines, n).

    Args:
        bodies: places and rows.
        state: with what is attached.
        s: Laplace variable, shape (n_lines,).
    """
    found = [
        np.repeat(_stiffness_of(one, s)[:, None], len(one.rows(bodies)), axis=1)
        for one in state.attached
    ]
    return np.concatenate([np.zeros((s.size, 0), complex), *found], axis=1)


def _added_forces(
    bodies: JointedBodies, state: JointState, s: ComplexArray, motion: ComplexArray
) -> ComplexArray:
    """Return the forces of what is added at motions of its rows, of their shape.

    Args:
        bodies: places and rows.
        state: with what is added.
        s: Laplace variable, shape (n_lines,).
        motion: of the rows, shape (n_lines, n, n_columns).
    """
    found = motion.copy()
    attached = attached_stiffness(bodies, state, s)
    count = attached.shape[1]
    found[:, :count] *= attached[:, :, None]
    if state.tuned is not None:
        found[:, count:] = state.tuned.stiffness @ motion[:, count:]
    return found


def _forces_by_column(
    bodies: JointedBodies, state: JointState, s: ComplexArray, h: ComplexArray
) -> ComplexArray:
    """Return the forces of what is added to the bodies per unit of each column.

    Rows and columns of what is added are the last.

    Args:
        bodies: places and rows.
        state: with what is added.
        s: Laplace variable, shape (n_lines,).
        h: response without it, shape (n_lines, n_rows, n_columns).
    """
    count = sum(len(rows) for rows in added_rows(bodies, state))
    forces = _added_forces(bodies, state, s, h[:, -count:])
    inner = np.eye(count) + forces[:, :, -count:]
    found = np.linalg.solve(inner, forces[:, :, :-count])
    return np.asarray(found, dtype=np.complex128)


def _stiffness_of(attached: Attached, s: ComplexArray) -> ComplexArray:
    """Return force per displacement of what is attached [N/m], shape (n_lines,)."""
    inertia = attached.mass * s**2 + attached.stiffness
    if attached.frequency is None:
        return np.asarray(inertia)
    omega = 2.0 * np.pi * attached.frequency
    spring = 2.0 * attached.damping * omega * s + omega**2
    return np.asarray(inertia * spring / (s**2 + spring))
