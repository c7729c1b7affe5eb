# SPDX-License-Identifier: MIT
"""Bolted areas of a structure and the polynomials of relative motion across them.

The polynomials are orthonormal over the area, so springs that are spread evenly have
the stiffness of the whole area in each of them.
"""

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.structures.matrices.contact_interface import JointFace
from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.analysis.structures.matrices.parts import Joint
from jointbench.analysis.structures.matrices.structure import Structure

ORDER = 4
"""Highest degree of the polynomials: with 4 natural frequencies do not change more."""
# Least extent of an area along a tangent, as a share of the other.
_NO_EXTENT = 1e-6
_PARALLEL = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class AreaMotions:
    """Relative motions across one bolted area.

    Attributes:
        name: of the area.
        joint: that it belongs to.
        position: of its middle [m], shape (3,).
        rows: upper less lower body along x, y and z: mean motion, then that in each
            further polynomial, shape (n_polynomials, 3, n_free).
    """

    name: str
    joint: str
    position: FloatArray
    rows: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "position", "rows")


def joints_by_area(joint: Joint) -> list[Joint]:
    """Return a joint for each patch of a joint; itself if it has one area."""
    if joint.glued or len(joint.patches) < 2:
        return [joint]
    return [
        Joint(
            f"{joint.name} {number}",
            joint.between,
            (patch,),
            joint.face,
            pattern=joint.pattern,
        )
        for number, patch in enumerate(joint.patches, 1)
    ]


def bolted_areas(structure: Structure, owners: dict[str, str]) -> list[AreaMotions]:
    """Return the relative motions of all bolted areas.

    Args:
        structure: whose joints are single areas.
        owners: name of the joint of each area.

    Raises:
        UsageError: the plane of a joint is not at right angles to z.
        BadData: an area has no extent along a tangent.
    """
    return [
        AreaMotions(
            name,
            owners[name],
            face.points.weight @ face.points.position / face.points.area,
            _rows(structure, name, face),
        )
        for name, face in zip(structure.joints, structure.faces, strict=True)
    ]


def _rows(structure: Structure, name: str, face: JointFace) -> FloatArray:
    upward = float(face.frame[0, 2])
    if abs(upward) < 1.0 - _PARALLEL:
        raise UsageError(
            f"joint {name!r} is not at right angles to z; turn the model so that its "
            "bolts point along z"
        )
    weight = face.points.weight / face.points.area
    terms = _polynomials(name, face.points.position[:, :2], weight)
    # A joint counts from its first body outwards; here the upper body moves.
    motion = -np.sign(upward) * Sparse(terms * weight) @ face.motion
    wide = Sparse(sparse.kron(Sparse(motion), np.eye(3), format="csr"))
    return np.asarray(wide[:, structure.free].toarray()).reshape(len(terms), 3, -1)


def _polynomials(name: str, place: FloatArray, weight: FloatArray) -> FloatArray:
    """Return orthonormal polynomials over an area, 1 first, shape (n, n_points)."""
    arm = place - weight @ place
    reach = np.abs(arm).max(axis=0)
    if not reach.min() > _NO_EXTENT * reach.max():
        raise BadData(
            f"joint {name!r}: the bolted area is a line; give a patch with an area"
        )
    x, y = (arm / reach).T
    powers = [(d - j, j) for d in range(ORDER + 1) for j in range(d + 1)]
    terms = np.stack([x**i * y**j for i, j in powers], axis=1)
    root = np.linalg.cholesky((weight[:, None] * terms).T @ terms)
    return np.asarray(np.linalg.solve(root, terms.T))
