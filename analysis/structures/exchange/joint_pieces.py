# SPDX-License-Identifier: MIT
"""A joint as few springs with six components, for programs with other meshes.

The distributed springs of a patch follow the relative rigid motion of its two sides:
that gives a stiffness and a damping matrix of 6 x 6 at the centroid of the patch.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import (
    BoolArray,
    FloatArray,
    IntArray,
    freeze,
)
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.structures.matrices.beam_body import cross_matrix
from jointbench.analysis.structures.matrices.contact_interface import JointFace
from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.analysis.structures.meshes.polygons import Patch

COMPONENTS = ("normal", "t1", "t2", "turn_normal", "turn_t1", "turn_t2")
"""Relative displacement and rotation, in the axes of a piece."""
# Points on the edge of a patch belong to it, as a share of its size.
_EDGE = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class JointPiece:
    """A part of a joint as one spring and damper with six components.

    Attributes:
        name: of the piece.
        centre: centroid of its area [m], shape (3,).
        frame: right-handed; rows are the normal and two tangents, shape (3, 3).
        area: [m^2].
        stiffness: of `COMPONENTS` [N/m, N, N m], shape (6, 6).
        damping: of `COMPONENTS` [N s/m, N s, N m s], shape (6, 6).
    """

    name: str
    centre: FloatArray
    frame: FloatArray
    area: float
    stiffness: FloatArray
    damping: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "centre", "frame", "stiffness", "damping")

    @property
    def global_stiffness(self) -> FloatArray:
        """Stiffness along and about the global axes, shape (6, 6)."""
        return turned(self.stiffness, self.frame)

    @property
    def global_damping(self) -> FloatArray:
        """Damping along and about the global axes, shape (6, 6)."""
        return turned(self.damping, self.frame)


@dataclass(frozen=True, slots=True, eq=False)
class PieceRead:
    """A piece as a file of another program holds it, along the global axes.

    Attributes:
        centre: of its two nodes [m], shape (3,).
        stiffness: [N/m, N, N m], shape (6, 6).
        damping: [N s/m, N s, N m s], shape (6, 6).
    """

    centre: FloatArray
    stiffness: FloatArray
    damping: FloatArray


def turned(matrix: FloatArray, frame: FloatArray) -> FloatArray:
    """Return a 6 x 6 matrix in the axes of `frame` along the global axes."""
    turn = np.kron(np.eye(2), frame)
    return np.asarray(turn.T @ matrix @ turn)


def tiles(face: JointFace, counts: Sequence[int]) -> tuple[Patch, ...]:
    """Divide the box around a joint's area into equal rectangles.

    Args:
        face: of the joint.
        counts: along the two tangents.
    """
    place = face.points.position @ face.frame[1:].T
    low, high = place.min(axis=0), place.max(axis=0)
    # Quadrature points lie inside: half a step covers the edges.
    slack = 0.5 * (high - low)
    edges = [np.linspace(low[k], high[k], counts[k] + 1) for k in range(2)]
    for k in range(2):
        edges[k][0] -= slack[k]
        edges[k][-1] += slack[k]
    return tuple(
        Patch(np.array([[a, c], [b, c], [b, d], [a, d]]))
        for a, b in zip(edges[0][:-1], edges[0][1:], strict=True)
        for c, d in zip(edges[1][:-1], edges[1][1:], strict=True)
    )


def joint_pieces(
    name: str,
    face: JointFace,
    patches: Sequence[Patch],
    stiffness: FloatArray,
    damping: FloatArray,
) -> tuple[JointPiece, ...]:
    """Return the pieces of a joint.

    Args:
        name: of the joint.
        face: of the joint.
        patches: a piece for each that holds a part of the area; none is one piece.
        stiffness: totals of the joint, normal and two tangents [N/m], shape (3,).
        damping: totals [N s/m], shape (3,).

    Returns:
        Pieces whose translations sum up to the totals.

    Raises:
        BadData: the patches leave a part of the area out.
    """
    members = piece_members(face, patches)
    return tuple(
        _piece(f"{name}.{at + 1}", face, inside, (stiffness, damping))
        for at, inside in enumerate(members)
    )


def piece_members(face: JointFace, patches: Sequence[Patch]) -> tuple[IntArray, ...]:
    """Return the numbers of the quadrature points of each piece.

    Raises:
        BadData: the patches leave a part of the area out.
    """
    count = face.points.weight.size
    if not patches:
        return (np.arange(count, dtype=np.int64),)
    place = face.points.position @ face.frame[1:].T
    owner = np.full(count, -1)
    for at, patch in enumerate(patches):
        owner[_inside(place, patch) & (owner < 0)] = at
    if np.any(owner < 0):
        raise BadData(
            f"{int((owner < 0).sum())} of {count} points of the joint are in no piece; "
            "give patches that cover the joint"
        )
    return tuple(
        np.flatnonzero(owner == at).astype(np.int64) for at in np.unique(owner)
    )


def piece_motion(face: JointFace, inside: IntArray, piece: JointPiece) -> Sparse:
    """Return the relative rigid motion of the two sides of a piece.

    Args:
        face: of the joint.
        inside: quadrature points of the piece.
        piece: with centre and frame.

    Returns:
        `COMPONENTS` from the motion of all nodes, shape (6, 3 n_nodes).

    Source:
        Least squares fit of a rigid motion, as in MacNeal, Finite Elements: Their
        Design and Performance (1994), ch. 10 (distributing coupling).
    """
    weight = face.points.weight[inside]
    arm = (face.points.position[inside] - piece.centre) @ piece.frame.T
    fit = np.stack([_rigid(one) for one in arm])
    normal = np.einsum("p,pai,paj->ij", weight, fit, fit)
    # Relative motion of each point in the axes of the piece.
    wide = np.linalg.solve(
        normal, (fit * weight[:, None, None]).transpose(2, 0, 1).reshape(6, -1)
    )
    along = np.kron(np.eye(inside.size), piece.frame)
    rows = np.asarray(wide @ along).reshape(6, inside.size, 3)
    motion = face.motion[inside]
    found = np.stack([motion.T @ rows[:, :, k].T for k in range(3)], axis=-1)
    return Sparse(found.transpose(1, 0, 2).reshape(6, -1))


def _inside(place: FloatArray, patch: Patch) -> BoolArray:
    begin, end = patch.corners, np.roll(patch.corners, -1, axis=0)
    edge = end - begin
    offset = place[:, None] - begin
    side = edge[:, 0] * offset[:, :, 1] - edge[:, 1] * offset[:, :, 0]
    size = float(np.ptp(patch.corners, axis=0).max())
    return np.asarray(np.all(side >= -_EDGE * size**2, axis=1))


def _piece(
    name: str,
    face: JointFace,
    inside: IntArray,
    totals: tuple[FloatArray, FloatArray],
) -> JointPiece:
    weight = face.points.weight[inside]
    place = face.points.position[inside]
    centre = weight @ place / weight.sum()
    normal, first = face.frame[0], face.frame[1]
    frame = np.stack([normal, first, np.cross(normal, first)])
    arm = (place - centre) @ frame.T
    fit = np.stack([_rigid(one) for one in arm])
    share = weight / face.points.area
    matrices = [np.einsum("p,pai,a,paj->ij", share, fit, k, fit) for k in totals]
    return JointPiece(
        name, centre, frame, float(weight.sum()), matrices[0], matrices[1]
    )


def _rigid(arm: FloatArray) -> FloatArray:
    """Return displacement at `arm` of displacement and rotation, shape (3, 6)."""
    return np.hstack([np.eye(3), -cross_matrix(arm)])
