# SPDX-License-Identifier: MIT
"""Factors body by body, and the modes of a jointed structure from these alone.

K(theta) >= K of the bodies alone, so a factor of each body plus a shift is valid for
every joint: as a preconditioner here, and for the error bound of a reduced model.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.full_modes import lowest_modes, shift_of
from jointbench.analysis.structures.reduction.krylov_subspace import orthonormalise
from jointbench.analysis.structures.reduction.sparse_factor import (
    Solve,
    Solver,
    factorise,
)

_MOST_STEPS = 30


@dataclass(frozen=True, slots=True, eq=False)
class BodyFactors:
    """Factors of K + shift M, one for each body.

    Attributes:
        solves: one for each body.
        blocks: first degree of freedom of each body, and the end.
        shift: [1/s^2].
    """

    solves: tuple[Solve, ...]
    blocks: IntArray
    shift: float

    def solve(self, load: FloatArray) -> FloatArray:
        """Solve for loads, shape (n_free, k), body by body."""
        answer = np.empty_like(load)
        for at, solve in enumerate(self.solves):
            rows = slice(int(self.blocks[at]), int(self.blocks[at + 1]))
            answer[rows] = solve(load[rows])
        return answer


def factor_bodies(structure: Structure, solver: Solver = Solver.AUTO) -> BodyFactors:
    """Factor every body separately.

    Args:
        structure: bodies and joints; bodies that are glued share one factor.
        solver: of the factors.

    Returns:
        The factors.
    """
    # The shift is that of the bodies without glue, which carries no waves.
    shift = shift_of(structure.stiffness, structure.mass)
    shifted = Sparse(structure.stiffness + structure.glue + shift * structure.mass)
    edges = glued_blocks(structure)
    solves = [factorise(block, solver) for block in _blocks(edges, shifted)]
    return BodyFactors(tuple(solves), edges, shift)


def glued_blocks(structure: Structure) -> IntArray:
    """Return the first degree of freedom of each block of glued bodies, and the end.

    Bodies between two glued ones belong to their block: it must be one range.
    """
    edges = structure.blocks
    ties = structure.glue.tocoo()
    first = np.searchsorted(edges, ties.row, side="right") - 1
    second = np.searchsorted(edges, ties.col, side="right") - 1
    inner = np.ones(edges.size, bool)
    for low, high in np.unique(np.stack([first, second], axis=1), axis=0):
        inner[low + 1 : high + 1] = False
    return np.asarray(edges[inner])


def body_modes(
    structure: Structure, count: int, solver: Solver = Solver.AUTO
) -> FloatArray:
    """Return the lowest modes of each body without its joints.

    Args:
        structure: bodies and joints.
        count: modes of each body, rigid ones included.
        solver: of the factors.

    Returns:
        Columns that move one body, or those glued to it, shape (n_free, n_blocks *
        count).
    """
    columns = []
    edges = glued_blocks(structure)
    shift = shift_of(structure.stiffness, structure.mass)
    stiffness = _blocks(edges, Sparse(structure.stiffness + structure.glue))
    mass = _blocks(edges, structure.mass)
    for at, (k, m) in enumerate(zip(stiffness, mass, strict=True)):
        most = min(count, k.shape[0] - 2)
        shapes = lowest_modes(k, m, most, solver, shift=shift).shapes
        part = np.zeros((structure.size, shapes.shape[0]))
        part[int(edges[at]) : int(edges[at + 1])] = shapes.T
        columns.append(part)
    return np.concatenate(columns, axis=1)


def _blocks(edges: IntArray, matrix: Sparse) -> list[Sparse]:
    return [
        Sparse(matrix[low:high, low:high]) for low, high in pairwise(edges.tolist())
    ]


def solve_bodywise(
    structure: Structure,
    factors: BodyFactors,
    stiffness: FloatArray,
    start: FloatArray,
    count: int,
    residual_norm: float,
) -> FloatArray:
    """Find the lowest modes with factors of the bodies alone (block Davidson).

    Args:
        structure: bodies and joints.
        factors: of its bodies.
        stiffness: totals [N/m], shape (3 n_joints,).
        start: subspace to begin with, orthonormal in M, shape (n_free, r), r >= count.
        count: number of modes.
        residual_norm: of each mode to stop at, relative [-]; the relative error of an
            isolated frequency is about its square.

    Returns:
        Mass-normalised shapes as columns, shape (n_free, count).

    Source:
        Morgan and Scott 1986, SIAM J. Sci. Stat. Comput. 7, 817-825 (generalised
        Davidson).
    """
    whole = structure.with_joints(stiffness)
    space, product = start, whole @ start
    for _ in range(_MOST_STEPS):
        small = space.T @ product
        value, vector = np.linalg.eigh(0.5 * (small + small.T))
        value, vector = value[:count], vector[:, :count]
        shapes = space @ vector
        residual = product @ vector - structure.mass @ shapes * value
        direction = factors.solve(residual)
        size = np.sqrt(np.abs(np.einsum("nk,nk->k", residual, direction)))
        open_ones = size > residual_norm * np.sqrt(value + factors.shift)
        if not open_ones.any():
            break
        new = orthonormalise(space, structure.mass, direction[:, open_ones])
        if not new.shape[1]:
            break
        space = np.concatenate([space, new], axis=1)
        product = np.concatenate([product, whole @ new], axis=1)
    return np.asarray(shapes)
