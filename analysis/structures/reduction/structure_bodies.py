# SPDX-License-Identifier: MIT
"""The bodies of a structure with their ports, ready to be reduced one by one."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.analysis.structures.matrices.parts import DIRECTIONS
from jointbench.analysis.structures.matrices.structure import (
    Structure,
    glued_blocks,
)
from jointbench.analysis.structures.reduction.component import (
    BodyMatrices,
    BodyPort,
    BodySource,
    point_port,
)
from jointbench.analysis.structures.reduction.port_joints import PortJoint, Side
from jointbench.analysis.structures.reduction.reduce_body import joint_patterns
from jointbench.analysis.structures.reduction.rigid_motions import unstrained_block

LOADS = "loads"
"""BodyPort of each body for the sensors and hits on it."""


@dataclass(frozen=True, slots=True, eq=False)
class BodyRange:
    """One body, or those glued together, within a structure.

    Attributes:
        name: of the body; glued ones are joined by ``"+"``.
        low: first free degree of freedom.
        high: the one after the last.
    """

    name: str
    low: int
    high: int


def body_ranges(structure: Structure) -> tuple[BodyRange, ...]:
    """Return the bodies that are reduced as one each."""
    found = []
    for low, high in pairwise(glued_blocks(structure).tolist()):
        names = [
            body.name
            for body, first, last in zip(
                structure.bodies, structure.blocks, structure.blocks[1:], strict=False
            )
            if low <= first and last <= high and first < last
        ]
        found.append(BodyRange("+".join(names), low, high))
    return tuple(found)


def range_of(structure: Structure, body: str) -> BodyRange:
    """Return the range that holds a body."""
    at = [one.name for one in structure.bodies].index(body)
    low, high = int(structure.blocks[at]), int(structure.blocks[at + 1])
    return next(r for r in body_ranges(structure) if r.low <= low and high <= r.high)


def body_matrices(structure: Structure, where: BodyRange) -> BodyMatrices:
    """Return the matrices of a body with its supports, attached masses and glue."""
    rows = slice(where.low, where.high)
    stiffness = structure.stiffness[rows, rows] + structure.glue[rows, rows]
    factors = {
        body.loss_factor
        for body, first in zip(structure.bodies, structure.blocks, strict=False)
        if where.low <= first < where.high
    }
    plain = len(factors) == 1 and not structure.glue[rows, rows].nnz
    plain = plain and not structure.springs[rows, rows].nnz
    return BodyMatrices(
        where.name,
        Sparse(stiffness),
        Sparse(structure.mass[rows, rows]),
        unstrained_block(structure, where.low, where.high),
        max(factors),
        None if plain else Sparse(structure.loss[rows, rows]),
        BodySource.MESH,
    )


def structure_ports(
    structure: Structure, order: int, loads: FloatArray | None = None
) -> tuple[dict[str, list[BodyPort]], tuple[PortJoint, ...]]:
    """Return the ports of every body, and the joints between them.

    Args:
        structure: bodies and joints.
        order: of the polynomials of the traction patterns.
        loads: rows where forces act or motion is read, shape (n_points, n_free).

    Returns:
        Ports by the names of `body_ranges`, and joints with parameters.
    """
    ranges = body_ranges(structure)
    ports: dict[str, list[BodyPort]] = {one.name: [] for one in ranges}
    joints = []
    for name, face in zip(structure.joints, structure.faces, strict=True):
        rows = Sparse(face.rows()[:, structure.free])
        place = face.points.position @ face.frame[1:].T
        share = face.points.weight / face.points.area
        patterns = joint_patterns(place, share, order)
        sides: list[Side] = []
        for body, part in _sides(structure, ranges, rows):
            port = f"{name}/{len(sides) + 1}"
            sign = 1.0 if not sides else -1.0
            ports[body].append(BodyPort(port, Sparse(sign * part), patterns))
            sides.append((body, port))
        second = sides[1] if len(sides) > 1 else None
        joints.append(PortJoint(name, sides[0], second, DIRECTIONS))
    if loads is not None:
        for one in ranges:
            own = loads[:, one.low : one.high]
            own = own[np.any(own != 0, axis=1)]
            if own.size:
                ports[one.name].append(point_port(LOADS, own))
    return ports, tuple(joints)


def _sides(
    structure: Structure, ranges: tuple[BodyRange, ...], rows: Sparse
) -> list[tuple[str, Sparse]]:
    """Return the part of the relative motion of each body that has some."""
    found = []
    for one in ranges:
        part = Sparse(rows[:, one.low : one.high])
        if part.nnz:
            found.append((one.name, part))
    return found
