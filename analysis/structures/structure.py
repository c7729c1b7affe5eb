# SPDX-License-Identifier: MIT
"""Bodies, supports and joints, and the matrices that they make together.

K(theta) = K + sum theta_d G_d: theta_d is a TOTAL stiffness [N/m] of one joint in one
direction, spread consistently over its area; C likewise. K alone is block diagonal.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

import numpy as np
from scipy import sparse

from jointbench.acquisition.arrays import BoolArray, FloatArray, IntArray, freeze
from jointbench.acquisition.errors import BadData, UsageError
from jointbench.analysis.structures.assembly import Material, Sparse, assemble
from jointbench.analysis.structures.interface import (
    ContactPoints,
    Plane,
    contact_points,
    face_plane,
    interpolation,
    relative_motion,
    shared_planes,
    spread_springs,
)
from jointbench.analysis.structures.mesh import Mesh
from jointbench.analysis.structures.polygons import Patch

GROUND = "ground"
DIRECTIONS = ("normal", "tangential_1", "tangential_2")
"""Directions of a joint; tangents follow the global axes in the plane, in order."""


class SupportKind(StrEnum):
    """How a face is held."""

    FIXED = "fixed"
    SPRINGS = "springs"


@dataclass(frozen=True, slots=True)
class Support:
    """A face of a body held by the ground.

    Attributes:
        body: name.
        face: axis and side, for example ``"z-"``.
        kind: fixed, or on springs.
        stiffness: totals [N/m]: normal, tangential 1 and 2; for springs only.
    """

    body: str
    face: str
    kind: SupportKind = SupportKind.FIXED
    stiffness: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class PointMass:
    """A small mass that rides on a body: an accelerometer, a hammer tip.

    Attributes:
        body: name.
        position: [m], within or next to the body; the nearest node takes it.
        mass: [kg].
    """

    body: str
    position: tuple[float, float, float]
    mass: float


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """A meshed body.

    Attributes:
        name: of the body.
        mesh: its elements.
        stiffness: K [N/m], shape (3 n_nodes, 3 n_nodes).
        mass: M [kg], same shape.
        loss_factor: of its material [-].
    """

    name: str
    mesh: Mesh
    stiffness: Sparse
    mass: Sparse
    loss_factor: float = 0.0

    def __post_init__(self) -> None:
        """Check that the matrices belong to the mesh."""
        wanted = 3 * self.mesh.nodes.shape[0]
        for name, matrix in (("stiffness", self.stiffness), ("mass", self.mass)):
            if matrix.shape != (wanted, wanted):
                raise BadData(
                    f"{name} of body {self.name!r} has shape {matrix.shape}, its mesh "
                    f"asks for ({wanted}, {wanted}): three numbers a node"
                )


def solid_body(name: str, mesh: Mesh, material: Material) -> Body:
    """Return a body of one material; see `assemble`."""
    stiffness, mass = assemble(mesh, material)
    return Body(name, mesh, stiffness, mass, material.loss_factor)


@dataclass(frozen=True, slots=True)
class Joint:
    """Where two bodies, or a body and the ground, touch.

    Attributes:
        name: of the joint.
        between: two bodies, or a body and ``"ground"``.
        patches: parts of the plane that touch, in global coordinates along the two
            tangents; none means all that the faces share.
        face: of the first body, ``"z+"`` for example; left out, the planes where the
            two bodies look at each other; the ground needs one.
        glued: held together, whatever the parameters: it has none.
    """

    name: str
    between: tuple[str, str]
    patches: tuple[Patch, ...] = ()
    face: str | None = None
    glued: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Structure:
    """The matrices of bodies and joints over the degrees of freedom that are free.

    Attributes:
        bodies: in order.
        stiffness: of bodies and springs of supports, block diagonal [N/m], shape
            (n_free, n_free).
        mass: block diagonal, with point masses [kg].
        loss: loss factor times stiffness, block diagonal [N/m].
        spread: G of every joint and direction, joint by joint, total 1 N/m.
        glue: stiffness of glued joints [N/m]; zero if there are none.
        joints: names of the joints that have parameters.
        area: of these joints [m^2], shape (n_joints,).
        frames: rows normal and tangents, shape (n_joints, 3, 3).
        blocks: where the degrees of freedom of each body begin, and the end, shape
            (n_bodies + 1,).
        free: place of each free degree of freedom among all, shape (n_free,).
        first_node: of each body among all nodes, shape (n_bodies + 1,).
    """

    bodies: tuple[Body, ...]
    stiffness: Sparse
    mass: Sparse
    loss: Sparse
    spread: tuple[Sparse, ...]
    glue: Sparse
    joints: tuple[str, ...]
    area: FloatArray
    frames: FloatArray
    blocks: IntArray
    free: IntArray
    first_node: IntArray = field(default_factory=lambda: np.zeros(1, np.int64))

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "area", "frames", "blocks", "free", "first_node")

    @property
    def size(self) -> int:
        """Number of free degrees of freedom."""
        return int(self.free.size)

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """``"<joint>.<direction>"`` in the order of `spread`."""
        return tuple(f"{j}.{d}" for j in self.joints for d in DIRECTIONS)

    @property
    def nodes(self) -> FloatArray:
        """Coordinates of all nodes, body by body [m], shape (n_nodes, 3)."""
        return np.concatenate([body.mesh.nodes for body in self.bodies])

    def with_joints(self, stiffness: FloatArray) -> Sparse:
        """Return K(theta) [N/m] for total stiffnesses, shape (3 n_joints,)."""
        total = self.stiffness + self.glue
        for value, spread in zip(stiffness, self.spread, strict=True):
            total = total + float(value) * spread
        return Sparse(total)


def build_structure(
    bodies: Sequence[Body],
    joints: Sequence[Joint],
    *,
    supports: Sequence[Support] = (),
    masses: Sequence[PointMass] = (),
) -> Structure:
    """Put bodies, joints, supports and small masses together.

    Args:
        bodies: with different names.
        joints: with different names.
        supports: of faces of bodies.
        masses: that ride on bodies.

    Returns:
        The structure.

    Raises:
        BadData: a joint touches nothing.
        UsageError: a name is unknown or given twice.
    """
    names = [body.name for body in bodies]
    _require_names(names, joints, supports, masses)
    first_node = np.cumsum([0] + [body.mesh.nodes.shape[0] for body in bodies])
    build = _Build(tuple(bodies), first_node.astype(np.int64))
    k = sparse.block_diag([body.stiffness for body in bodies], format="csr")
    loss = [body.loss_factor * body.stiffness for body in bodies]
    m = sparse.block_diag([body.mass for body in bodies], format="csr")
    m = m + sparse.diags_array(_point_masses(build, masses))
    held = np.zeros(m.shape[0], bool)
    for support in supports:
        if support.kind is SupportKind.FIXED:
            held |= _held(build, support)
        else:
            k = k + _support_springs(build, support)
    free = np.flatnonzero(~held).astype(np.int64)
    spread, glue, area, frames = _joint_matrices(build, joints, free, k.shape)
    return Structure(
        bodies=tuple(bodies),
        stiffness=_kept(k, free),
        mass=_kept(m, free),
        loss=_kept(sparse.block_diag(loss, format="csr"), free),
        spread=tuple(spread),
        glue=glue,
        joints=tuple(joint.name for joint in joints if not joint.glued),
        area=np.array(area),
        frames=np.array(frames).reshape(-1, 3, 3),
        blocks=np.searchsorted(free, 3 * first_node).astype(np.int64),
        free=free,
        first_node=first_node.astype(np.int64),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Build:
    """Bodies and where their nodes begin."""

    bodies: tuple[Body, ...]
    first_node: IntArray

    def place(self, name: str) -> int:
        return [body.name for body in self.bodies].index(name)


def _kept(matrix: Any, free: IntArray) -> Sparse:
    whole = Sparse(matrix)
    return whole if free.size == whole.shape[0] else Sparse(whole[free][:, free])


# A glued joint is a spring so many times stiffer than the softer body behind it.
_GLUE = 3e5


def _joint_matrices(
    build: _Build, joints: Sequence[Joint], free: IntArray, shape: tuple[int, ...]
) -> tuple[list[Sparse], Sparse, list[float], list[FloatArray]]:
    spread: list[Sparse] = []
    glue = Sparse((free.size, free.size))
    area, frames = [], []
    for joint in joints:
        springs, points, frame = _joint_springs(build, joint)
        kept = [_kept(one, free) for one in springs]
        if joint.glued:
            stiffness = _GLUE * _body_stiffness(build, joint, points.area)
            glue = Sparse(glue + stiffness * (kept[0] + kept[1] + kept[2]))
            continue
        spread += kept
        area.append(points.area)
        frames.append(frame)
    return spread, glue, area, frames


def _body_stiffness(build: _Build, joint: Joint, area: float) -> float:
    """Return E A / L of the bodies of a joint, from the trace of their stiffness."""
    values: list[float] = []
    for name in joint.between:
        if name == GROUND:
            continue
        body = build.bodies[build.place(name)]
        # A node's own stiffness is about E times the size of its element.
        modulus_length = float(np.median(body.stiffness.diagonal()))
        step = (np.ptp(body.mesh.nodes, axis=0).prod() / len(body.mesh.cells)) ** (
            1 / 3
        )
        values.append(float(modulus_length / step * area / body.mesh.size))
    return min(values)


def _joint_springs(
    build: _Build, joint: Joint
) -> tuple[tuple[Sparse, ...], ContactPoints, FloatArray]:
    """Return G for the three directions of a joint over all degrees of freedom."""
    first = build.bodies[build.place(joint.between[0])]
    on_ground = joint.between[1] == GROUND
    second = None if on_ground else build.bodies[build.place(joint.between[1])]
    found = []
    for plane in _planes(joint, first.mesh, second.mesh if second else None):
        mesh = second.mesh if second else None
        points = contact_points(first.mesh, mesh, plane, joint.patches)
        if points.weight.size:
            found.append((plane, points))
    if len(found) != 1:
        raise BadData(_no_single_plane(joint, len(found)))
    plane, points = found[0]
    motions = relative_motion(first.mesh, second.mesh if second else None, points)
    total = int(build.first_node[-1])
    motion = _placed(motions[0], build, joint.between[0], total)
    if motions[1] is not None:
        motion = Sparse(motion - _placed(motions[1], build, joint.between[1], total))
    return spread_springs(motion, points, plane.frame), points, plane.frame


def _planes(joint: Joint, first: Mesh, second: Mesh | None) -> list[Plane]:
    if joint.face is not None:
        return [face_plane(first, joint.face)]
    if second is None:
        raise UsageError(
            f"joint {joint.name!r} stands on the ground; say on which face, e.g. 'z-'"
        )
    return shared_planes(first, second)


def _no_single_plane(joint: Joint, count: int) -> str:
    if count:
        return (
            f"joint {joint.name!r}: bodies {joint.between} touch in {count} planes; "
            "name the face of the first body, for example face = 'z+'"
        )
    return (
        f"joint {joint.name!r} touches nothing: no face of {joint.between[0]!r} and "
        f"{joint.between[1]!r} share an area where its patches are; check positions, "
        "units and patches"
    )


def _placed(motion: Sparse, build: _Build, name: str, total: int) -> Sparse:
    """Return a matrix of one body's nodes as one of all nodes."""
    begin = int(build.first_node[build.place(name)])
    columns = motion.indices + begin
    return Sparse((motion.data, columns, motion.indptr), shape=(motion.shape[0], total))


