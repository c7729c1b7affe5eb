# SPDX-License-Identifier: MIT
"""Forces that press a joint together: bolts with heads and threads, and weight."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.basics.units import STANDARD_GRAVITY
from jointbench.analysis.structures.matrices.contact_interface import (
    JointFace,
    Plane,
    contact_points,
    interpolation,
)
from jointbench.analysis.structures.matrices.parts import GROUND
from jointbench.analysis.structures.matrices.structure import Structure, pick
from jointbench.analysis.structures.meshes.mesh import Mesh
from jointbench.analysis.structures.meshes.polygons import Patch, disc

_SECTORS = 32
_ON_SURFACE = 0.97
"""Least share of the ring below a head that lies on a surface [-]."""
_LEVELS = 4
_AROUND = 8


@dataclass(frozen=True, slots=True)
class ClampBolt:
    """A bolt across a joint.

    Attributes:
        name: for messages.
        position: along the two tangents of the joint, global coordinates [m].
        preload: [N].
        log_sd: standard deviation of ln of the preload, of this bolt alone [-].
        head: outer diameter of head or washer [m].
        hole: diameter of the hole [m]; 0 for none.
        seats: coordinates of the seats on the first and the second body along the
            normal axis [m]; None is the outermost plane of the body.
        thread: length of thread in the second body, from the joint on [m]; None has a
            nut or head there.
        diameter: of the thread [m].
    """

    name: str
    position: tuple[float, float]
    preload: float
    log_sd: float
    head: float
    hole: float
    seats: tuple[float | None, float | None] = (None, None)
    thread: float | None = None
    diameter: float = 0.0

    def __post_init__(self) -> None:
        """Check the numbers."""
        if not (np.isfinite(self.preload) and self.preload >= 0):
            raise BadData(
                f"{self.name}: preload is {self.preload:g} N; it must be finite, 0 or "
                "more"
            )
        if not self.head > self.hole:
            raise BadData(
                f"{self.name}: head {1e3 * self.head:g} mm is not larger than its hole "
                f"{1e3 * self.hole:g} mm; give the washer's outer diameter as head"
            )


def bolt_load(
    structure: Structure, face: JointFace, between: tuple[str, str], bolt: ClampBolt
) -> FloatArray:
    """Return the nodal forces of a bolt of 1 N [-], shape (n_free,).

    Args:
        structure: with both bodies.
        face: of the joint.
        between: the two bodies; the ground takes its end as it is.
        bolt: where it is.

    Raises:
        BadData: its head or thread is not on a body.
    """
    total = np.zeros(3 * structure.nodes.shape[0])
    ends = (1.0, -1.0)
    for number, (name, sign) in enumerate(zip(between, ends, strict=True)):
        if name == GROUND or (number == 1 and bolt.thread is not None):
            continue
        at = [one.name for one in structure.bodies].index(name)
        mesh = structure.bodies[at].mesh
        values = _ring_shares(mesh, face, bolt, number, name)
        begin = 3 * int(structure.first_node[at])
        force = np.outer(values, sign * face.frame[0]).ravel()
        total[begin : begin + force.size] += force
    load: FloatArray = total[structure.free]
    if bolt.thread is not None and between[1] != GROUND:
        load = load + _thread_load(structure, face, between[1], bolt)
    return load


def _ring_shares(
    mesh: Mesh, face: JointFace, bolt: ClampBolt, number: int, name: str
) -> FloatArray:
    """Return each node's share of the force below a head, shape (n_nodes,)."""
    outwards = -face.frame[0] if number == 0 else face.frame[0]
    frame = np.stack([outwards, *face.frame[1:]])
    axis = int(np.argmax(np.abs(outwards)))
    seat = bolt.seats[number]
    level = float((mesh.nodes[np.unique(mesh.cells)] @ outwards).max())
    if seat is not None:
        level = seat * float(outwards[axis])
    ring = _ring(bolt)
    found = contact_points(mesh, None, Plane(frame, level), ring)
    wanted = np.pi / 4 * (bolt.head**2 - bolt.hole**2)
    share = found.area / wanted if found.weight.size else 0.0
    if share < _ON_SURFACE:
        raise BadData(
            f"{bolt.name}: {100 * share:.0f} % of the ring below its head lies on body "
            f"{name!r} at {'xyz'[axis]} = {1e3 * level * outwards[axis]:g} mm; check "
            "position, unit, head and seat"
        )
    values = interpolation(mesh, found.first, found.position)
    return np.asarray(values.T @ (found.weight / found.area))


def _ring(bolt: ClampBolt) -> tuple[Patch, ...]:
    """Return the ring below a head as convex parts."""
    if bolt.hole <= 0:
        return (disc(bolt.position, bolt.head / 2),)
    angle = 2 * np.pi * np.arange(_SECTORS + 1) / _SECTORS
    step = 2 * np.pi / _SECTORS
    # Radii at which the polygon has the area of the circle.
    grown = np.sqrt(step / np.sin(step))
    unit = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    centre = np.asarray(bolt.position, float)
    inner, outer = (centre + grown * size / 2 * unit for size in (bolt.hole, bolt.head))
    return tuple(
        Patch(np.stack([inner[i], outer[i], outer[i + 1], inner[i + 1]]))
        for i in range(_SECTORS)
    )


def _thread_load(
    structure: Structure, face: JointFace, body: str, bolt: ClampBolt
) -> FloatArray:
    """Return the force of a thread of 1 N, even over its length, shape (n_free,)."""
    normal = face.frame[0]
    base = float(face.points.position[0] @ normal) * normal
    base = base + np.asarray(bolt.position, float) @ face.frame[1:]
    load = np.zeros(structure.free.size)
    turn = 2 * np.pi * np.arange(_AROUND) / _AROUND
    for level in (np.arange(_LEVELS) + 0.5) / _LEVELS * (bolt.thread or 0.0):
        for angle in turn:
            arm = np.array([np.cos(angle), np.sin(angle)]) @ face.frame[1:]
            place = base + level * normal + 0.5 * bolt.diameter * arm
            try:
                rows = pick(structure, body, place.tolist())
            except BadData as error:
                raise BadData(
                    f"{bolt.name}: its thread leaves body {body!r}; check position, "
                    "unit and thread"
                ) from error
            load -= rows.T @ normal / (_LEVELS * _AROUND)
    return load


def weight_load(structure: Structure, direction: FloatArray) -> FloatArray:
    """Return the nodal forces of the weight of everything [N], shape (n_free,).

    Args:
        structure: with supports.
        direction: in which things fall, of any length, shape (3,).

    Raises:
        BadData: the direction has no length, or nothing is supported.
    """
    length = float(np.linalg.norm(direction))
    if not (np.isfinite(length) and length > 0):
        raise BadData("gravity has no direction; write e.g. gravity = [0, 0, -1]")
    if (
        structure.free.size == 3 * structure.nodes.shape[0]
        and not structure.springs.nnz
    ):
        raise BadData(
            "weight needs a support: nothing holds the bodies; add [[supports]], or "
            "leave gravity out"
        )
    weights = np.tile(STANDARD_GRAVITY * direction / length, structure.nodes.shape[0])
    return np.asarray(structure.mass @ weights[structure.free])
