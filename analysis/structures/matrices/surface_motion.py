# SPDX-License-Identifier: MIT
"""Mean displacement and rotation of a piece of a body: where a spring is attached.

A bearing seat or a carriage moves as a plane through many nodes: its motion is the
least squares fit of a rigid motion, and a force or moment on it is spread over them
without stiffening the body.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.structures.matrices.contact_interface import (
    contact_points,
    face_plane,
    interpolation,
)
from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.analysis.structures.meshes.mesh import Mesh
from jointbench.analysis.structures.meshes.polygons import Patch

# Least spread of the points in any two directions, as a share of the largest.
_NO_SPREAD = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Attachment:
    """A piece of a body.

    Attributes:
        position: the point whose motion is meant [m].
        radius: nodes within it belong to the piece [m]; without a face.
        face: axis and side, for example ``"z+"``; None takes nodes in the radius.
        patch: part of the face; None is all of it.
    """

    position: tuple[float, float, float]
    radius: float | None = None
    face: str | None = None
    patch: Patch | None = None


def motion_of_piece(name: str, mesh: Mesh, where: Attachment) -> Sparse:
    """Return the mean motion of a piece of a body.

    Args:
        name: of the body, for messages.
        mesh: of the body.
        where: the piece.

    Returns:
        Displacement x, y, z of `where.position` and rotation x, y, z, shape (6, 3
        n_nodes).

    Raises:
        BadData: the piece has too few nodes to turn, or no area.

    Source:
        Least squares fit of a rigid motion, as in MacNeal, Finite Elements: Their
        Design and Performance (1994), ch. 10 (distributing coupling).
    """
    values, place, weight = _points(name, mesh, where)
    centre = weight @ place
    arm = place - centre
    spread = np.einsum("p,pa,pb->ab", weight, arm, arm)
    inertia = np.trace(spread) * np.eye(3) - spread
    least = float(np.linalg.eigvalsh(inertia)[0])
    if not least > _NO_SPREAD * float(np.trace(inertia)):
        raise BadData(
            f"body {name!r}: the points around {list(where.position)} m lie on a line "
            "and cannot turn; give a larger radius"
        )
    mean = Sparse(sparse.kron(Sparse(weight[None]) @ values, np.eye(3), format="csr"))
    # Rotation: inertia^-1 sum w (arm x u).
    crossed = np.zeros((3, place.shape[0], 3))
    for axis in range(3):
        crossed[axis] = np.cross(np.eye(3)[axis], arm)
    moment = (crossed * weight[:, None]).reshape(3, -1)
    wide = Sparse(sparse.kron(values, np.eye(3), format="csr"))
    turned = Sparse(np.linalg.solve(inertia, moment)) @ wide
    offset = np.asarray(where.position, float) - centre
    lever = Sparse(np.stack([np.cross(axis, offset) for axis in np.eye(3)], axis=1))
    return Sparse(sparse.vstack([mean + lever @ turned, turned], format="csr"))


def _points(
    name: str, mesh: Mesh, where: Attachment
) -> tuple[Sparse, FloatArray, FloatArray]:
    """Return values at points from those of nodes, their places and their shares."""
    if where.face is not None:
        patches = () if where.patch is None else (where.patch,)
        found = contact_points(mesh, None, face_plane(mesh, where.face), patches)
        if not found.weight.size:
            raise BadData(
                f"body {name!r}: face {where.face!r} has no area there; check the patch"
            )
        values = interpolation(mesh, found.first, found.position)
        return values, found.position, found.weight / found.area
    used = np.unique(mesh.cells)
    distance = np.linalg.norm(mesh.nodes[used] - np.asarray(where.position), axis=1)
    near = used[distance <= (where.radius or 0.0)]
    if near.size < 3:
        raise BadData(
            f"body {name!r} has {near.size} nodes within {where.radius or 0.0:g} m of "
            f"{list(where.position)} m, three are needed; give a larger radius, or "
            "check position and unit"
        )
    starts = np.arange(near.size + 1)
    shape = (near.size, mesh.nodes.shape[0])
    values = Sparse((np.ones(near.size), near, starts), shape=shape)
    return values, mesh.nodes[near], np.full(near.size, 1.0 / near.size)


def rotated(rows: Sparse, axis: Sequence[float] | None) -> Sparse:
    """Return six rows of motion along an axis and two directions across it.

    Args:
        rows: displacement and rotation x, y, z, shape (6, n).
        axis: first direction, of any length; None keeps x, y, z.

    Raises:
        BadData: the axis has no length.
    """
    if axis is None:
        return rows
    first = np.asarray(axis, float)
    length = float(np.linalg.norm(first))
    if not length > 0.0:
        raise BadData("the axis of a spring has no length; write e.g. [1, 0, 0]")
    first = first / length
    second = np.cross(first, np.eye(3)[int(np.argmin(np.abs(first)))])
    second /= np.linalg.norm(second)
    frame = np.stack([first, second, np.cross(first, second)])
    return Sparse(Sparse(np.kron(np.eye(2), frame)) @ rows)
