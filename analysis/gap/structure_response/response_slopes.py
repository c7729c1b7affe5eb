# SPDX-License-Identifier: MIT
"""Slopes of the records of hits by the base coordinates, on a damped Laplace line.

Every slope of a closed response is a sum of products of two fields: one of a unit force
at a sensor, one of the hit. Of a compliance z it is the product of the forces across
the joint, dH/dz_j = f_j g_j; of a free mode the product of its motions times the slope
of its receptance; of a tuned mode that of its motions times its stiffness. The fields
of a hit are summed over its force columns, so none of its slopes sums over them again.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, IntArray
from jointbench.analysis.gap.structure_response.base_layout import (
    BaseLayout,
    BaseName,
    bolt_name,
    loss_name,
    mass_name,
    modulus_name,
    stiffness_name,
)
from jointbench.analysis.gap.structure_response.closed_response import (
    closed_forces,
    modal_receptances,
)
from jointbench.analysis.gap.structure_response.joint_state import JointState
from jointbench.analysis.gap.structure_response.jointed_bodies import (
    NORMAL,
    JointedBodies,
)
from jointbench.analysis.gap.structure_response.line_forces import (
    Planes,
    multiplied,
    summed_products,
)


@dataclass(frozen=True, slots=True, eq=False)
class ClosedAt:
    """What closes the joints of some records, and on which lines.

    Attributes:
        bodies: modes and rows.
        state: of the model at the torque.
        s: Laplace variable, shape (n_lines,).
        torque: factor of the torque on stiffness and damping of the bolts [-].
    """

    bodies: JointedBodies
    state: JointState
    s: ComplexArray
    torque: float


@dataclass(frozen=True, slots=True, eq=False)
class HitsOnModes:
    """Forces of hits, and of laws at ports, on the modes.

    Attributes:
        columns: distinct force columns of hits in modes, shape (n_columns, n_modes).
        column_of: column of each record, shape (n_records,).
        force: transformed forces [N], shape (n_records, n_lines).
        ports: rows of the ports of laws in modes, shape (n_ports, n_modes).
        laws: transformed forces across them, shape (n_records, n_ports, n_lines); None
            without laws.
    """

    columns: FloatArray
    column_of: IntArray
    force: ComplexArray
    ports: FloatArray
    laws: ComplexArray | None


@dataclass(frozen=True, slots=True, eq=False)
class _Term:
    """The sum of products that is the slope by one coordinate.

    Attributes:
        left: fields of the sensors, shape (n,).
        right: fields of the hits by which they are multiplied, shape (n,).
        weights: of the products, shape (n, n_lines) or (n, 1).
    """

    left: IntArray
    right: IntArray
    weights: ComplexArray


@dataclass(frozen=True, slots=True, eq=False)
class RecordSlopes:
    """Slopes of records by base coordinates.

    Attributes:
        left: fields of the sensors, in the units of their channels, shape
            (n_fields, n_channels, n_lines).
        right: real and imaginary parts of the fields of hits, and of other columns,
            shape (n_fields, n_columns, n_lines).
        column_of: column of each record, shape (n_records,).
        force: factor of each record on its column, shape (n_records, n_lines).
        terms: by coordinate.
    """

    left: ComplexArray
    right: Planes
    column_of: IntArray
    force: ComplexArray
    terms: dict[str, _Term]

    def write(self, name: str, records: IntArray, found: ComplexArray) -> None:
        """Write the transformed slopes by a coordinate.

        Args:
            name: of the coordinate.
            records: places of these records among all, shape (n_records,).
            found: of all, shape (n_all_records, n_channels, n_lines or more).
        """
        term = self.terms[name]
        left = self.left[term.left] * term.weights[:, None]
        planes = np.ascontiguousarray(left.real), np.ascontiguousarray(left.imag)
        own = records, self.column_of, self.force
        summed_products(planes, self.right, term.right, own, found)


def record_slopes(
    at: ClosedAt, hits: HitsOnModes, transfers: ComplexArray, layout: BaseLayout
) -> RecordSlopes:
    """Return the slopes of records by each base coordinate.

    Args:
        at: what closes the joints.
        hits: forces on the modes.
        transfers: from displacement to channels, shape (n_lines, n_channels).
        layout: base coordinates.
    """
    sensors = at.state.sensors_of(at.bodies)
    fields = _fields(at, np.concatenate([sensors, hits.columns, hits.ports]))
    count = len(sensors)
    left = (fields[0][:, :count] + 1j * fields[1][:, :count]) * transfers.T
    right, column_of, force = fields, hits.column_of + count, hits.force
    if hits.laws is not None:
        own = fields[0][:, count:], fields[1][:, count:]
        right = _with_laws(own, hits, hits.laws)
        column_of, force = np.arange(len(force)), np.ones_like(force)
    return RecordSlopes(left, right, column_of, force, _terms(at, layout))


def _with_laws(fields: Planes, hits: HitsOnModes, laws: ComplexArray) -> Planes:
    """Return the fields of each record with the forces of laws.

    Args:
        fields: of force columns, then of ports, shape
            (n_fields, n_columns + n_ports, n_lines).
        hits: forces of the hammer.
        laws: forces across the ports, shape (n_records, n_ports, n_lines).

    Returns:
        Shape (n_fields, n_records, n_lines).
    """
    shape = len(fields[0]), *hits.force.shape
    found = np.empty(shape), np.empty(shape)
    count = len(hits.columns)
    # Field by field: of all together, complex copies would be twice as large as these.
    for k, (re, im) in enumerate(zip(*fields, strict=True)):
        own = re + 1j * im
        moved = own[hits.column_of] * hits.force
        moved -= np.einsum("pl,rpl->rl", own[count:], laws)
        found[0][k], found[1][k] = moved.real, moved.imag
    return found


def _fields(at: ClosedAt, columns: FloatArray) -> Planes:
    """Return the fields of force columns: (n_fields, n_columns, n_lines).

    They are the forces across the joints, the motions of the free modes per modal
    receptance, and the motions of tuned modes.
    """
    found = closed_forces(at.bodies, at.state, at.s, columns, at.torque)
    tuned = at.state.tuned
    joints, modes = found.joints, at.bodies.omega.size
    places = np.zeros((0, modes)) if tuned is None else tuned.rows
    shape = joints + modes + len(places), len(columns), at.s.size
    fields = np.empty(shape), np.empty(shape)
    d = np.ascontiguousarray(modal_receptances(at.bodies, at.state, at.s).T)
    for own, part in zip(fields, found.planes, strict=True):
        own[:joints] = part[:joints]
        flat = own.reshape(len(own), -1)[joints : joints + modes]
        np.matmul(-found.rows.T, part.reshape(len(part), -1), out=flat)
    own_modes = slice(joints, joints + modes)
    moving = fields[0][own_modes], fields[1][own_modes]
    np.add(moving[0], columns.T[:, :, None], out=moving[0])
    if len(places):
        for own, part in zip(fields, multiplied(moving, d), strict=True):
            flat = own.reshape(len(own), -1)[joints + modes :]
            np.matmul(places, part.reshape(modes, -1), out=flat)
    return fields


def _terms(at: ClosedAt, layout: BaseLayout) -> dict[str, _Term]:
    """Return the products whose sums are the slopes, by coordinate."""
    joints = len(at.bodies.joint_rows)
    return (
        _joint_terms(at, layout)
        | _modal_terms(at, joints)
        | _tuned_terms(at, layout, joints + at.bodies.omega.size)
    )


def _modal_terms(at: ClosedAt, first: int) -> dict[str, _Term]:
    """Return the products by modulus, mass and damping ratio of each body.

    Args:
        at: what closes the joints.
        first: field of the first mode.
    """
    bodies, state = at.bodies, at.state
    omega, s = state.omega(bodies), at.s[:, None]
    d = modal_receptances(bodies, state, at.s)
    square = -(d**2) * state.mass[bodies.body]
    loss = state.loss[bodies.body]
    by_loss = square * 2.0 * loss * omega * s
    by_modulus = square * (loss * omega * s + omega**2)
    found: dict[str, _Term] = {}
    for k, name in enumerate(bodies.bodies):
        own = np.flatnonzero(bodies.body == k)
        for word, change in (
            (modulus_name(name), by_modulus),
            (loss_name(name), by_loss),
            (mass_name(name), -d),
        ):
            found[word] = _Term(first + own, first + own, change[:, own].T)
    return found


def _tuned_terms(at: ClosedAt, layout: BaseLayout, first: int) -> dict[str, _Term]:
    """Return the products by the frequencies and couplings of closed modes.

    Args:
        at: what closes the joints.
        layout: base coordinates.
        first: field of the first tuned mode.
    """
    tuned = at.state.tuned
    if layout.tuned is None or tuned is None:
        return {}
    found: dict[str, _Term] = {}
    own = zip(layout.tuned.names, tuned.ends, tuned.slope, strict=True)
    for name, (i, j), slope in own:
        ends = np.array([i] if i == j else [i, j]) + first
        weights = np.full((len(ends), 1), complex(-slope))
        found[name] = _Term(ends, ends[::-1].copy(), weights)
    return found


def _joint_terms(at: ClosedAt, layout: BaseLayout) -> dict[str, _Term]:
    """Return the products by stiffness and damping of joints and feet."""
    bodies, state = at.bodies, at.state
    bolts, along = bodies.row_bolts, bodies.row_directions
    a, s = state.compliance, at.s[:, None]
    factor = (state.bolt * at.torque)[bolts]
    found: dict[str, _Term] = {}
    yielding = 1.0 + a * state.damping * s
    by_stiffness = -a / yielding**2
    by_damping = -(a**2) * state.damping * s / yielding**2
    for direction in layout.compliant:
        joints = np.flatnonzero(along == direction)
        change = by_stiffness[:, direction, None] / factor[joints]
        found[stiffness_name(direction)] = _moved(joints, change)
    every = np.arange(bolts.size)
    normal, tangential = by_damping.copy(), by_damping.copy()
    normal[:, :NORMAL], tangential[:, NORMAL] = 0.0, 0.0
    found[BaseName.TANGENTIAL_DAMPING] = _moved(every, tangential[:, along] / factor)
    found[BaseName.NORMAL_DAMPING] = _moved(every, normal[:, along] / factor)
    whole = (a / yielding)[:, along] / factor
    for k in range(layout.contrasts.shape[1]):
        found[bolt_name(k + 1)] = _moved(every, -whole * layout.contrasts[bolts, k])
    feet = bolts.size + np.arange(3 * len(bodies.feet))
    stiffness, damping = np.repeat(state.foot[0] * state.foot_factor, 3), state.foot[1]
    foot = -1.0 / (stiffness + damping * s) ** 2
    found[BaseName.FOOT] = _moved(feet, foot * stiffness)
    found[BaseName.FOOT_DAMPING] = _moved(feet, foot * damping * s)
    return found


def _moved(joints: IntArray, change: ComplexArray) -> _Term:
    """Return the products of the joints whose compliance changes.

    Args:
        joints: freedoms, shape (n,).
        change: of their compliance, shape (n_lines, n).
    """
    moving = change.any(axis=0)
    own = joints[moving]
    return _Term(own, own, np.ascontiguousarray(change[:, moving].T))
