# SPDX-License-Identifier: MIT
"""The matrices of joints, supports and attached masses over all nodes."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy import sparse

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray, IntArray
from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.structures.matrices.contact_interface import (
    JointFace,
    Plane,
    contact_points,
    face_plane,
    interpolation,
    relative_motion,
    shared_planes,
)
from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.analysis.structures.matrices.parts import (
    GROUND,
    FaceMass,
    Joint,
    MeshedBody,
    PointMass,
    Support,
)
from jointbench.analysis.structures.meshes.mesh import Mesh


@dataclass(frozen=True, slots=True, eq=False)
class Assembly:
    """Bodies and the first node of each.

    Attributes:
        bodies: in order.
        first_node: of each body among all nodes, and their number at the end.
    """

    bodies: tuple[MeshedBody, ...]
    first_node: IntArray

    def place(self, name: str) -> int:
        """Return the number of a body."""
        return [body.name for body in self.bodies].index(name)


def kept_rows(matrix: Any, free: IntArray) -> Sparse:
    """Return the rows and columns that are free."""
    whole = Sparse(matrix)
    return whole if free.size == whole.shape[0] else Sparse(whole[free][:, free])


# Stiffness of a glued joint over that of the softer body.
_GLUE = 3e5


def joint_matrices(
    build: Assembly, joints: Sequence[Joint], free: IntArray, shape: tuple[int, ...]
) -> tuple[list[Sparse], Sparse, list[JointFace]]:
    """Return G of all directions, the glue, and the face of each joint not glued."""
    spread: list[Sparse] = []
    glue = Sparse((free.size, free.size))
    faces = []
    for joint in joints:
        face = _joint_face(build, joint)
        kept = [kept_rows(one, free) for one in face.springs()]
        if joint.glued:
            stiffness = _GLUE * _body_stiffness(build, joint, face.points.area)
            glue = Sparse(glue + stiffness * (kept[0] + kept[1] + kept[2]))
            continue
        spread += kept
        faces.append(face)
    return spread, glue, faces


def _body_stiffness(build: Assembly, joint: Joint, area: float) -> float:
    """Return E A / L of the bodies of a joint, from the trace of their stiffness."""
    values: list[float] = []
    for name in joint.between:
        if name == GROUND:
            continue
        body = build.bodies[build.place(name)]
        # The stiffness of a node is about E times the size of its element.
        modulus_length = float(np.median(body.stiffness.diagonal()))
        step = (np.ptp(body.mesh.nodes, axis=0).prod() / len(body.mesh.cells)) ** (
            1 / 3
        )
        values.append(float(modulus_length / step * area / body.mesh.size))
    return min(values)


def _joint_face(build: Assembly, joint: Joint) -> JointFace:
    """Return the relative motion of a joint over all nodes."""
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
    if joint.pattern is not None:
        place = points.position @ plane.frame[1:].T
        weight = joint.pattern.spread(place, points.weight)
        points = replace(points, weight=weight)
    return JointFace(motion, points, plane.frame)


def _planes(joint: Joint, first: Mesh, second: Mesh | None) -> list[Plane]:
    if joint.face is not None:
        return [face_plane(first, joint.face)]
    if second is None:
        raise UsageError(
            f"joint {joint.name!r} is to the ground; name its face, e.g. 'z-'"
        )
    return shared_planes(first, second)


def _no_single_plane(joint: Joint, count: int) -> str:
    if count:
        return (
            f"joint {joint.name!r}: bodies {joint.between} touch in {count} planes; "
            "name the face of the first body, for example face = 'z+'"
        )
    return (
        f"joint {joint.name!r} touches nothing: no surfaces of {joint.between[0]!r} "
        f"and {joint.between[1]!r} share an area where its patches are; check "
        "positions, units and patches"
    )


def _placed(motion: Sparse, build: Assembly, name: str, total: int) -> Sparse:
    """Expand a matrix of one body's nodes to all nodes."""
    begin = int(build.first_node[build.place(name)])
    columns = motion.indices + begin
    return Sparse((motion.data, columns, motion.indptr), shape=(motion.shape[0], total))


def support_springs(build: Assembly, support: Support) -> Sparse:
    """Return the stiffness of a face supported by springs [N/m]."""
    joint = Joint(
        f"support of {support.body}", (support.body, GROUND), face=support.face
    )
    springs = _joint_face(build, joint).springs()
    total = Sparse(springs[0].shape)
    for value, spring in zip(support.stiffness, springs, strict=True):
        total = Sparse(total + value * spring)
    return total


def held_freedoms(build: Assembly, support: Support) -> BoolArray:
    """Return which degrees of freedom a fixed support holds."""
    at = build.place(support.body)
    mesh = build.bodies[at].mesh
    plane = face_plane(mesh, support.face)
    points = contact_points(mesh, None, plane)
    if not points.weight.size:
        raise BadData(
            f"support of {support.body!r}: face {support.face!r} has no flat area"
        )
    candidates = np.unique(mesh.cells[points.first])
    height = mesh.nodes[candidates] @ plane.frame[0] - plane.offset
    nodes = candidates[np.abs(height) <= 1e-6 * mesh.size] + build.first_node[at]
    held = np.zeros(3 * int(build.first_node[-1]), bool)
    held[(3 * nodes[:, None] + np.arange(3)).ravel()] = True
    return held


def point_masses(build: Assembly, masses: Sequence[PointMass]) -> FloatArray:
    """Return the diagonal of the mass matrix of point masses [kg]."""
    diagonal = np.zeros(3 * int(build.first_node[-1]))
    for one in masses:
        if not one.mass >= 0:
            raise BadData(f"a point mass of {one.mass:g} kg; it must not be negative")
        at = build.place(one.body)
        node = nearest_node(build.bodies[at].mesh, one.position)
        diagonal[3 * (node + int(build.first_node[at])) + np.arange(3)] += one.mass
    return diagonal


def face_masses(build: Assembly, masses: Sequence[FaceMass]) -> Sparse:
    """Return the mass matrix of masses that follow the mean of a face [kg]."""
    total = int(build.first_node[-1])
    whole = Sparse((3 * total, 3 * total))
    for one in masses:
        mesh = build.bodies[build.place(one.body)].mesh
        points = contact_points(mesh, None, face_plane(mesh, one.face))
        if not points.weight.size:
            raise BadData(f"face {one.face!r} of {one.body!r} has no flat area")
        motion = interpolation(mesh, points.first, points.position)
        motion = _placed(motion, build, one.body, total)
        mean = sparse.csr_array((points.weight / points.area)[None, :]) @ motion
        square = one.mass * (mean.T @ mean)
        whole = Sparse(whole + sparse.kron(square, np.eye(3), format="csr"))
    return whole


def nearest_node(mesh: Mesh, position: Sequence[float]) -> int:
    """Return the node closest to a position.

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
            f"position {tuple(position)} m is {distance[best]:.3g} m from the "
            "nearest node of its body; check the unit and the origin"
        )
    return int(used[best])
