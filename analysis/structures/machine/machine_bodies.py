# SPDX-License-Identifier: MIT
"""Bodies of a machine before their reduction: matrices, ports and surfaces."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.analysis.structures.machine.body_geometry import (
    Surface,
    beam_surface,
    node_motions,
    orthonormal_motions,
    rigid_surface,
    solid_surface,
)
from jointbench.analysis.structures.machine.machine_parts import (
    SPRING_DIRECTIONS,
    Machine,
    MachineSpring,
)
from jointbench.analysis.structures.machine.measured_parts import MachineLink
from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.analysis.structures.matrices.parts import GROUND
from jointbench.analysis.structures.matrices.structure import Structure, pick
from jointbench.analysis.structures.matrices.surface_motion import (
    motion_of_piece,
    rotated,
)
from jointbench.analysis.structures.reduction.component import (
    BodyMatrices,
    BodyPort,
    BodySource,
    point_port,
)
from jointbench.analysis.structures.reduction.port_joints import PortJoint, Side
from jointbench.analysis.structures.reduction.structure_bodies import (
    body_matrices,
    body_ranges,
    range_of,
    structure_ports,
)

# Order of the polynomials of tractions on joint faces.
_ORDER = 3
# Ports of coupled springs: roots of the stiffness matrix, then of the damping matrix.
COUPLED = " coupled"
_MATRICES = ("stiffness", "damping")


@dataclass(frozen=True, slots=True, eq=False)
class RawBody:
    """A body before its reduction: matrices, rigid motions, surfaces, ports.

    `gyroscopic` is that of a turn about its axis at 1 rad/s; None is none.
    """

    matrices: BodyMatrices
    motions: FloatArray
    surfaces: tuple[tuple[str, Surface], ...]
    ports: list[BodyPort]
    gyroscopic: Sparse | None = None


def solid_bodies(machine: Machine) -> tuple[dict[str, RawBody], tuple[PortJoint, ...]]:
    """Return the meshed bodies by name, and the joints of their surfaces."""
    structure = machine.structure
    ports, joints = structure_ports(structure, _ORDER)
    found = {}
    for one in body_ranges(structure):
        matrices = body_matrices(structure, one)
        used = structure.free[one.low : one.high]
        numbers = [
            at
            for at, low in enumerate(structure.blocks[:-1])
            if one.low <= low < one.high
        ]
        motions = node_motions(structure.nodes, turns=False)[used]
        surfaces = tuple(_surface_within(structure, at, used) for at in numbers)
        found[one.name] = RawBody(matrices, motions, surfaces, list(ports[one.name]))
    return found, joints


def _surface_within(
    structure: Structure, at: int, used: IntArray
) -> tuple[str, Surface]:
    """Return the surface of a solid with rows over the free freedoms of its range."""
    body = structure.bodies[at]
    own = solid_surface(body.mesh)
    begin, total = 3 * int(structure.first_node[at]), 3 * int(structure.first_node[-1])
    wide = Sparse(
        (own.rows.data, own.rows.indices + begin, own.rows.indptr),
        shape=(own.rows.shape[0], total),
    )
    return body.name, Surface(own.nodes, own.triangles, Sparse(wide[:, used]))


def beam_bodies(machine: Machine) -> dict[str, RawBody]:
    """Return the beams by name."""
    found = {}
    for beam in machine.beams:
        motions = node_motions(beam.nodes, turns=True)
        rigid = orthonormal_motions(motions, beam.mass)
        matrices = BodyMatrices(
            beam.name,
            beam.stiffness,
            beam.mass,
            rigid=rigid,
            loss_factor=beam.loss_factor,
            source=BodySource.MATRICES,
        )
        found[beam.name] = RawBody(
            matrices,
            motions,
            ((beam.name, beam_surface(beam)),),
            [],
            beam.gyroscopic,
        )
    return found


def rigid_bodies(machine: Machine) -> dict[str, RawBody]:
    """Return the rigid bodies by name."""
    found = {}
    for part in machine.rigid:
        weight = np.array([*[part.mass] * 3, *part.inertia])
        matrices = BodyMatrices(
            part.name,
            Sparse(np.zeros((6, 6))),
            Sparse(np.diag(weight)),
            rigid=np.diag(1.0 / np.sqrt(weight)),
        )
        surfaces = ((part.name, rigid_surface(part)),)
        found[part.name] = RawBody(
            matrices, np.eye(6), surfaces, [], Sparse(part.gyroscopic)
        )
    return found


def spring_joint(
    machine: Machine, raw: dict[str, RawBody], spring: MachineSpring
) -> PortJoint:
    """Add the ports of a spring to its bodies and return the joint."""
    sides: list[Side] = []
    for number, name in enumerate(spring.between):
        if name == GROUND:
            continue
        body, rows = _piece_rows(machine, spring, number)
        port = f"{spring.name}/{number + 1}"
        plain = rotated(rows, spring.axis)
        raw[body].ports.append(point_port(port, plain))
        if spring.matrices is not None:
            port += COUPLED
            roots = np.concatenate([_root(one) for one in spring.matrices])
            raw[body].ports.append(point_port(port, Sparse(Sparse(roots) @ plain)))
        sides.append((body, port))
    second = sides[1] if len(sides) > 1 else None
    directions = SPRING_DIRECTIONS if spring.matrices is None else _MATRICES
    return PortJoint(spring.name, sides[0], second, directions)


def _root(matrix: FloatArray) -> FloatArray:
    """Return R with R'R = matrix, shape (6, 6)."""
    value, vector = np.linalg.eigh(matrix)
    return np.asarray(np.sqrt(np.maximum(value, 0.0))[:, None] * vector.T)


