# SPDX-License-Identifier: MIT
"""Surfaces of bodies for pictures, and their motion as rigid bodies."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
from jointbench.analysis.structures.machine.machine_parts import RigidPart
from jointbench.analysis.structures.matrices.beam_body import BeamBody
from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.analysis.structures.meshes.elements import ELEMENTS
from jointbench.analysis.structures.meshes.mesh import Mesh, outer_faces

# Corners of the ring that stands for the section of a beam.
_RING = 10
_STEEL = 7850.0


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """The surface of a body.

    Attributes:
        nodes: [m], shape (n, 3).
        triangles: shape (m, 3).
        rows: from the degrees of freedom of the body to the motion x, y, z of these
            nodes, shape (3 n, n_freedoms).
    """

    nodes: FloatArray
    triangles: IntArray
    rows: Sparse

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "nodes", "triangles")


def solid_surface(mesh: Mesh) -> Surface:
    """Return corners and midside nodes of the outer faces of a mesh.

    Args:
        mesh: of the body; its degrees of freedom are x, y, z node by node.
    """
    corners = outer_faces(mesh).nodes[:, : ELEMENTS[mesh.kind].face_corners]
    halves = [corners[:, [0, 1, 2]]]
    if corners.shape[1] > 3:
        halves.append(corners[:, [0, 2, 3]])
    used, triangles = np.unique(np.concatenate(halves), return_inverse=True)
    columns = (3 * used[:, None] + np.arange(3)).ravel()
    rows = Sparse(
        (np.ones(columns.size), columns, np.arange(columns.size + 1)),
        shape=(columns.size, 3 * mesh.nodes.shape[0]),
    )
    return Surface(mesh.nodes[used], triangles.reshape(-1, 3), rows)


def beam_surface(beam: BeamBody) -> Surface:
    """Return the skin of a beam: a ring at each node."""
    axis = beam.nodes[-1] - beam.nodes[0]
    axis = axis / np.linalg.norm(axis)
    first = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    first /= np.linalg.norm(first)
    second = np.cross(axis, first)
    angle = 2.0 * np.pi * np.arange(_RING) / _RING
    ring = np.outer(np.cos(angle), first) + np.outer(np.sin(angle), second)
    arms = beam.radius[:, None, None] * ring
    nodes = (beam.nodes[:, None] + arms).reshape(-1, 3)
    blocks = np.zeros((nodes.shape[0], 3, 6))
    blocks[:, :, :3] = np.eye(3)
    for axis_at in range(3):
        turned = np.cross(np.eye(3)[axis_at], arms.reshape(-1, 3))
        blocks[:, :, 3 + axis_at] = turned
    place = np.repeat(np.arange(beam.nodes.shape[0]), _RING)
    columns = (6 * place[:, None] + np.arange(6))[:, None].repeat(3, axis=1)
    rows = Sparse(
        (blocks.ravel(), columns.ravel(), 6 * np.arange(3 * nodes.shape[0] + 1)),
        shape=(3 * nodes.shape[0], 6 * beam.nodes.shape[0]),
    )
    return Surface(nodes, _tube(beam.nodes.shape[0]), rows)


def _tube(rings: int) -> IntArray:
    low = np.arange((rings - 1) * _RING)
    beside = low // _RING * _RING + (low + 1) % _RING
    first = np.stack([low, beside, low + _RING], axis=1)
    second = np.stack([beside, beside + _RING, low + _RING], axis=1)
    return np.concatenate([first, second]).astype(np.int64)


def rigid_surface(part: RigidPart) -> Surface:
    """Return a cube of steel of the mass of a rigid body."""
    half = 0.5 * (part.mass / _STEEL) ** (1.0 / 3.0)
    corners = half * np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T
    blocks = np.zeros((8, 3, 6))
    blocks[:, :, :3] = np.eye(3)
    for axis in range(3):
        blocks[:, :, 3 + axis] = np.cross(np.eye(3)[axis], corners)
    sides = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)]
    sides += [(2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
    rows = Sparse(blocks.reshape(24, 6))
    return Surface(corners + np.array(part.position), np.array(sides, np.int64), rows)


def orthonormal_motions(motions: FloatArray, mass: Sparse) -> FloatArray:
    """Return rigid motions orthonormal in M: displacements, then rotations.

    Args:
        motions: displacement x, y, z and rotation about x, y, z of any point, shape
            (n, 6).
        mass: of the body [kg], shape (n, n).

    Returns:
        Columns, shape (n, 6) [kg^-1/2]; the rotations are about the centre of mass.
    """
    gram = motions.T @ np.asarray(mass @ motions)
    # Displacements come first: rotations lose their part of them.
    lower = np.linalg.cholesky(gram)
    return np.asarray(np.linalg.solve(lower, motions.T).T)


def node_motions(nodes: FloatArray, *, turns: bool) -> FloatArray:
    """Return rigid motions of nodes.

    Args:
        nodes: [m], shape (n, 3).
        turns: whether nodes have rotations of their own.

    Returns:
        Shape (3 n or 6 n, 6): displacement and rotation x, y, z about the mean node.
    """
    arm = nodes - nodes.mean(axis=0)
    wide = 6 if turns else 3
    found = np.zeros((nodes.shape[0], wide, 6))
    for axis in range(3):
        found[:, axis, axis] = 1.0
        found[:, :3, 3 + axis] = np.cross(np.eye(3)[axis], arm)
        if turns:
            found[:, 3 + axis, 3 + axis] = 1.0
    return found.reshape(-1, 6)
