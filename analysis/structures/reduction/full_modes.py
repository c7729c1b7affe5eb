# SPDX-License-Identifier: MIT
"""Modes of a whole structure by one factor: the reference for other solvers."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.krylov_subspace import largest_of_inverse
from jointbench.analysis.structures.reduction.rigid_motions import rigid_motions
from jointbench.analysis.structures.reduction.sparse_factor import Solver, factorise

# Shift over the eigenvalue of a wave as long as the structure.
_SHIFT_SHARE = 0.3
# Strain energy below this number of units in the last place of |x|' |K| |x| is
# rounding.
_ROUNDING = 16.0 * float(np.finfo(float).eps)


@dataclass(frozen=True, slots=True, eq=False)
class StructureModes:
    """Undamped modes of a structure, the lowest first.

    Attributes:
        natural_frequency: [Hz], shape (n_modes,); zero only for motions without strain.
        shapes: mass-normalised, shape (n_modes, n_free) [kg^-1/2].
        residual: ||K phi - lambda M phi|| over ||K phi||, largest of all [-].
    """

    natural_frequency: FloatArray
    shapes: FloatArray
    residual: float

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "natural_frequency", "shapes")


def shift_of(stiffness: Sparse, mass: Sparse) -> float:
    """Return a shift [1/s^2] in the range of the lowest elastic modes.

    K + shift M is positive definite even where bodies are free.

    Args:
        stiffness: of the bodies [N/m].
        mass: [kg].
    """
    # Waves of a mesh reach about sqrt(k/m) of one node; n^(1/3) nodes in a row.
    highest = stiffness.diagonal().sum() / mass.diagonal().sum()
    in_a_row = (stiffness.shape[0] / 3.0) ** (1.0 / 3.0)
    return float(highest * (_SHIFT_SHARE / in_a_row) ** 2)


def solve_full(
    structure: Structure,
    stiffness: FloatArray,
    count: int,
    *,
    solver: Solver = Solver.AUTO,
) -> StructureModes:
    """Find the lowest modes with the whole structure in one factor.

    Args:
        structure: bodies and joints.
        stiffness: total of every joint and direction [N/m], shape (3 n_joints,).
        count: number of modes, rigid ones included.
        solver: of the factors.

    Returns:
        The modes.

    Raises:
        BadData: a stiffness is negative, or the matrices cannot be factored.

    Source:
        Grimes, Lewis and Simon 1994, SIAM J. Matrix Anal. Appl. 15, 228-272 (block
        Lanczos, shift and invert).
    """
    values = np.asarray(stiffness, float)
    if values.size and not values.min() >= 0:
        raise BadData(f"a joint's stiffness is {values.min():g} N/m; it must be >= 0")
    # Springs and glue carry no waves and must not raise the shift.
    shift = shift_of(structure.stiffness, structure.mass)
    whole = structure.with_joints(values)
    rigid = rigid_motions(structure, values)
    return lowest_modes(whole, structure.mass, count, solver, shift=shift, rigid=rigid)


def lowest_modes(
    stiffness: Sparse,
    mass: Sparse,
    count: int,
    solver: Solver = Solver.AUTO,
    *,
    shift: float | None = None,
    rigid: FloatArray | None = None,
) -> StructureModes:
    """Find the lowest modes of sparse matrices; see `solve_full`.

    Args:
        stiffness: K [N/m].
        mass: M [kg].
        count: number of modes.
        solver: of the factors.
        shift: of the spectrum [1/s^2]; None uses that of the matrices.
        rigid: motions without strain, orthonormal in M, shape (n_free, k); None uses
            modes whose strain energy is rounding.

    Raises:
        BadData: too many modes are requested, or the matrices cannot be factored.
    """
    size = stiffness.shape[0]
    if not 0 < count < size - 1:
        raise BadData(f"{count} modes of {size} degrees of freedom; ask for fewer")
    if shift is None:
        shift = shift_of(stiffness, mass)
    still = np.zeros((size, 0)) if rigid is None else rigid[:, :count]
    value, vector = np.zeros(still.shape[1]), still
    if still.shape[1] < count:
        solve = factorise(Sparse(stiffness + shift * mass), solver)
        inverse, moving = largest_of_inverse(solve, mass, count - value.size, still)
        value = np.concatenate([value, 1.0 / inverse - shift])
        vector = np.concatenate([still, moving], axis=1)
    load = stiffness @ vector
    left = np.linalg.norm(load - mass @ vector * value, axis=0)
    scale = np.linalg.norm(load, axis=0) + shift * np.linalg.norm(mass @ vector, axis=0)
    if rigid is None:
        value = np.where(value > _strain_rounding(stiffness, vector), value, 0.0)
    return StructureModes(frequency_of(value), vector.T, float((left / scale).max()))


def _strain_rounding(stiffness: Sparse, vector: FloatArray) -> FloatArray:
    """Return the strain energy of each shape due to rounding [1/s^2]."""
    size = np.abs(vector)
    return np.asarray(_ROUNDING * np.einsum("nk,nk->k", size, abs(stiffness) @ size))


def frequency_of(eigenvalue: FloatArray) -> FloatArray:
    """Return natural frequencies [Hz] of eigenvalues [1/s^2]; none below zero."""
    return np.asarray(np.sqrt(np.maximum(eigenvalue, 0.0)) / (2.0 * np.pi))
