# SPDX-License-Identifier: MIT
"""Motions without strain: the exact null space of a stiffness.

A table on a soft joint moves slowly but strains it; a free body has no strain. Only the
rigid motions of connected parts can be free of strain. Bodies, supports, glue and
joints each exclude the motions that strain them. Each is compared with its own
stiffness, so that the softest joint is not lost in the rounding of a stiff body.
"""

from itertools import pairwise

import numpy as np
from scipy.sparse.csgraph import connected_components

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.analysis.structures.matrices.parts import MeshedBody
from jointbench.analysis.structures.matrices.structure import (
    Structure,
    glued_blocks,
)
from jointbench.analysis.structures.reduction.krylov_subspace import orthonormalise

# Strain energy below this number of units in the last place of |x|' |K| |x| is
# rounding.
_ROUNDING = 16.0 * float(np.finfo(float).eps)
# Least strain of a joint above rounding, relative to its trace.
_NO_STRAIN = 1e-12
# Number of entries checked for the precision of matrices from text files.
_SAMPLE = 200
_FEWEST_DIGITS, _MOST_DIGITS = 5, 15


def unstrained_bodies(structure: Structure) -> FloatArray:
    """Return the motions that strain no body, no support and no glue.

    Args:
        structure: bodies and joints; joints are ignored.

    Returns:
        Columns orthonormal in M, shape (n_free, n_motions).
    """
    edges = glued_blocks(structure)
    found = []
    for low, high in pairwise(edges.tolist()):
        motion = unstrained_block(structure, low, high)
        column = np.zeros((structure.size, motion.shape[1]))
        column[low:high] = motion
        found.append(column)
    return np.concatenate(found, axis=1)


def unstrained_block(structure: Structure, low: int, high: int) -> FloatArray:
    """Return the motions that strain no body of a block, no support and no glue.

    Args:
        structure: bodies and joints; joints are ignored.
        low: first degree of freedom of the block.
        high: the one after its last.

    Returns:
        Columns orthonormal in M, shape (high - low, n_motions).
    """
    found = []
    for at, body in enumerate(structure.bodies):
        rows = slice(int(structure.blocks[at]), int(structure.blocks[at + 1]))
        if rows.start < low or rows.stop > high or rows.start == rows.stop:
            continue
        within = structure.free[rows] - 3 * int(structure.first_node[at])
        mass = Sparse(structure.mass[rows, rows])
        own = Sparse(body.stiffness[within][:, within])
        motion = orthonormalise(
            np.zeros((within.size, 0)), mass, _rigid_motions(body)[within]
        )
        motion = motion @ _kept(_strain(own, motion, _precision(own)))
        column = np.zeros((high - low, motion.shape[1]))
        column[rows.start - low : rows.stop - low] = motion
        found.append(column)
    motions = np.concatenate(found, axis=1)
    for part in (structure.springs, structure.glue):
        own = Sparse(part[low:high, low:high])
        motions = motions @ _kept(_strain(own, motions, _ROUNDING))
    return np.asarray(motions)


def joint_strains(structure: Structure, motions: FloatArray) -> FloatArray:
    """Return the strain of every joint and direction by motions, without rounding.

    Args:
        structure: bodies and joints.
        motions: of `unstrained_bodies`, shape (n_free, n_motions).

    Returns:
        Relative to the trace: zero or of trace one, shape (n_parameters, n_motions,
        n_motions) [-].
    """
    count = motions.shape[1]
    found = np.zeros((len(structure.spread), count, count))
    for at, spread in enumerate(structure.spread):
        strain = _strain(spread, motions, _ROUNDING)
        whole = float(np.trace(strain))
        found[at] = strain / whole if whole > 0 else 0.0
    return found


def unstrained(strains: FloatArray, stiff: BoolArray) -> tuple[FloatArray, int]:
    """Rotate motions so that those not held by a stiff joint come first.

    Args:
        strains: of `joint_strains`, shape (n_parameters, n_motions, n_motions).
        stiff: which stiffnesses are above zero, shape (n_parameters,).

    Returns:
        Orthogonal, shape (n_motions, n_motions), and the number of its columns without
        strain.
    """
    value, turn = np.linalg.eigh(strains[stiff].sum(axis=0))
    return turn, int(np.count_nonzero(value <= _NO_STRAIN))


def rigid_motions(structure: Structure, stiffness: FloatArray) -> FloatArray:
    """Return the motions of a jointed structure without strain.

    Args:
        structure: bodies and joints.
        stiffness: totals [N/m], shape (3 n_joints,).

    Returns:
        Columns orthonormal in M, shape (n_free, n_motions).
    """
    motions = unstrained_bodies(structure)
    turn, count = unstrained(joint_strains(structure, motions), stiffness > 0)
    return np.asarray(motions @ turn[:, :count])


def _strain(part: Sparse, motions: FloatArray, precision: float) -> FloatArray:
    """Return twice the strain energy between motions; rounding becomes zero."""
    energy = motions.T @ (part @ motions)
    size = np.einsum("nk,nk->k", np.abs(motions), abs(part) @ np.abs(motions))
    value, vector = np.linalg.eigh(0.5 * (energy + energy.T))
    value = np.where(value > precision * size.max(initial=0.0), value, 0.0)
    return np.asarray((vector * value) @ vector.T)


def _kept(strain: FloatArray) -> FloatArray:
    """Return an orthonormal basis of the null space of `strain`."""
    value, vector = np.linalg.eigh(strain)
    limit = _NO_STRAIN * max(float(np.abs(value).max(initial=0.0)), 1e-300)
    return np.asarray(vector[:, value <= limit])


def _rigid_motions(body: MeshedBody) -> FloatArray:
    """Return the six rigid motions of every connected part of a body."""
    nodes = body.mesh.nodes
    ties = body.stiffness.tocoo()
    near = Sparse(
        (np.ones(ties.nnz, np.int8), (ties.row // 3, ties.col // 3)),
        shape=(nodes.shape[0],) * 2,
    )
    count, piece = connected_components(near, directed=False)
    columns = []
    for number in range(count):
        own = piece == number
        place = (nodes - nodes[own].mean(axis=0)) / body.mesh.size
        for axis in np.eye(3):
            columns.append(np.where(own[:, None], axis, 0.0).ravel())
            columns.append(np.where(own[:, None], np.cross(axis, place), 0.0).ravel())
    return np.array(columns).T


def _precision(matrix: Sparse) -> float:
    """Return the relative precision of the entries of a body's matrix.

    Text of few digits is recognised by its entries: they are unchanged by rounding to
        as many digits.
    """
    size = np.abs(matrix.data)
    largest = matrix.data[np.argsort(size)[-_SAMPLE:]]
    for digits in range(_FEWEST_DIGITS, _MOST_DIGITS + 1):
        if all(float(f"{one:.{digits - 1}e}") == one for one in largest.tolist()):
            return float(0.5 * 10.0 ** (1 - digits))
    return _ROUNDING
