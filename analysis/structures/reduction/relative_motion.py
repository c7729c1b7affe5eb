# SPDX-License-Identifier: MIT
"""Relative motion at the joints of reduced bodies, in their coordinates."""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.structures.reduction.component import Component
from jointbench.analysis.structures.reduction.port_joints import (
    PortJoint,
    PortSpring,
    Side,
    sides_of,
)
from jointbench.analysis.structures.reduction.residual_norm import JointMotion

# Relative strain energy of a joint, of a motion that is rigid to rounding.
_NO_STRAIN = 1e-18


def body_number(bodies: Sequence[Component], name: str) -> int:
    """Return the place of a body.

    Raises:
        UsageError: there is no such body.
    """
    names = [body.name for body in bodies]
    if name not in names:
        raise UsageError(f"no body {name!r}; the assembly has {names}")
    return names.index(name)


def body_places(bodies: Sequence[Component]) -> tuple[IntArray, ...]:
    """Return the coordinates of each body: rigid ones of all bodies come first."""
    rigid, elastic = 0, sum(body.rigid for body in bodies)
    found = []
    for body in bodies:
        moving = body.size - body.rigid
        found.append(
            np.concatenate(
                [
                    np.arange(rigid, rigid + body.rigid),
                    np.arange(elastic, elastic + moving),
                ]
            )
        )
        rigid, elastic = rigid + body.rigid, elastic + moving
    return tuple(found)


def port_rows(
    bodies: Sequence[Component], places: Sequence[IntArray], side: Side, size: int
) -> FloatArray:
    """Return the rows of a port in the coordinates of all bodies, (n_rows, size)."""
    at = body_number(bodies, side[0])
    rows = bodies[at].port(side[1])
    wide = np.zeros((rows.shape[0], size))
    wide[:, places[at]] = rows
    return wide


def relative_rows(
    bodies: Sequence[Component],
    places: Sequence[IntArray],
    joint: PortJoint | PortSpring,
) -> tuple[list[FloatArray], IntArray]:
    """Return the relative motion of each direction, and the coordinates it needs."""
    parts = []
    for side, sign in sides_of(joint):
        at = body_number(bodies, side[0])
        parts.append((at, sign * bodies[at].port(side[1])))
    counts = {rows.shape[0] for _, rows in parts}
    groups = len(joint.directions) if isinstance(joint, PortJoint) else 1
    if len(counts) > 1 or counts.copy().pop() % max(groups, 1):
        raise BadData(
            f"ports of {joint.name!r} have {sorted(counts)} rows; both sides need the "
            f"same number, a multiple of {groups}"
        )
    used = sorted({at for at, _ in parts})
    columns = np.concatenate([places[at] for at in used])
    start = np.cumsum([0] + [bodies[at].size for at in used])
    rows = np.zeros((counts.pop(), columns.size))
    for at, part in parts:
        begin = int(start[used.index(at)])
        rows[:, begin : begin + part.shape[1]] += part
    return np.split(rows, groups), columns


def joint_motion(
    bodies: Sequence[Component],
    joint: PortJoint,
    rows: Sequence[FloatArray],
    columns: IntArray,
) -> JointMotion:
    """Split the relative motion into that on the patterns and the rest."""
    patterns, loads, compliance = None, [], 0.0
    for side, sign in sides_of(joint):
        at = body_number(bodies, side[0])
        residual = bodies[at].residual
        if residual is None:
            continue
        patterns = residual.patterns[side[1]]
        loads.append((at, residual.columns()[side[1]], sign))
        compliance += residual.compliance[side[1]]
    if patterns is None:
        none = np.zeros((len(rows), 0, columns.size))
        return JointMotion(columns, none, none, 0.0, ())
    blocks = pattern_blocks(patterns, len(rows))
    moments = [block.T @ own for block, own in zip(blocks, rows, strict=True)]
    rest = [
        _root(own - block @ moment)
        for own, block, moment in zip(rows, blocks, moments, strict=True)
    ]
    return JointMotion(
        columns, np.array(moments), np.array(rest), compliance, tuple(loads)
    )


def pattern_blocks(patterns: FloatArray, groups: int) -> list[FloatArray]:
    """Return the diagonal blocks of patterns that act in one direction each."""
    count = patterns.shape[1] // groups
    return [
        part[:, at * count : (at + 1) * count]
        for at, part in enumerate(np.split(patterns, groups))
    ]


def _root(rows: FloatArray) -> FloatArray:
    """Return R with R'R = rows' rows, square."""
    size = rows.shape[1]
    if rows.shape[0] < size:
        return np.concatenate([rows, np.zeros((size - rows.shape[0], size))])
    return np.asarray(np.linalg.qr(rows, mode="r"))


def rigid_strain(rows: FloatArray, columns: IntArray, still: int) -> FloatArray:
    """Return the strain of a joint by rigid motions: zero, or of trace one."""
    motion = np.zeros((rows.shape[0], still))
    rigid = columns < still
    motion[:, columns[rigid]] = rows[:, rigid]
    _, size, vector = np.linalg.svd(motion, full_matrices=False)
    scale = float((rows**2).sum(axis=0).max(initial=0.0))
    value = np.where(size**2 > _NO_STRAIN * scale, size**2, 0.0)
    whole = float(value.sum())
    strain = np.asarray((vector.T * value) @ vector)
    return strain / whole if whole > 0 else strain
