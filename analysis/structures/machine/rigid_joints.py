# SPDX-License-Identifier: MIT
"""Joints made rigid: the moments of their ports are held by stiff springs."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.structures.machine.machine_bodies import COUPLED, RawBody
from jointbench.analysis.structures.machine.machine_parts import (
    SPRING_DIRECTIONS,
)
from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.analysis.structures.reduction.component import (
    BodyPort,
    point_port,
)
from jointbench.analysis.structures.reduction.port_joints import PortJoint, Side

# Stiffness of a rigid joint over that of the bodies at it.
_RIGID = 1e2
_RIGID_MARK = "rigid"


def rigid_joint(raw: dict[str, RawBody], joint: PortJoint) -> PortJoint:
    """Return a joint of one parameter that holds what the basis can follow.

    A rigid face holds the moments of its patterns, not every point: to hold points that
    the basis cannot move apart would stiffen the bodies.
    """
    sides: list[Side] = []
    for side in _plain_sides(joint):
        port = _port(raw, side)
        rows = Sparse(_commensurate(port).T @ port.rows)
        name = f"{side[1]} {_RIGID_MARK}"
        raw[side[0]].ports.append(point_port(name, rows))
        sides.append((side[0], name))
    second = sides[1] if len(sides) > 1 else None
    return PortJoint(f"{joint.name} {_RIGID_MARK}", sides[0], second, (_RIGID_MARK,))


def _plain_sides(joint: PortJoint) -> list[Side]:
    """Return the ports of a joint whose rows are motions."""
    sides = [joint.first] if joint.second is None else [joint.first, joint.second]
    return [(body, port.removesuffix(COUPLED)) for body, port in sides]


def _port(raw: dict[str, RawBody], side: Side) -> BodyPort:
    return next(one for one in raw[side[0]].ports if one.name == side[1])


def _commensurate(port: BodyPort) -> FloatArray:
    """Return patterns, with rotations of a piece times its arm [m]."""
    if port.rows.shape[0] != len(SPRING_DIRECTIONS):
        return port.patterns
    size = np.sqrt(np.asarray(port.rows.multiply(port.rows).sum(axis=1)).ravel())
    arm = size[:3].max() / max(size[3:].max(), 1e-300)
    return np.diag([1.0, 1.0, 1.0, arm, arm, arm])


def rigid_stiffness(raw: dict[str, RawBody], joint: PortJoint) -> float:
    """Return a stiffness that is rigid compared with the bodies at a joint [N/m].

    Estimated from the stiffness of the nodes of a port: for a face the sum over its
    nodes, for a piece that moves as a whole that of its nodes together.
    """
    found = [1.0]
    for side in _plain_sides(joint):
        rows = _port(raw, side).rows[: _port(raw, side).rows.shape[0] // 2]
        own = raw[side[0]].matrices.stiffness.diagonal()
        weight = np.asarray(rows.multiply(rows).sum(axis=0)).ravel()
        whole = rows.shape[0] == len(SPRING_DIRECTIONS) // 2
        scale = weight.sum() ** 2 if whole else weight @ weight
        found.append(float(weight @ own / max(scale, 1e-300)))
    return _RIGID * max(found)
