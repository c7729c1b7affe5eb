# SPDX-License-Identifier: MIT
"""The shared area of two faces, and consistent springs over it.

The energy of a joint is 1/2 sum_d (k_d / A) int (u_a - u_b)_d^2 dA with the elements'
own shape functions. Meshes of the faces need not match: faces are cut along each
    other's edges.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.analysis.structures.meshes.elements import (
    ELEMENTS,
    shape_functions,
    triangle_rule,
)
from jointbench.analysis.structures.meshes.mesh import Faces, Mesh, outer_faces
from jointbench.analysis.structures.meshes.polygons import (
    Patch,
    clip,
    fan,
    polygon_area,
)

# Largest distance of faces in one plane, as a share of the size of the body.
_ONE_PLANE = 1e-6
# Normals this parallel are one: faces of a joint are plane.
_PARALLEL = 1e-6
# Shared polygons below this share of a face are rounding.
_NO_AREA = 1e-9
_NEWTON_STEPS = 12


@dataclass(frozen=True, slots=True, eq=False)
class Plane:
    """The plane of a joint.

    Attributes:
        frame: rows normal, first and second tangent, shape (3, 3).
        offset: of the plane along the normal [m].
    """

    frame: FloatArray
    offset: float


@dataclass(frozen=True, slots=True, eq=False)
class ContactPoints:
    """Quadrature points of the shared area of two faces.

    Attributes:
        position: [m], shape (n_points, 3).
        weight: area of each [m^2], shape (n_points,).
        first: element of the first body at each point, shape (n_points,).
        second: the same of the second body; undefined for the ground.
    """

    position: FloatArray
    weight: FloatArray
    first: IntArray
    second: IntArray

    @property
    def area(self) -> float:
        """Area of the joint [m^2]."""
        return float(self.weight.sum())


@dataclass(frozen=True, slots=True, eq=False)
class JointFace:
    """The relative motion of the two sides of a joint.

    Attributes:
        motion: at the quadrature points, from one value per node, shape (n_points,
            n_nodes) [-].
        points: with their areas.
        frame: rows normal, first and second tangent, shape (3, 3).
    """

    motion: Sparse
    points: ContactPoints
    frame: FloatArray

    def springs(self) -> tuple[Sparse, ...]:
        """Return G of the three directions over all degrees of freedom."""
        return _spread_springs(self.motion, self.points, self.frame)

    def rows(self) -> Sparse:
        """Return the weighted relative motion, direction by direction.

        Returns:
            R with G_d = R_d' R_d, shape (3 n_points, 3 n_nodes) [-].
        """
        share = np.sqrt(self.points.weight / self.points.area)
        motion = Sparse(sparse.diags_array(share) @ self.motion)
        rows = [sparse.kron(motion, unit[None], format="csr") for unit in self.frame]
        return Sparse(sparse.vstack(rows, format="csr"))


def face_plane(mesh: Mesh, face: str) -> Plane:
    """Return the plane of a face named by axis and side, for example ``"z+"``.

    Raises:
        UsageError: no such name.
    """
    if len(face) != 2 or face[0] not in "xyz" or face[1] not in "+-":
        raise UsageError(f"face is {face!r}; write axis and side: x+, x-, y+ ... z-")
    axis = "xyz".index(face[0])
    values = mesh.nodes[np.unique(mesh.cells), axis]
    normal = np.zeros(3)
    normal[axis] = 1.0 if face[1] == "+" else -1.0
    level = values.max() if face[1] == "+" else -values.min()
    return Plane(_frame(normal), float(level))


def shared_planes(first: Mesh, second: Mesh) -> list[Plane]:
    """Return the planes with opposing faces of two bodies."""
    tolerance = _ONE_PLANE * max(first.size, second.size)
    own, others = _plane_table(first), _plane_table(second)
    found: list[Plane] = []
    for row in own:
        opposed = np.abs(others + row).max(axis=1)
        scale = np.array([_PARALLEL] * 3 + [tolerance])
        facing = np.all(np.abs(others + row) <= scale, axis=1)
        known = any(
            np.abs(plane.frame[0] - row[:3]).max() <= _PARALLEL
            and abs(plane.offset - row[3]) <= tolerance
            for plane in found
        )
        if facing.any() and opposed.size and not known:
            found.append(Plane(_frame(row[:3]), float(row[3])))
    return found


def _plane_table(mesh: Mesh) -> FloatArray:
    """Return normal and offset of the planes of the outer faces, each once."""
    faces = outer_faces(mesh)
    offset = np.einsum("fa,fa->f", faces.normal, mesh.nodes[faces.nodes[:, 0]])
    table = np.concatenate([faces.normal, offset[:, None]], axis=1)
    step = np.array([_PARALLEL] * 3 + [_ONE_PLANE * mesh.size])
    _, first = np.unique(np.round(table / step), axis=0, return_index=True)
    return np.asarray(table[np.sort(first)])


def _frame(normal: FloatArray) -> FloatArray:
    """Return normal and tangents; tangents follow the remaining global axes."""
    lead = int(np.argmax(np.abs(normal)))
    rest = [axis for axis in range(3) if axis != lead]
    unit = normal / np.linalg.norm(normal)
    first = np.eye(3)[rest[0]] - unit[rest[0]] * unit
    first /= np.linalg.norm(first)
    second = np.cross(unit, first)
    second *= np.sign(second[rest[1]])
    return np.stack([unit, first, second])


def contact_points(
    first: Mesh, second: Mesh | None, plane: Plane, patches: Sequence[Patch] = ()
) -> ContactPoints:
    """Return quadrature points of the shared area of two bodies in a plane.

    Args:
        first: of the body whose outward normal is the plane's.
        second: of the other body; None for the ground, which is unbounded.
        plane: of the joint.
        patches: parts of the plane in contact; none means all of it. They must not
            overlap.

    Returns:
        Quadrature points; there may be none.
    """
    own = _faces_in(first, plane, 1.0)
    other = _faces_in(second, plane, -1.0) if second is not None else None
    pieces: list[tuple[FloatArray, int, int]] = []
    for polygon, cell in own:
        for window, opposite in _facing(polygon, other):
            shared = polygon if window is None else _shared(polygon, window)
            parts = (
                [_shared(shared, patch.corners) for patch in patches]
                if patches and shared.size
                else [shared]
            )
            pieces += [(part, cell, opposite) for part in parts if part.shape[0] > 2]
    return _quadrature(pieces, plane)


_Polygons = list[tuple[FloatArray, int]]


def _faces_in(mesh: Mesh, plane: Plane, sign: float) -> _Polygons:
    """Return the corner polygons of the faces in a plane, counter-clockwise."""
    faces: Faces = outer_faces(mesh)
    count = ELEMENTS[mesh.kind].face_corners
    height = mesh.nodes[faces.nodes] @ plane.frame[0] - plane.offset
    inside = np.all(np.abs(height) <= _ONE_PLANE * mesh.size, axis=1)
    inside &= faces.normal @ plane.frame[0] * sign > 1.0 - _PARALLEL
    corners = mesh.nodes[faces.nodes[inside, :count]] @ plane.frame[1:].T
    return [
        (polygon if polygon_area(polygon) > 0 else polygon[::-1], int(cell))
        for polygon, cell in zip(corners, faces.cells[inside], strict=True)
    ]


def _facing(
    polygon: FloatArray, other: _Polygons | None
) -> list[tuple[FloatArray | None, int]]:
    """Return the polygons whose bounding boxes overlap; None means all."""
    if other is None:
        return [(None, 0)]
    if not other:
        return []
    low, high = polygon.min(axis=0), polygon.max(axis=0)
    slack = _NO_AREA * float(np.max(high - low))
    lows, highs = _boxes(other)
    near = np.all((lows < high - slack) & (highs > low + slack), axis=1)
    return [other[at] for at in np.flatnonzero(near)]


def _boxes(polygons: _Polygons) -> tuple[FloatArray, FloatArray]:
    lows = np.array([polygon.min(axis=0) for polygon, _ in polygons])
    highs = np.array([polygon.max(axis=0) for polygon, _ in polygons])
    return lows, highs


def _shared(polygon: FloatArray, window: FloatArray) -> FloatArray:
    part = clip(polygon, window)
    if part.shape[0] < 3 or polygon_area(part) <= _NO_AREA * polygon_area(polygon):
        return np.zeros((0, 2))
    return part


def _quadrature(
    pieces: Sequence[tuple[FloatArray, int, int]], plane: Plane
) -> ContactPoints:
    if not pieces:
        none = np.zeros(0, np.int64)
        return ContactPoints(np.zeros((0, 3)), np.zeros(0), none, none)
    triangles = [fan(polygon) for polygon, _, _ in pieces]
    counts = [len(one) for one in triangles]
    corner = np.concatenate(triangles)
    point, weight = triangle_rule()
    side = corner[:, 1:] - corner[:, :1]
    position = corner[:, None, 0] + np.einsum("qs,tsa->tqa", point, side)
    area = np.abs(np.linalg.det(side))[:, None] * weight
    flat = position.reshape(-1, 2) @ plane.frame[1:] + plane.offset * plane.frame[0]
    each = np.repeat(counts, 1) * point.shape[0]
    return ContactPoints(
        flat,
        area.ravel(),
        np.repeat([cell for _, cell, _ in pieces], each),
        np.repeat([cell for _, _, cell in pieces], each),
    )


def interpolation(mesh: Mesh, cells: IntArray, points: FloatArray) -> Sparse:
    """Return the matrix from values at the nodes to values at points of elements.

    Args:
        mesh: of the body.
        cells: the element of each point, shape (n_points,).
        points: [m], shape (n_points, 3).

    Returns:
        Shape functions, shape (n_points, n_nodes).

    Raises:
        BadData: a point is not inside its element.
    """
    corner = mesh.nodes[mesh.cells[cells]]
    natural = np.tile(ELEMENTS[mesh.kind].centre, (cells.size, 1))
    for _ in range(_NEWTON_STEPS):
        value, slope = shape_functions(mesh.kind, natural)
        missing = points - np.einsum("pi,pia->pa", value, corner)
        jacobian = np.einsum("pib,pia->pab", slope, corner)
        natural = natural + np.linalg.solve(jacobian, missing[:, :, None])[:, :, 0]
    value, _ = shape_functions(mesh.kind, natural)
    left = np.abs(points - np.einsum("pi,pia->pa", value, corner)).max(initial=0.0)
    if not left <= _ONE_PLANE * mesh.size:
        raise BadData(f"a point is {left:.3g} m outside of its element; mesh again")
    starts = np.arange(cells.size + 1) * value.shape[1]
    columns = mesh.cells[cells].ravel()
    shape = (cells.size, mesh.nodes.shape[0])
    return Sparse((value.ravel(), columns, starts), shape=shape)


def relative_motion(
    first: Mesh, second: Mesh | None, points: ContactPoints
) -> tuple[Sparse, Sparse | None]:
    """Return the interpolations for the relative motion at the points."""
    own = interpolation(first, points.first, points.position)
    if second is None:
        return own, None
    return own, interpolation(second, points.second, points.position)


def _spread_springs(
    motion: Sparse, points: ContactPoints, directions: FloatArray
) -> tuple[Sparse, ...]:
    """Spread a total stiffness of 1 N/m over a joint, for each direction.

    Args:
        motion: relative motion at the points from one value per node, shape (n_points,
            n_nodes).
        points: with their areas.
        directions: rows of unit vectors, shape (n_directions, 3).

    Returns:
        Matrices, shape (3 n_nodes, 3 n_nodes) [-], one for each direction; positive
        semi-definite.
    """
    weight = sparse.diags_array(points.weight / points.area)
    square = Sparse(motion.T @ weight @ motion)
    return tuple(
        Sparse(sparse.kron(square, np.outer(unit, unit), format="csr"))
        for unit in directions
    )
