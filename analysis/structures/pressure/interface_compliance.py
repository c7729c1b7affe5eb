# SPDX-License-Identifier: MIT
"""The compliance of both bodies, condensed to the surface on which they meet."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.spatial import cKDTree

from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
from jointbench.analysis.structures.matrices.contact_interface import JointFace
from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.sparse_factor import factorise

_SLIDING = 1e-4
"""Tangential tie of the surfaces over the springs between them [-]: nothing rubs, and
loads along the surface have somewhere to go."""
_ADRIFT = 2 * np.pi * 0.5
"""Rate of the inertial springs that keep free bodies in place [rad/s]: some N/m."""
_SAME_PLACE = 1e-6
_AT_ONCE = 128


@dataclass(frozen=True, slots=True, eq=False)
class InterfaceCompliance:
    """Relative normal motion of two surfaces under forces between them.

    Springs of an even stiffness join the surfaces in it; who solves the contact takes
    them out again.

    Attributes:
        compliance: [m/N], shape (n, n).
        shapes: motion at the points of the joint from that at nodes [-], shape
            (n_points, n).
        loaded: motion under each unit load [m/N or m], shape (n, n_loads).
        springs: the even stiffness per area [N/m^3].
    """

    compliance: FloatArray
    shapes: Sparse
    loaded: FloatArray
    springs: float

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "compliance", "loaded")


def interface_compliance(
    structure: Structure,
    joint: int,
    loads: Sequence[FloatArray],
    springs: float,
) -> InterfaceCompliance:
    """Condense a structure to the surface of one joint.

    Args:
        structure: the bodies with their supports.
        joint: its number among those not glued; in others the same even springs stay.
        loads: nodal forces, shape (n_free,) each.
        springs: stiffness per area of the even springs [N/m^3].

    Returns:
        Compliance, and the motion under the loads.
    """
    face = structure.faces[joint]
    total = springs * face.points.area
    normal, *sideways = structure.spread[3 * joint : 3 * joint + 3]
    whole = structure.stiffness + structure.glue + _ADRIFT**2 * structure.mass
    whole = whole + total * (normal + _SLIDING * (sideways[0] + sideways[1]))
    for number, spread in enumerate(structure.spread):
        if number // 3 != joint:
            area = structure.faces[number // 3].points.area
            whole = whole + springs * area * spread
    solve = factorise(Sparse(whole))
    basis, shapes = _relative_nodes(structure, face)
    forces = basis.T.tocsc()
    count = forces.shape[1]
    compliance = np.empty((count, count))
    for begin in range(0, count, _AT_ONCE):
        some = slice(begin, min(begin + _AT_ONCE, count))
        compliance[:, some] = basis @ solve(forces[:, some].toarray())
    loaded = basis @ solve(np.stack(loads, axis=1))
    return InterfaceCompliance(
        0.5 * (compliance + compliance.T), shapes, np.asarray(loaded), springs
    )


def _relative_nodes(structure: Structure, face: JointFace) -> tuple[Sparse, Sparse]:
    """Return the normal motions that matter, and the points' motion from them.

    Where nodes of both surfaces are in one place only their difference matters.

    Returns:
        Shape (n, n_free), and shape (n_points, n).
    """
    motion = face.motion.tocsc()
    used = np.flatnonzero(np.diff(motion.indptr)).astype(np.int64)
    nodes = structure.nodes[used]
    pairs = cKDTree(nodes).query_pairs(_SAME_PLACE * np.ptp(nodes, axis=0).max())
    second = {max(pair): min(pair) for pair in pairs}
    matched = _matched(Sparse(motion), used, second)
    keep = np.array([i for i in range(used.size) if i not in matched], np.int64)
    place = {int(i): row for row, i in enumerate(keep)}
    rows, columns, signs = list(range(keep.size)), list(keep), [1.0] * keep.size
    for later, earlier in matched.items():
        rows.append(place[earlier])
        columns.append(later)
        signs.append(-1.0)
    total = structure.nodes.shape[0]
    chosen = sparse.csr_array(
        (signs, (rows, used[np.array(columns, np.int64)])), shape=(keep.size, total)
    )
    wide = Sparse(sparse.kron(chosen, face.frame[:1], format="csr"))
    return Sparse(wide[:, structure.free]), Sparse(motion[:, used[keep]].tocsr())


def _matched(motion: Sparse, used: IntArray, second: dict[int, int]) -> dict[int, int]:
    """Return the pairs of nodes whose motion enters as a difference alone."""
    out = {}
    for later, earlier in second.items():
        both = motion[:, [int(used[later]), int(used[earlier])]].sum(axis=1)
        if np.abs(both).max() < _SAME_PLACE:
            out[later] = earlier
    return out