def _support_springs(build: _Build, support: Support) -> Sparse:
    joint = Joint(
        f"support of {support.body}", (support.body, GROUND), face=support.face
    )
    springs, _, _ = _joint_springs(build, joint)
    total = Sparse(springs[0].shape)
    for value, spring in zip(support.stiffness, springs, strict=True):
        total = Sparse(total + value * spring)
    return total


def _held(build: _Build, support: Support) -> BoolArray:
    """Return which degrees of freedom a fixed support holds."""
    at = build.place(support.body)
    mesh = build.bodies[at].mesh
    plane = face_plane(mesh, support.face)
    points = contact_points(mesh, None, plane)
    if not points.weight.size:
        raise BadData(
            f"support of {support.body!r}: face {support.face!r} has no flat area"
        )
    behind = np.unique(mesh.cells[points.first])
    height = mesh.nodes[behind] @ plane.frame[0] - plane.offset
    nodes = behind[np.abs(height) <= 1e-6 * mesh.size] + build.first_node[at]
    held = np.zeros(3 * int(build.first_node[-1]), bool)
    held[(3 * nodes[:, None] + np.arange(3)).ravel()] = True
    return held


def _point_masses(build: _Build, masses: Sequence[PointMass]) -> FloatArray:
    diagonal = np.zeros(3 * int(build.first_node[-1]))
    for one in masses:
        if not one.mass >= 0:
            raise BadData(f"a point mass of {one.mass:g} kg; it must not be negative")
        at = build.place(one.body)
        node = nearest_node(build.bodies[at].mesh, one.position)
        diagonal[3 * (node + int(build.first_node[at])) + np.arange(3)] += one.mass
    return diagonal


