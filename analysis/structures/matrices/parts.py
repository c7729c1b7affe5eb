# SPDX-License-Identifier: MIT
"""Parts of a structure: bodies, joints, supports, attached masses."""

from dataclasses import dataclass
from enum import StrEnum

from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.structures.matrices.element_assembly import (
    Material,
    Sparse,
    assemble,
)
from jointbench.analysis.structures.matrices.spring_pattern import SpringPattern
from jointbench.analysis.structures.meshes.mesh import Mesh
from jointbench.analysis.structures.meshes.polygons import Patch

GROUND = "ground"
DIRECTIONS = ("normal", "tangential_1", "tangential_2")
"""Directions of a joint; tangents follow the global axes in the plane, in order."""


class SupportKind(StrEnum):
    """Kind of support of a face."""

    FIXED = "fixed"
    SPRINGS = "springs"


@dataclass(frozen=True, slots=True)
class Support:
    """A face of a body supported by the ground.

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
    """A small mass attached to a body: an accelerometer, a hammer tip.

    Attributes:
        body: name.
        position: [m], within or next to the body; it is added to the nearest node.
        mass: [kg].
    """

    body: str
    position: tuple[float, float, float]
    mass: float


@dataclass(frozen=True, slots=True)
class FaceMass:
    """A mass attached to a whole face: it follows the face's mean motion.

    Attributes:
        body: name.
        face: axis and side, for example ``"z+"``.
        mass: [kg].
    """

    body: str
    face: str
    mass: float


@dataclass(frozen=True, slots=True, eq=False)
class MeshedBody:
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
                    f"needs ({wanted}, {wanted}): three numbers per node"
                )


def solid_body(name: str, mesh: Mesh, material: Material) -> MeshedBody:
    """Return a body of one material; see `assemble`."""
    stiffness, mass = assemble(mesh, material)
    return MeshedBody(name, mesh, stiffness, mass, material.loss_factor)


@dataclass(frozen=True, slots=True)
class Joint:
    """The contact of two bodies, or of a body and the ground.

    Attributes:
        name: of the joint.
        between: two bodies, or a body and ``"ground"``.
        patches: parts of the plane in contact, in global coordinates along the two
            tangents; none means the whole shared area.
        face: of the first body, ``"z+"`` for example; default is the planes with
            opposing faces; required for the ground.
        glued: rigidly tied, without parameters.
        pattern: how springs and dampers are spread over it; None is evenly.
    """

    name: str
    between: tuple[str, str]
    patches: tuple[Patch, ...] = ()
    face: str | None = None
    glued: bool = False
    pattern: SpringPattern | None = None
