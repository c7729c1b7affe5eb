# SPDX-License-Identifier: MIT
"""Responses of bodies closed by their joints, on a damped Laplace line.

With the free receptances D of the modes, rows J of the joints and compliances z of the
joints, a unit force on rows B moves rows R by

    H = R D B' - (R D J') A^-1 (J D B'),    A = J D J' + diag(z).

What is added to the bodies, of the stiffness Z on rows P, holds the closed structure by
the forces (I + Z H_PP)^-1 Z H_PB. The sums over modes are one matrix product for some
lines at a time; of each line the systems of joints and of what is added are solved
where these sums lie in the cache.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.analysis.gap.structure_response.added_to_bodies import (
    added_rows,
    attached_stiffness,
)
from jointbench.analysis.gap.structure_response.joint_state import JointState
from jointbench.analysis.gap.structure_response.jointed_bodies import (
    NORMAL,
    JointedBodies,
)
from jointbench.analysis.gap.structure_response.line_forces import (
    Interfaces,
    Planes,
    forces_on_lines,
    responses_on_lines,
)
from jointbench.analysis.gap.structure_response.structure_settings import STRUCTURE


@dataclass(frozen=True, slots=True, eq=False)
class ClosedForces:
    """Forces at all interfaces: joints, then what is added to the bodies.

    Attributes:
        rows: of the interfaces in modes, shape (n_interfaces, n_modes).
        joints: how many of them are joints.
        planes: real and imaginary part of the forces per unit of each column, shape
            (n_interfaces, n_columns, n_lines).
    """

    rows: FloatArray
    joints: int
    planes: Planes


def modal_receptances(
    bodies: JointedBodies, state: JointState, s: ComplexArray
) -> ComplexArray:
    """Return the displacement of each free mode per modal force, (n_lines, n_modes)."""
    omega = state.omega(bodies)
    s = s[:, None]
    dynamic = s**2 + 2.0 * state.loss[bodies.body] * omega * s + omega**2
    return np.asarray(1.0 / (dynamic * state.mass[bodies.body]))


def joint_compliances(
    bodies: JointedBodies, state: JointState, s: ComplexArray, torque: float
) -> ComplexArray:
    """Return the dynamic compliance of each joint freedom [m/N], (n_lines, n_joints).

    Args:
        bodies: rows of the joints.
        state: of the model.
        s: Laplace variable, shape (n_lines,).
        torque: factor of the torque on stiffness and damping of the bolts [-].
    """
    a = state.compliance
    one = a / (1.0 + a * state.damping * s[:, None])
    bolts = one[:, bodies.row_directions] / (state.bolt * torque)[bodies.row_bolts]
    stiffness = np.repeat(state.foot[0] * state.foot_factor, 3)
    feet = 1.0 / (stiffness + state.foot[1] * s[:, None])
    return np.concatenate([bolts, feet], axis=1)


def close(
    bodies: JointedBodies,
    state: JointState,
    s: ComplexArray,
    columns: FloatArray,
    torque: float = 1.0,
) -> ComplexArray:
    """Return the response of the sensors to force columns, joints closed.

    Args:
        bodies: modes and rows.
        state: of the model.
        s: Laplace variable, shape (n_lines,).
        columns: force rows in modes, shape (n_columns, n_modes).
        torque: factor of the torque on stiffness and damping of the bolts [-].

    Returns:
        Displacement per force [m/N], shape (n_lines, n_rows, n_columns).
    """
    sensors = state.sensors_of(bodies)
    own = interface_rows(bodies, state)
    fewer, others = sorted((columns, sensors), key=len)
    pairs = np.concatenate(
        [_between(own, fewer), _products(own, others), _products(fewer, others)]
    )
    shape = len(fewer), len(others)
    found = np.empty((s.size, *shape), complex)
    for some, sums, interfaces in _by_lines(bodies, state, s, pairs, torque):
        responses_on_lines(sums, interfaces, shape, found[some])
    return found if fewer is sensors else found.transpose(0, 2, 1)


def closed_forces(
    bodies: JointedBodies,
    state: JointState,
    s: ComplexArray,
    columns: FloatArray,
    torque: float = 1.0,
) -> ClosedForces:
    """Return the forces at the interfaces, which slopes of responses need.

    Args:
        bodies: modes and rows.
        state: of the model.
        s: Laplace variable, shape (n_lines,).
        columns: force rows in modes, shape (n_columns, n_modes).
        torque: factor of the torque on stiffness and damping of the bolts [-].
    """
    own = interface_rows(bodies, state)
    pairs = _between(own, columns)
    shape = len(own), len(columns), s.size
    found = np.empty(shape), np.empty(shape)
    for some, sums, interfaces in _by_lines(bodies, state, s, pairs, torque):
        forces_on_lines(sums, interfaces, some.start, found)
    return ClosedForces(own, len(bodies.joint_rows), found)


def interface_rows(bodies: JointedBodies, state: JointState) -> FloatArray:
    """Return rows of joints, then of what is added, (n_interfaces, n_modes)."""
    return np.concatenate([bodies.joint_rows, *added_rows(bodies, state)])


def _products(one: FloatArray, two: FloatArray) -> FloatArray:
    """Return products of rows by mode, shape (n_one * n_two, n_modes)."""
    return (one[:, None, :] * two[None, :, :]).reshape(-1, one.shape[1])


def _between(own: FloatArray, columns: FloatArray) -> FloatArray:
    """Return products of interfaces with each other and with columns, by mode."""
    first, second = np.triu_indices(len(own))
    return np.concatenate([own[first] * own[second], _products(own, columns)])


def _by_lines(
    bodies: JointedBodies,
    state: JointState,
    s: ComplexArray,
    pairs: FloatArray,
    torque: float,
) -> Iterator[tuple[slice, Planes, Interfaces]]:
    """Yield sums over modes and what closes the interfaces, of some lines at a time."""
    tuned = np.zeros((0, 0)) if state.tuned is None else state.tuned.stiffness
    coupled, loss = np.zeros((0, 0)), 1.0 + 0.0 * s
    if state.rocking is not None:
        coupled = state.rocking
        # It loses as much energy per cycle as the bolts do.
        loss = 1.0 + state.compliance[NORMAL] * state.damping[NORMAL] * s
    step = max(STRUCTURE.sums_at_once // len(pairs), 1)
    for first in range(0, s.size, step):
        some = slice(first, min(first + step, s.size))
        d = modal_receptances(bodies, state, s[some])
        interfaces = (
            joint_compliances(bodies, state, s[some], torque),
            coupled,
            loss[some],
            attached_stiffness(bodies, state, s[some]),
            tuned,
        )
        yield some, (d.real @ pairs.T, d.imag @ pairs.T), interfaces
