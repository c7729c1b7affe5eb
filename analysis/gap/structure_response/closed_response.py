# SPDX-License-Identifier: MIT
"""Responses of bodies closed by their joints, on a damped Laplace line.

With the free receptances D of the modes, rows J of the joints and compliances z of the
joints, a unit force on rows B moves rows R by

    H = R D B' - (R D J') A^-1 (J D B'),    A = J D J' + diag(z).

The products over modes are one matrix product for all lines, and the system of the size
of the joints is solved for all lines at once. The slopes come from the same closure:
dH/dz_j = (R D J' A^-1)_j (A^-1 J D B')_j, and dH/dD_n is the product of closed rows.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, IntArray
from jointbench.analysis.gap.structure_response.added_to_bodies import (
    added_rows,
    ends_with_added,
    forces_by_column,
    solved,
    with_added,
)
from jointbench.analysis.gap.structure_response.base_layout import (
    BaseLayout,
    BaseName,
    bolt_name,
    loss_name,
    mass_name,
    modulus_name,
    stiffness_name,
)
from jointbench.analysis.gap.structure_response.joint_state import JointState
from jointbench.analysis.gap.structure_response.jointed_bodies import (
    NORMAL,
    JointedBodies,
)
from jointbench.analysis.gap.structure_response.structure_settings import STRUCTURE


@dataclass(frozen=True, slots=True, eq=False)
class Closure:
    """Closed responses between the sensors and force columns.

    Attributes:
        s: Laplace variable of each line [rad/s], shape (n_lines,).
        torque: factor of the torque on stiffness and damping of the bolts [-].
        response: displacement per force [m/N], shape (n_lines, n_rows, n_columns).
        left: joint forces per unit of each row, shape (n_lines, n_joints, n_rows).
        system: A of each line, shape (n_lines, n_joints, n_joints).
        across: motion of the open joints by each column, shape
            (n_lines, n_joints, n_columns).
        columns: force rows in modes, shape (n_columns, n_modes).
    """

    s: ComplexArray
    torque: float
    response: ComplexArray
    left: ComplexArray
    system: ComplexArray
    across: ComplexArray
    columns: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class ClosedRows:
    """What the slopes of a closed response need.

    Attributes:
        left: joint forces per unit of each row, shape (n_lines, n_joints, n_rows).
        right: joint forces of each column, shape (n_lines, n_joints, n_columns).
        rows: with the joints closed, in modes, shape (n_lines, n_rows, n_modes).
        columns: likewise, shape (n_lines, n_modes, n_columns).
    """

    left: ComplexArray
    right: ComplexArray
    rows: ComplexArray
    columns: ComplexArray


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


def _sums_over_modes(one: FloatArray, two: FloatArray, d: ComplexArray) -> ComplexArray:
    """Return the sum over modes of one, d and two, shape (n_lines, n_one, n_two)."""
    pairs = (one[:, None, :] * two[None, :, :]).reshape(-1, d.shape[1])
    kept = np.arange(len(pairs))
    if one is two:
        upper = np.triu_indices(len(one))
        kept = upper[0] * len(one) + upper[1]
    found = np.empty((d.shape[0], len(kept)), dtype=complex)
    found.real = d.real @ pairs[kept].T
    found.imag = d.imag @ pairs[kept].T
    if one is two:
        source = np.empty((len(one), len(one)), dtype=int)
        source[upper] = source[upper[::-1]] = np.arange(len(kept))
        found = found[:, source.ravel()]
    return found.reshape(d.shape[0], len(one), len(two))


def close(
    bodies: JointedBodies,
    state: JointState,
    s: ComplexArray,
    columns: FloatArray,
    torque: float = 1.0,
) -> Closure:
    """Close the joints between the sensors and force columns.

    Args:
        bodies: modes and rows.
        state: of the model.
        s: Laplace variable, shape (n_lines,).
        columns: force rows in modes, shape (n_columns, n_modes).
        torque: factor of the torque on stiffness and damping of the bolts [-].
    """
    rows, columns = ends_with_added(bodies, state, columns)
    joints = bodies.joint_rows
    d = modal_receptances(bodies, state, s)
    system = _sums_over_modes(joints, joints, d)
    at = np.arange(len(joints))
    system[:, at, at] += joint_compliances(bodies, state, s, torque)
    if state.rocking is not None:
        normal = NORMAL + 3 * np.arange(len(bodies.bolts))
        # It loses as much energy per cycle as the bolts do.
        lossy = 1.0 + state.compliance[NORMAL] * state.damping[NORMAL] * s
        system[:, normal[:, None], normal] += state.rocking / lossy[:, None, None]
    across = _sums_over_modes(joints, columns, d)
    left = solved(system, _sums_over_modes(joints, rows, d))
    response = _sums_over_modes(rows, columns, d)
    response -= left.transpose(0, 2, 1) @ across
    response = with_added(bodies, state, s, response)
    return Closure(s, torque, response, left, system, across, columns)


def closed_rows(found: Closure, bodies: JointedBodies, state: JointState) -> ClosedRows:
    """Return closed rows and columns, for slopes.

    With what is added to the bodies they are twice as large as without, so they are
    computed for some lines at a time.

    Args:
        found: closed response.
        bodies: modes and rows.
        state: at which it was closed.
    """
    lines, joints = found.s.size, len(bodies.joint_rows)
    rows, columns = found.response.shape[1:]
    modes = bodies.omega.size
    shapes = (joints, rows), (joints, columns), (rows, modes), (modes, columns)
    whole = ClosedRows(*(np.empty((lines, *shape), complex) for shape in shapes))
    for first in range(0, lines, STRUCTURE.lines_at_once):
        some = slice(first, first + STRUCTURE.lines_at_once)
        part = _closed_at(_some_lines(found, some), bodies, state)
        whole.left[some], whole.right[some] = part.left, part.right
        whole.rows[some], whole.columns[some] = part.rows, part.columns
    return whole


def _some_lines(found: Closure, some: slice) -> Closure:
    """Return the closure on some of its lines."""
    return replace(
        found,
        s=found.s[some],
        response=found.response[some],
        left=found.left[some],
        system=found.system[some],
        across=found.across[some],
    )


def _closed_at(found: Closure, bodies: JointedBodies, state: JointState) -> ClosedRows:
    """Return closed rows and columns on all lines of a closure."""
    rows, _ = ends_with_added(bodies, state, np.zeros((0, bodies.omega.size)))
    columns, joints, left = found.columns, bodies.joint_rows, found.left
    right = solved(found.system, found.across)
    in_rows = rows - left.transpose(0, 2, 1) @ joints
    in_columns = (columns - right.transpose(0, 2, 1) @ joints).transpose(0, 2, 1)
    if not added_rows(bodies, state):
        return ClosedRows(left, right, in_rows, in_columns)
    d = modal_receptances(bodies, state, found.s)
    bare = _sums_over_modes(rows, columns, d) - left.transpose(0, 2, 1) @ found.across
    by_row = forces_by_column(bodies, state, found.s, bare.transpose(0, 2, 1))
    by_column = forces_by_column(bodies, state, found.s, bare)
    count = by_row.shape[1]
    return ClosedRows(
        left[:, :, :-count] - left[:, :, -count:] @ by_row,
        right[:, :, :-count] - right[:, :, -count:] @ by_column,
        in_rows[:, :-count] - by_row.transpose(0, 2, 1) @ in_rows[:, -count:],
        in_columns[:, :, :-count] - in_columns[:, :, -count:] @ by_column,
    )


_Slope = Callable[[], ComplexArray]
"""Computes the derivative of the response, shape (n_lines, n_rows, n_columns)."""


def response_slopes(
    found: Closure,
    bodies: JointedBodies,
    state: JointState,
    layout: BaseLayout,
) -> dict[str, _Slope]:
    """Return the derivative of the response by each base coordinate.

    All of them at once are several times as large as the response to all hits.

    Args:
        found: closed response.
        bodies: modes and rows.
        state: at which it was closed.
        layout: base coordinates.

    Returns:
        By coordinate, each computed when it is called.
    """
    ends = closed_rows(found, bodies, state)
    slopes = _modal_slopes(found, ends, bodies, state, layout)
    slopes |= _tuned_slopes(found, ends, bodies, state, layout)
    left = ends.left.transpose(0, 2, 1)

    def across(joints: IntArray, change: ComplexArray) -> ComplexArray:
        weighted = change[:, :, None] * ends.right[:, joints]
        return np.asarray(left[:, :, joints] @ weighted)

    changes = _compliance_slopes(found, bodies, state, layout)
    return slopes | {name: partial(across, *one) for name, one in changes.items()}


def _modal_slopes(
    found: Closure,
    ends: ClosedRows,
    bodies: JointedBodies,
    state: JointState,
    layout: BaseLayout,
) -> dict[str, _Slope]:
    """Return the slopes by modulus, mass and damping ratio of each body."""
    omega, s = state.omega(bodies), found.s[:, None]
    d = modal_receptances(bodies, state, found.s)
    square = -(d**2) * state.mass[bodies.body]
    loss = state.loss[bodies.body]
    by_loss = square * 2.0 * loss * omega * s
    by_modulus = square * (loss * omega * s + omega**2)

    def across(change: ComplexArray, modes: slice) -> ComplexArray:
        rows = ends.rows[:, :, modes] * change[:, None, modes]
        return np.asarray(rows @ ends.columns[:, modes])

    slopes: dict[str, _Slope] = {}
    for k, name in enumerate(bodies.bodies):
        own = np.flatnonzero(bodies.body == k)
        modes = slice(int(own[0]), int(own[-1]) + 1)
        slopes[modulus_name(name)] = partial(across, by_modulus, modes)
        slopes[loss_name(name)] = partial(across, by_loss, modes)
        slopes[mass_name(name)] = partial(across, -d, modes)
    return slopes


def _tuned_slopes(
    found: Closure,
    ends: ClosedRows,
    bodies: JointedBodies,
    state: JointState,
    layout: BaseLayout,
) -> dict[str, _Slope]:
    """Return the slopes by the frequencies of closed modes."""
    if layout.tuned is None or state.tuned is None:
        return {}
    d = modal_receptances(bodies, state, found.s)
    modes = state.tuned.rows
    by_row = (ends.rows * d[:, None]) @ modes.T
    by_column = (modes * d[:, None]) @ ends.columns

    def across(i: int, j: int, slope: float) -> ComplexArray:
        found = -slope * by_row[:, :, [i]] * by_column[:, [j]]
        if i != j:
            found -= slope * by_row[:, :, [j]] * by_column[:, [i]]
        return np.asarray(found)

    tuned = zip(layout.tuned.names, state.tuned.ends, state.tuned.slope, strict=True)
    return {
        name: partial(across, int(i), int(j), float(slope))
        for name, (i, j), slope in tuned
    }


_Change = tuple[IntArray, ComplexArray]
"""Joint freedoms, and the slope of their compliance, shape (n_lines, n_freedoms)."""


def _compliance_slopes(
    found: Closure, bodies: JointedBodies, state: JointState, layout: BaseLayout
) -> dict[str, _Change]:
    """Return the slope of the joint compliances by each coordinate."""
    bolts, along = bodies.row_bolts, bodies.row_directions
    a, s = state.compliance, found.s[:, None]
    factor = (state.bolt * found.torque)[bolts]
    slopes: dict[str, _Change] = {}
    yielding = 1.0 + a * state.damping * s
    by_stiffness = -a / yielding**2
    by_damping = -(a**2) * state.damping * s / yielding**2
    for direction in layout.compliant:
        joints = np.flatnonzero(along == direction)
        change = by_stiffness[:, direction, None] / factor[joints]
        slopes[stiffness_name(direction)] = joints, change
    every = np.arange(bolts.size)
    normal, tangential = by_damping.copy(), by_damping.copy()
    normal[:, :NORMAL], tangential[:, NORMAL] = 0.0, 0.0
    by_name = {
        BaseName.TANGENTIAL_DAMPING: tangential,
        BaseName.NORMAL_DAMPING: normal,
    }
    for name, one in by_name.items():
        slopes[name] = every, one[:, along] / factor
    whole = (a / yielding)[:, along] / factor
    for k in range(layout.contrasts.shape[1]):
        slopes[bolt_name(k + 1)] = every, -whole * layout.contrasts[bolts, k]
    feet = bolts.size + np.arange(3 * len(bodies.feet))
    stiffness, damping = np.repeat(state.foot[0] * state.foot_factor, 3), state.foot[1]
    foot = -1.0 / (stiffness + damping * s) ** 2
    slopes[BaseName.FOOT] = feet, foot * stiffness
    slopes[BaseName.FOOT_DAMPING] = feet, foot * damping * s
    return slopes