def nearest_node(mesh: Mesh, position: Sequence[float]) -> int:
    """Return the node nearest to a position.

    Raises:
        BadData: the position is further from every node than the elements are large.
    """
    used = np.unique(mesh.cells)
    distance = np.linalg.norm(mesh.nodes[used] - np.asarray(position, float), axis=1)
    best = int(np.argmin(distance))
    corner = mesh.nodes[mesh.cells[:, :4]]
    edge = float(np.linalg.norm(corner[:, 1] - corner[:, 0], axis=1).max())
    if distance[best] > edge:
        raise BadData(
            f"position {tuple(position)} m lies {distance[best]:.3g} m from the "
            "nearest node of its body; check the unit and the origin"
        )
    return int(used[best])


def pick(structure: Structure, body: str, position: Sequence[float]) -> Sparse:
    """Return the motion x, y, z of a point of a body from the free degrees of freedom.

    Args:
        structure: that the body belongs to.
        body: its name.
        position: of the point [m]; between nodes it is interpolated.

    Returns:
        Shape (3, n_free).

    Raises:
        BadData: the point does not lie on the body.
        UsageError: there is no such body.
    """
    names = [one.name for one in structure.bodies]
    if body not in names:
        raise UsageError(f"no body {body!r}; the structure has {names}")
    at = names.index(body)
    mesh = structure.bodies[at].mesh
    values = _point_values(mesh, np.asarray(position, float))
    total = int(structure.first_node[-1])
    begin = int(structure.first_node[at])
    row = Sparse((values.data, values.indices + begin, values.indptr), shape=(1, total))
    whole = Sparse(sparse.kron(row, np.eye(3), format="csr"))
    return Sparse(whole[:, structure.free])


