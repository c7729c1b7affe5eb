# SPDX-License-Identifier: MIT
"""Each body of a machine reduced once, then closed over joints and springs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
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
from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.analysis.structures.matrices.parts import GROUND
from jointbench.analysis.structures.matrices.structure import Structure, pick
from jointbench.analysis.structures.matrices.surface_motion import (
    motion_of_piece,
    rotated,
)
from jointbench.analysis.structures.reduction.assembled import (
    Assembled,
    assemble_components,
)
from jointbench.analysis.structures.reduction.component import (
    BodyMatrices,
    BodyPort,
    BodySource,
    Component,
    point_port,
)
from jointbench.analysis.structures.reduction.port_joints import PortJoint, Side
from jointbench.analysis.structures.reduction.reduce_body import reduce_body
from jointbench.analysis.structures.reduction.reduction_cache import (
    body_key,
    cached_component,
)
from jointbench.analysis.structures.reduction.structure_bodies import (
    body_matrices,
    body_ranges,
    range_of,
    structure_ports,
)

# Order of the polynomials of tractions on joint faces.
_ORDER = 3
# Stiffness of a rigid joint over that of the bodies at it.
_RIGID = 1e2
_RIGID_MARK = "rigid"
# Ports of coupled springs: roots of the stiffness matrix, then of the damping matrix.
_COUPLED, _MATRICES = " coupled", ("stiffness", "damping")
_MODES = 30
_BOX = (1e5, 1e11)


@dataclass(frozen=True, slots=True, eq=False)
class MachineBody:
    """A body in the coordinates of the assembly.

    Attributes:
        name: of the body; glued ones are joined by ``"+"``.
        place: its coordinates among those of the assembly, shape (r,).
        stiffness: of the body alone in them [1/s^2], shape (r, r).
        rigid: parts of the kinetic energy in three displacements and three rotations,
            see `orthonormal_motions`, shape (6, r).
        surfaces: for pictures, with names.
        motions: of the nodes of each surface, shape (3 n, r).
    """

    name: str
    place: IntArray
    stiffness: FloatArray
    rigid: FloatArray
    surfaces: tuple[tuple[str, Surface], ...]
    motions: tuple[FloatArray, ...]

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "place", "stiffness", "rigid")


@dataclass(frozen=True, slots=True, eq=False)
class ReducedMachine:
    """A machine over the coordinates of its reduced bodies.

    Attributes:
        assembled: bodies closed over joints.
        bodies: for energies, shapes and pictures.
        stiffness: nominal values [N/m, N m/rad], shape (n_parameters,).
        damping: nominal values, shape (n_parameters,).
        deviations: relative standard deviations of both, shape (2, n_parameters) [-].
        joints: with springs.
        rigid: stiffness that makes each joint rigid, zero otherwise; these parameters
            of the assembly follow the nominal ones, shape (n_joints,) [N/m].
        points: motion x, y, z of each point, shape (3, r), by name.
        freedoms: of the meshes and beams before the reduction.
    """

    assembled: Assembled
    bodies: tuple[MachineBody, ...]
    stiffness: FloatArray
    damping: FloatArray
    deviations: FloatArray
    joints: tuple[PortJoint, ...]
    rigid: FloatArray
    points: Mapping[str, FloatArray]
    freedoms: int

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "stiffness", "damping", "deviations", "rigid")

    @property
    def joint_of(self) -> IntArray:
        """Number of the joint of every nominal value, shape (n_parameters,)."""
        counts = [len(joint.directions) for joint in self.joints]
        return np.repeat(np.arange(len(counts)), counts)

    def parameters(
        self, stiffness: FloatArray, rigid: Sequence[int] = ()
    ) -> FloatArray:
        """Return the parameters of the assembly.

        Args:
            stiffness: of the joints, shape (n_parameters,).
            rigid: numbers of joints that are rigid.
        """
        held = np.zeros(self.rigid.size)
        held[list(rigid)] = self.rigid[list(rigid)]
        return np.concatenate([stiffness, held])


@dataclass(frozen=True, slots=True, eq=False)
class _Raw:
    """A body before its reduction: matrices, rigid motions, surfaces, ports."""

    matrices: BodyMatrices
    motions: FloatArray
    surfaces: tuple[tuple[str, Surface], ...]
    ports: list[BodyPort]


def reduce_machine(
    machine: Machine, band_hz: float, *, cache: Path | None = None
) -> ReducedMachine:
    """Reduce every body of a machine once and close them over their joints.

    Args:
        machine: its parts.
        band_hz: highest frequency of interest [Hz].
        cache: folder that keeps reduced bodies by content.

    Returns:
        The machine in reduced coordinates.

    Raises:
        BadData: a piece of a body has no nodes, a point is not on its body, a body
            cannot be factored.
    """
    raw, joints = _solids(machine)
    raw |= _beams(machine) | _rigid_parts(machine)
    extra = [_spring_joint(machine, raw, one) for one in machine.springs]
    point_of = {}
    for name in machine.points:
        body, rows = _point_rows(machine, name)
        raw[body].ports.append(point_port(f"point {name}", Sparse(rows[:3])))
        point_of[name] = (body, f"point {name}")
    every = (*joints, *extra)
    rigid = [_rigid_joint(raw, one) for one in every]
    components = [_reduced(one, band_hz, cache) for one in raw.values()]
    assembled = assemble_components(
        components, [*every, *rigid], box=_BOX, modes=_MODES
    )
    values = [_values(machine, one.name) for one in every]
    return ReducedMachine(
        assembled=assembled,
        bodies=tuple(
            _machine_body(one, component, place)
            for one, component, place in zip(
                raw.values(), components, assembled.places, strict=True
            )
        ),
        stiffness=np.concatenate([one[0] for one in values]),
        damping=np.concatenate([one[1] for one in values]),
        deviations=np.concatenate([one[2] for one in values], axis=1),
        joints=tuple(every),
        rigid=np.array([_rigid_value(raw, one) for one in every]),
        points={name: assembled.rows(side) for name, side in point_of.items()},
        freedoms=sum(one.matrices.mass.shape[0] for one in raw.values()),
    )


def _reduced(raw: _Raw, band_hz: float, cache: Path | None) -> Component:
    key = body_key(raw.matrices, raw.ports, band_hz)
    return cached_component(
        cache, key, lambda: reduce_body(raw.matrices, raw.ports, band_hz)
    )


def _solids(machine: Machine) -> tuple[dict[str, _Raw], tuple[PortJoint, ...]]:
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
        found[one.name] = _Raw(matrices, motions, surfaces, list(ports[one.name]))
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


def _beams(machine: Machine) -> dict[str, _Raw]:
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
        found[beam.name] = _Raw(
            matrices, motions, ((beam.name, beam_surface(beam)),), []
        )
    return found


def _rigid_parts(machine: Machine) -> dict[str, _Raw]:
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
        found[part.name] = _Raw(matrices, np.eye(6), surfaces, [])
    return found


def _spring_joint(
    machine: Machine, raw: dict[str, _Raw], spring: MachineSpring
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
            port += _COUPLED
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


def _point_rows(machine: Machine, name: str) -> tuple[str, Sparse]:
    point = machine.points[name]
    carried = _carried(machine, point.body, point.position)
    if carried is not None:
        return point.body, carried
    structure = machine.structure
    where = range_of(structure, point.body)
    rows = pick(structure, point.body, point.position)
    return where.name, Sparse(rows[:, where.low : where.high])


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


def _values(machine: Machine, name: str) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return stiffness, damping and both deviations of a joint or spring.

    Coupled matrices are multiplied by one.
    """
    if name in machine.settings:
        one = machine.settings[name]
        stiffness, damping = np.array(one.stiffness), np.array(one.damping)
        deviations = (one.stiffness_sd, one.damping_sd)
    else:
        spring = next(s for s in machine.springs if s.name == name)
        stiffness, damping = np.array(spring.stiffness), np.array(spring.damping)
        if spring.matrices is not None:
            stiffness, damping = np.array([1.0, 0.0]), np.array([0.0, 1.0])
        deviations = spring.deviations
    return stiffness, damping, np.outer(deviations, np.ones(stiffness.size))


