# SPDX-License-Identifier: MIT
"""Meshes of quadratic solids: record, box meshes, outer faces."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.array_checks import require_finite, require_shape
from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.structures.meshes.elements import ELEMENTS, ElementKind

# Nodes closer than this share of the size of the mesh are merged.
_SAME_NODE = 1e-7
# Largest distance of a midside node from the middle of its edge, as a share of it.
_MIDSIDE_DRIFT = 0.3
# The Kuhn division of a cube: six tetrahedra along the main diagonal.
_KUHN = np.array(
    [
        [0, 1, 2, 6],
        [0, 2, 3, 6],
        [0, 3, 7, 6],
        [0, 7, 4, 6],
        [0, 4, 5, 6],
        [0, 5, 1, 6],
    ]
)


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """A mesh of one kind of solid element.

    Attributes:
        nodes: coordinates [m], shape (n_nodes, 3).
        cells: nodes of each element, shape (n_cells, 20 or 10).
        kind: of the elements.
    """

    nodes: FloatArray
    cells: IntArray
    kind: ElementKind

    def __post_init__(self) -> None:
        """Check shapes, node numbers and midside nodes once; freeze the arrays."""
        require_shape("nodes", self.nodes, (None, 3))
        require_finite("nodes", self.nodes)
        wide = 20 if self.kind is ElementKind.HEX20 else 10
        require_shape("cells", self.cells, (None, wide))
        if not self.cells.size:
            raise BadData("the mesh holds no solid element; mesh the volume")
        if self.cells.min() < 0 or self.cells.max() >= self.nodes.shape[0]:
            raise BadData(
                f"an element names node {self.cells.max()}, the mesh has "
                f"{self.nodes.shape[0]}; export nodes and elements together"
            )
        _require_midsides(self)
        freeze(self, "nodes", "cells")

    @property
    def size(self) -> float:
        """Diagonal of the box around the mesh [m]."""
        return float(np.linalg.norm(np.ptp(self.nodes, axis=0)))


def _require_midsides(mesh: Mesh) -> None:
    """Raise where midside nodes are not between their corners (foreign order)."""
    element = ELEMENTS[mesh.kind]
    ends = mesh.nodes[mesh.cells[:, element.edges]]
    length = np.linalg.norm(ends[:, :, 1] - ends[:, :, 0], axis=-1)
    middle = mesh.nodes[mesh.cells[:, element.corners :]]
    drift = np.linalg.norm(middle - ends.mean(axis=2), axis=-1)
    bad = np.argwhere(drift > _MIDSIDE_DRIFT * length)
    if bad.size:
        cell, edge = bad[0]
        raise BadData(
            f"element {cell}: midside node {edge} is {drift[cell, edge]:.3g} m off "
            "the middle of its edge; midside nodes must follow VTK order (bottom, top, "
            "vertical edges)"
        )


def box_mesh(
    size: Sequence[float],
    cells: Sequence[int],
    *,
    origin: Sequence[float] = (0.0, 0.0, 0.0),
    kind: ElementKind = ElementKind.HEX20,
) -> Mesh:
    """Mesh a box with equal cells.

    Args:
        size: along x, y, z [m].
        cells: number of cells along x, y, z.
        origin: lowest corner [m].
        kind: tet10 divides every cell into six tetrahedra.

    Returns:
        The mesh.

    Raises:
        BadData: a size is not above zero, or a number of cells is below one.
    """
    if min(size) <= 0 or min(cells) < 1:
        raise BadData(
            f"a box of size {tuple(size)} m with {tuple(cells)} cells; sizes must be "
            "above zero and there must be a cell in each direction"
        )
    lines = [
        np.linspace(low, low + length, count + 1)
        for low, length, count in zip(origin, size, cells, strict=True)
    ]
    return grid_mesh(lines, kind=kind)


def grid_mesh(
    lines: Sequence[FloatArray], *, kind: ElementKind = ElementKind.HEX20
) -> Mesh:
    """Mesh a box between grid lines.

    Args:
        lines: coordinates of the lines along x, y and z [m], each rising.
        kind: tet10 divides every cell into six tetrahedra.

    Returns:
        The mesh; midside nodes halve their edges.

    Raises: UsageError: lines do not rise.
    """
    if any(line.size < 2 or np.any(np.diff(line) <= 0) for line in lines):
        raise UsageError("grid lines must rise, two at the least in each direction")
    corners = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 3)
    counts = [line.size for line in lines]
    number = np.arange(corners.shape[0]).reshape(counts)
    low, high = slice(None, -1), slice(1, None)
    steps = [
        (low, low, low),
        (high, low, low),
        (high, high, low),
        (low, high, low),
        (low, low, high),
        (high, low, high),
        (high, high, high),
        (low, high, high),
    ]
    bricks = np.stack([number[step].ravel() for step in steps], axis=1)
    if kind is ElementKind.TET10:
        bricks = bricks[:, _KUHN].reshape(-1, 4)
    return quadratic_mesh(corners, bricks, kind=kind)


def quadratic_mesh(nodes: FloatArray, cells: IntArray, *, kind: ElementKind) -> Mesh:
    """Add midside nodes to a mesh of corners.

    Args:
        nodes: coordinates of the corners [m], shape (n_corners, 3).
        cells: shape (n_cells, 8 or 4).
        kind: of the result.

    Returns:
        The mesh, with a node in the middle of every edge.
    """
    ends = np.sort(cells[:, ELEMENTS[kind].edges].reshape(-1, 2), axis=1)
    edges, inverse = np.unique(ends, axis=0, return_inverse=True)
    middle = 0.5 * (nodes[edges[:, 0]] + nodes[edges[:, 1]])
    midsides = nodes.shape[0] + inverse.reshape(cells.shape[0], -1)
    return Mesh(
        np.concatenate([nodes, middle]),
        np.concatenate([cells, midsides], axis=1).astype(np.int64),
        kind,
    )


@dataclass(frozen=True, slots=True, eq=False)
class Faces:
    """Outer faces of a mesh.

    Attributes:
        nodes: of each face, corners first, seen counter-clockwise from outside,
            shape (n_faces, 8 or 6).
        cells: the element of each face, shape (n_faces,).
        normal: unit vectors outwards, shape (n_faces, 3).
    """

    nodes: IntArray
    cells: IntArray
    normal: FloatArray


def outer_faces(mesh: Mesh) -> Faces:
    """Return the faces that belong to one element only.

    Args:
        mesh: any.

    Returns:
        The faces with their outward normals.
    """
    element = ELEMENTS[mesh.kind]
    faces = mesh.cells[:, element.faces]
    owner = np.repeat(np.arange(mesh.cells.shape[0]), element.faces.shape[0])
    faces = faces.reshape(-1, element.faces.shape[1])
    key = np.sort(faces[:, : element.face_corners], axis=1)
    _, first, count = np.unique(key, axis=0, return_index=True, return_counts=True)
    outer = np.sort(first[count == 1])
    corner = mesh.nodes[faces[outer, : element.face_corners]]
    # Half the cross product of the diagonals, or of two sides of a triangle.
    along = corner[:, 2] - corner[:, 0]
    across = corner[:, -1] - corner[:, 1]
    if element.face_corners == 3:
        along, across = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    normal = np.cross(along, across)
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    return Faces(faces[outer], owner[outer], normal / np.where(length > 0, length, 1.0))


def merge_nodes(mesh: Mesh) -> Mesh:
    """Merge nodes at the same place, and drop unused ones.

    Args:
        mesh: as read from a file; parts may have been meshed one by one.

    Returns:
        The same elements on shared nodes, which keep their order: rows of K and M
        that another program wrote follow it.
    """
    step = _SAME_NODE * mesh.size
    used: NDArray[np.int64] = np.unique(mesh.cells)
    place = np.round(mesh.nodes[used] / step).astype(np.int64)
    _, first, inverse = np.unique(place, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    number = np.full(mesh.nodes.shape[0], -1, np.int64)
    number[used] = np.argsort(order)[inverse.ravel()]
    return Mesh(mesh.nodes[used[first[order]]], number[mesh.cells], mesh.kind)
