# SPDX-License-Identifier: MIT
"""Bodies, supports and joints, and the matrices of the assembly.

K(theta) = K + sum theta_d G_d: theta_d is a TOTAL stiffness [N/m] of one joint in one
direction, spread consistently over its area; C likewise. K alone is block diagonal.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy import sparse

from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.structures.matrices.contact_interface import (
    JointFace,
    interpolation,
)
from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.analysis.structures.matrices.joint_matrices import (
    Assembly,
    face_masses,
    held_freedoms,
    joint_matrices,
    kept_rows,
    nearest_node,
    point_masses,
    support_springs,
)
from jointbench.analysis.structures.matrices.parts import (
    DIRECTIONS,
    GROUND,
    FaceMass,
    Joint,
    MeshedBody,
    PointMass,
    Support,
    SupportKind,
)
from jointbench.analysis.structures.meshes.mesh import Mesh


@dataclass(frozen=True, slots=True, eq=False)
class Structure:
    """The matrices of bodies and joints over the free degrees of freedom.

    Attributes:
        bodies: in order.
        stiffness: of bodies and springs of supports, block diagonal [N/m], shape
            (n_free, n_free).
        mass: block diagonal, with point masses [kg].
        springs: of supports, as included in `stiffness` [N/m].
        loss: loss factor times stiffness, block diagonal [N/m].
        spread: G of every joint and direction, joint by joint, total 1 N/m.
        glue: stiffness of glued joints [N/m]; zero if there are none.
        joints: names of the joints that have parameters.
        faces: of these joints.
        blocks: first degree of freedom of each body, and the end, shape (n_bodies +
            1,).
        free: index of each free degree of freedom among all, shape (n_free,).
        first_node: of each body among all nodes, shape (n_bodies + 1,).
    """

    bodies: tuple[MeshedBody, ...]
    stiffness: Sparse
    mass: Sparse
    springs: Sparse
    loss: Sparse
    spread: tuple[Sparse, ...]
    glue: Sparse
    joints: tuple[str, ...]
    faces: tuple[JointFace, ...]
    blocks: IntArray
    free: IntArray
    first_node: IntArray = field(default_factory=lambda: np.zeros(1, np.int64))

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "blocks", "free", "first_node")

    @property
    def size(self) -> int:
        """Number of free degrees of freedom."""
        return int(self.free.size)

    @property
    def area(self) -> FloatArray:
        """Areas of the joints that have parameters [m^2], shape (n_joints,)."""
        return np.array([face.points.area for face in self.faces])

    @property
    def frames(self) -> FloatArray:
        """Rows normal and tangents of these joints, shape (n_joints, 3, 3)."""
        return np.array([face.frame for face in self.faces]).reshape(-1, 3, 3)

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
    bodies: Sequence[MeshedBody],
    joints: Sequence[Joint],
    *,
    supports: Sequence[Support] = (),
    masses: Sequence[PointMass | FaceMass] = (),
) -> Structure:
    """Assemble bodies, joints, supports and small masses.

    Args:
        bodies: with different names.
        joints: with different names.
        supports: of faces of bodies.
        masses: attached to bodies.

    Returns:
        The structure.

    Raises:
        BadData: a joint touches nothing.
        UsageError: a name is unknown or given twice.
    """
    names = [body.name for body in bodies]
    _require_names(names, joints, supports, masses)
    first_node = np.cumsum([0] + [body.mesh.nodes.shape[0] for body in bodies])
    build = Assembly(tuple(bodies), first_node.astype(np.int64))
    k = sparse.block_diag([body.stiffness for body in bodies], format="csr")
    loss = [body.loss_factor * body.stiffness for body in bodies]
    m = sparse.block_diag([body.mass for body in bodies], format="csr")
    riding = [one for one in masses if isinstance(one, PointMass)]
    m = m + face_masses(build, [one for one in masses if isinstance(one, FaceMass)])
    m = m + sparse.diags_array(point_masses(build, riding))
    held = np.zeros(m.shape[0], bool)
    springs = Sparse(k.shape)
    for support in supports:
        if support.kind is SupportKind.FIXED:
            held |= held_freedoms(build, support)
        else:
            springs = Sparse(springs + support_springs(build, support))
    free = np.flatnonzero(~held).astype(np.int64)
    spread, glue, faces = joint_matrices(build, joints, free, k.shape)
    return Structure(
        bodies=tuple(bodies),
        stiffness=kept_rows(k + springs, free),
        mass=kept_rows(m, free),
        springs=kept_rows(springs, free),
        loss=kept_rows(sparse.block_diag(loss, format="csr"), free),
        spread=tuple(spread),
        glue=glue,
        joints=tuple(joint.name for joint in joints if not joint.glued),
        faces=tuple(faces),
        blocks=np.searchsorted(free, 3 * first_node).astype(np.int64),
        free=free,
        first_node=first_node.astype(np.int64),
    )


def glued_blocks(structure: Structure) -> IntArray:
    """Return the first degree of freedom of each block of glued bodies, and the end.

    Bodies between two glued ones belong to their block: it must be one range.
    """
    edges = structure.blocks
    ties = structure.glue.tocoo()
    first = np.searchsorted(edges, ties.row, side="right") - 1
    second = np.searchsorted(edges, ties.col, side="right") - 1
    inner = np.ones(edges.size, bool)
    for low, high in np.unique(np.stack([first, second], axis=1), axis=0):
        inner[low + 1 : high + 1] = False
    return np.asarray(edges[inner])


def pick(structure: Structure, body: str, position: Sequence[float]) -> Sparse:
    """Return the motion x, y, z of a point of a body from the free degrees of freedom.

    Args:
        structure: with the body.
        body: its name.
        position: of the point [m]; between nodes it is interpolated.

    Returns:
        Shape (3, n_free).

    Raises:
        BadData: the point is not on the body.
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
    """Return the shape functions at a point: of the best matching element."""
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
            f"point {point.tolist()} m is not on the body; check unit and origin"
        )
    return rows[int(np.argmin(sizes))]


def _require_names(
    names: Sequence[str],
    joints: Sequence[Joint],
    supports: Sequence[Support],
    masses: Sequence[PointMass | FaceMass],
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