def _rigid_joint(raw: dict[str, _Raw], joint: PortJoint) -> PortJoint:
    """Return a joint of one parameter that holds what the basis can follow.

    A rigid face holds the moments of its patterns, not every point: to hold points that
    the basis cannot move apart would stiffen the bodies.
    """
    sides: list[Side] = []
    for side in _plain_sides(joint):
        port = _port(raw, side)
        rows = Sparse(_commensurate(port).T @ port.rows)
        name = f"{side[1]} {_RIGID_MARK}"
        raw[side[0]].ports.append(point_port(name, rows))
        sides.append((side[0], name))
    second = sides[1] if len(sides) > 1 else None
    return PortJoint(f"{joint.name} {_RIGID_MARK}", sides[0], second, (_RIGID_MARK,))


def _plain_sides(joint: PortJoint) -> list[Side]:
    """Return the ports of a joint whose rows are motions."""
    sides = [joint.first] if joint.second is None else [joint.first, joint.second]
    return [(body, port.removesuffix(_COUPLED)) for body, port in sides]


def _port(raw: dict[str, _Raw], side: Side) -> BodyPort:
    return next(one for one in raw[side[0]].ports if one.name == side[1])


def _commensurate(port: BodyPort) -> FloatArray:
    """Return patterns, with rotations of a piece times its arm [m]."""
    if port.rows.shape[0] != len(SPRING_DIRECTIONS):
        return port.patterns
    size = np.sqrt(np.asarray(port.rows.multiply(port.rows).sum(axis=1)).ravel())
    arm = size[:3].max() / max(size[3:].max(), 1e-300)
    return np.diag([1.0, 1.0, 1.0, arm, arm, arm])


def _rigid_value(raw: dict[str, _Raw], joint: PortJoint) -> float:
    """Return a stiffness that is rigid compared with the bodies at a joint [N/m].

    Estimated from the stiffness of the nodes of a port: for a face the sum over its
    nodes, for a piece that moves as a whole that of its nodes together.
    """
    found = [1.0]
    for side in _plain_sides(joint):
        rows = _port(raw, side).rows[: _port(raw, side).rows.shape[0] // 2]
        own = raw[side[0]].matrices.stiffness.diagonal()
        weight = np.asarray(rows.multiply(rows).sum(axis=0)).ravel()
        whole = rows.shape[0] == len(SPRING_DIRECTIONS) // 2
        scale = weight.sum() ** 2 if whole else weight @ weight
        found.append(float(weight @ own / max(scale, 1e-300)))
    return _RIGID * max(found)


def _machine_body(raw: _Raw, component: Component, place: IntArray) -> MachineBody:
    mass = raw.matrices.mass
    rows = np.asarray(mass @ orthonormal_motions(raw.motions, mass)).T
    return MachineBody(
        name=component.name,
        place=place,
        stiffness=component.stiffness,
        rigid=rows @ component.basis,
        surfaces=raw.surfaces,
        motions=tuple(one.rows @ component.basis for _, one in raw.surfaces),
    )