def _point_values(mesh: Mesh, point: FloatArray) -> Sparse:
    """Return the shape functions at a point: of the element that it suits best."""
    node = nearest_node(mesh, point.tolist())
    around = np.flatnonzero(np.any(mesh.cells == node, axis=1))
    rows = []
    for cell in around:
        try:
            rows.append(interpolation(mesh, np.array([cell]), point[None]))
        except BadData:
            continue
    # Within an element no shape function exceeds 1; outside they grow.
    sizes = [float(np.abs(row.data).sum()) for row in rows]
    if not rows or min(sizes) > 3.5:
        raise BadData(
            f"point {point.tolist()} m does not lie on the body; check unit and origin"
        )
    return rows[int(np.argmin(sizes))]


def _require_names(
    names: Sequence[str],
    joints: Sequence[Joint],
    supports: Sequence[Support],
    masses: Sequence[PointMass],
) -> None:
    for kind, all_of in (("body", names), ("joint", [j.name for j in joints])):
        if len(set(all_of)) != len(all_of):
            raise UsageError(f"a {kind} name is given twice: {list(all_of)}")
    for joint in joints:
        first, second = joint.between
        if first not in names or second not in {*names, GROUND} or first == second:
            raise UsageError(
                f"joint {joint.name!r} is between {joint.between}; it must join two of "
                f"{list(names)}, or one of them (first) and {GROUND!r}"
            )
    for body in [*(s.body for s in supports), *(m.body for m in masses)]:
        if body not in names:
            raise UsageError(f"no body {body!r}; the structure has {list(names)}")
