# SPDX-License-Identifier: MIT
"""Patterns and motions that an assembly lacks, from its residual at weak points."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.structures.reduction.assembled import Assembled
from jointbench.analysis.structures.reduction.component import BodyPort
from jointbench.analysis.structures.reduction.port_joints import PortJoint
from jointbench.analysis.structures.reduction.reduced_model import solve_reduced
from jointbench.analysis.structures.reduction.relative_motion import pattern_blocks

# Traction patterns of each joint and direction that are added at once.
_PATTERNS = 8
# Motions of each body, times a factor of the enrichment (decision record 0198).
_MOTIONS = 16
# Singular values below this share of the largest are left out.
_SMALL = 1e-4
_SPARE = 2


@dataclass(frozen=True, slots=True, eq=False)
class Enrichment:
    """What the bodies of an assembly should also answer.

    Attributes:
        patterns: of each joint with more patterns than before, shape (n_rows,
            n_patterns).
        inertia: motions of each body, shape (n, k).
    """

    patterns: Mapping[str, FloatArray]
    inertia: Mapping[str, FloatArray]


def enrichment(
    whole: Assembled, points: Sequence[FloatArray], factor: int = 1
) -> Enrichment:
    """Return the tractions and motions of the modes at some points of the box.

    Args:
        whole: the assembly.
        points: stiffnesses [N/m], each of shape (n_parameters,).
        factor: of the motions that are taken: they replace those of the enrichment
            before, so that a later one needs more.

    Returns:
        For the next reduction of the bodies.
    """
    model = whole.model
    shapes, stiffness = [], []
    for point in points:
        found = solve_reduced(model, point, min(model.modes + _SPARE, model.size))
        elastic = found.shapes[:, found.rigid :]
        scale = np.sqrt(found.eigenvalue[found.rigid :] + model.shift)
        shapes.append(elastic / scale)
        stiffness.append(np.repeat(point[:, None], elastic.shape[1], axis=1))
    motion, ties = np.concatenate(shapes, axis=1), np.concatenate(stiffness, axis=1)
    patterns, at = {}, 0
    for joint in whole.joints:
        count = len(joint.directions)
        patterns[joint.name] = _tractions(whole, joint, motion, ties[at : at + count])
        at += count
    inertia = {}
    for body, place in zip(whole.components, whole.places, strict=True):
        vector, size, _ = np.linalg.svd(motion[place], full_matrices=False)
        most = factor * _MOTIONS
        kept = vector[:, :most][:, size[:most] > _SMALL * size[0]]
        inertia[body.name] = body.basis @ kept
    return Enrichment(patterns, inertia)


def _tractions(
    whole: Assembled, joint: PortJoint, motion: FloatArray, ties: FloatArray
) -> FloatArray:
    """Return the patterns of a joint and the largest tractions outside of them."""
    rows = whole.rows(joint.first)
    if joint.second is not None:
        rows = rows - whole.rows(joint.second)
    body = whole.components[whole.number(joint.first[0])]
    assert body.residual is not None
    groups = len(joint.directions)
    blocks = pattern_blocks(body.residual.patterns[joint.first[1]], groups)
    room = blocks[0].shape[0] - blocks[0].shape[1]
    count = min(_PATTERNS, room, motion.shape[1])
    wider = []
    for own, part, tie in zip(
        blocks, np.split(rows @ motion, groups), ties, strict=True
    ):
        left = tie * part
        for _ in range(2):
            left = left - own @ (own.T @ left)
        vector = np.linalg.svd(left, full_matrices=False)[0][:, :count]
        vector = np.linalg.qr(np.concatenate([own, vector], axis=1))[0]
        wider.append(vector)
    return np.asarray(block_diag(*wider))


def widened(
    ports: Mapping[str, Sequence[BodyPort]],
    joints: Sequence[PortJoint],
    patterns: Mapping[str, FloatArray],
) -> dict[str, list[BodyPort]]:
    """Return the ports with the new patterns of their joints."""
    new = {}
    for joint in joints:
        for side in (joint.first, joint.second):
            if side is not None:
                new[side] = patterns[joint.name]
    return {
        body: [
            BodyPort(p.name, p.rows, new.get((body, p.name), p.patterns)) for p in own
        ]
        for body, own in ports.items()
    }