def _piece_rows(
    machine: Machine, spring: MachineSpring, number: int
) -> tuple[str, Sparse]:
    """Return the name of the reduced body and the six motions of a piece of it."""
    name, piece = spring.between[number], spring.pieces[number]
    other = _carried(machine, name, spring.pieces[0].position)
    if other is not None:
        return name, other
    structure = machine.structure
    at = [one.name for one in structure.bodies].index(name)
    rows = motion_of_piece(name, structure.bodies[at].mesh, piece)
    return _within(structure, at, rows)


def rows_of_point(machine: Machine, name: str) -> tuple[str, Sparse]:
    """Return the body of a point, and the rows of its six motions."""
    point = machine.points[name]
    return _rows_of_position(machine, point.body, point.position)


def _rows_of_position(
    machine: Machine, body: str, position: tuple[float, float, float]
) -> tuple[str, Sparse]:
    carried = _carried(machine, body, position)
    if carried is not None:
        return body, carried
    where = range_of(machine.structure, body)
    rows = pick(machine.structure, body, position)
    return where.name, Sparse(rows[:, where.low : where.high])


def link_joint(
    machine: Machine, raw: dict[str, RawBody], link: MachineLink
) -> PortJoint:
    """Add the port of a link to its modelled body and return the joint."""
    second: Side | None = link.second
    if link.second is not None and link.position is not None:
        body, rows = _rows_of_position(machine, link.second[0], link.position)
        along = np.asarray(link.direction) / np.linalg.norm(link.direction)
        port = f"{link.name}/2"
        own = Sparse(Sparse(along[None]) @ rows[:3])
        raw[body].ports.append(point_port(port, own))
        second = (body, port)
    return PortJoint(link.name, link.first, second, ("along",))


def _carried(
    machine: Machine, name: str, position: tuple[float, float, float]
) -> Sparse | None:
    """Return the six motions of a point of a beam or a rigid body."""
    for beam in machine.beams:
        if beam.name == name:
            return beam.motion_at(position)
    for part in machine.rigid:
        if part.name == name:
            arm = np.asarray(position) - np.asarray(part.position)
            rows = np.eye(6)
            rows[:3, 3:] = np.stack([np.cross(one, arm) for one in np.eye(3)], axis=1)
            return Sparse(rows)
    return None


def _within(structure: Structure, at: int, rows: Sparse) -> tuple[str, Sparse]:
    """Return rows over the free degrees of freedom of the range of a solid."""
    where = range_of(structure, structure.bodies[at].name)
    begin, total = 3 * int(structure.first_node[at]), 3 * int(structure.first_node[-1])
    wide = Sparse(
        (rows.data, rows.indices + begin, rows.indptr), shape=(rows.shape[0], total)
    )
    return where.name, Sparse(wide[:, structure.free[where.low : where.high]])
