# SPDX-License-Identifier: MIT
"""What a structure is made of: bodies, joints, supports, masses that ride on them."""

from dataclasses import dataclass
from enum import StrEnum

from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.structures.matrices.element_assembly import (
    Material,
    Sparse,
    assemble,
)
from jointbench.analysis.structures.meshes.mesh import Mesh
from jointbench.analysis.structures.meshes.polygons import Patch

GROUND = "ground"
DIRECTIONS = ("normal", "tangential_1", "tangential_2")
"""Directions of a joint; tangents follow the global axes in the plane, in order."""


class SupportKind(StrEnum):
    """How a face is held."""

    FIXED = "fixed"
    SPRINGS = "springs"


@dataclass(frozen=True, slots=True)
class Support:
    """A face of a body held by the ground.

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
    """A small mass that rides on a body: an accelerometer, a hammer tip.

    Attributes:
        body: name.
        position: [m], within or next to the body; the nearest node takes it.
        mass: [kg].
    """

    body: str
    position: tuple[float, float, float]
    mass: float


@dataclass(frozen=True, slots=True)
class FaceMass:
    """A mass that rides on a face as a whole: it follows the face's mean motion.

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
                    f"asks for ({wanted}, {wanted}): three numbers a node"
                )


def solid_body(name: str, mesh: Mesh, material: Material) -> MeshedBody:
    """Return a body of one material; see `assemble`."""
    stiffness, mass = assemble(mesh, material)
    return MeshedBody(name, mesh, stiffness, mass, material.loss_factor)


@dataclass(frozen=True, slots=True)
class Joint:
    """Where two bodies, or a body and the ground, touch.

    Attributes:
        name: of the joint.
        between: two bodies, or a body and ``"ground"``.
        patches: parts of the plane that touch, in global coordinates along the two
            tangents; none means all that the faces share.
        face: of the first body, ``"z+"`` for example; left out, the planes where the
            two bodies look at each other; the ground needs one.
        glued: held together, whatever the parameters: it has none.
    """

    name: str
    between: tuple[str, str]
    patches: tuple[Patch, ...] = ()
    face: str | None = None
    glued: bool = False
