# SPDX-License-Identifier: MIT
"""A reduced structure, solved in about a millisecond, with an error bound."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.structures.reduction.full_modes import frequency_of
from jointbench.analysis.structures.reduction.rigid_motions import unstrained

# Extra modes solved, so that the last requested one has neighbours.
_SPARE = 4


@dataclass(frozen=True, slots=True, eq=False)
class ReducedModel:
    """Matrices of a structure in a basis valid for a whole box of joints.

    Attributes:
        stiffness: of the bodies, shape (r, r); the mass is the unit matrix.
        spread: of every joint and direction, total 1 N/m, shape (n_parameters, r, r).
        loss: loss factor times stiffness, shape (r, r).
        basis: from reduced to free degrees of freedom, shape (n_free, r).
        riesz: the norm of the residual is that of riesz @ (y, (shift + lambda) y,
            theta_1/scale_1 y, ...), shape (n_rank, (2 + n_parameters) r).
        scale: of the stiffnesses in `riesz` [N/m], shape (n_parameters,).
        strains: of `joint_strains`, for the first columns of the basis, motions without
            strain of the bodies; shape (n_parameters, n_motions, n_motions) [-].
        shift: of the norm [1/s^2].
        box: smallest and largest valid stiffness [N/m].
        modes: number of accurate modes, rigid ones included.
        names: of the parameters.
    """

    stiffness: FloatArray
    spread: FloatArray
    loss: FloatArray
    basis: FloatArray
    riesz: FloatArray
    scale: FloatArray
    strains: FloatArray
    shift: float
    box: tuple[float, float]
    modes: int
    names: tuple[str, ...]

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "stiffness", "spread", "loss", "basis", "riesz", "scale")
        freeze(self, "strains")

    @property
    def size(self) -> int:
        """Number of reduced degrees of freedom."""
        return int(self.stiffness.shape[0])

    def with_joints(self, stiffness: FloatArray) -> FloatArray:
        """Return reduced K(theta) [1/s^2], shape (r, r)."""
        values = np.asarray(stiffness, float)
        if values.shape != self.scale.shape or not np.all(values >= 0):
            raise BadData(
                f"joint stiffnesses are {values.tolist()} N/m; give {self.scale.size} "
                "values, none below zero"
            )
        return np.asarray(self.stiffness + np.tensordot(values, self.spread, 1))


@dataclass(frozen=True, slots=True, eq=False)
class ReducedModes:
    """Undamped modes of a reduced structure.

    Attributes:
        eigenvalue: [1/s^2], shape (n_modes,); exactly zero for rigid motions.
        natural_frequency: [Hz], shape (n_modes,).
        shapes: reduced, orthonormal, columns, shape (r, n_modes).
        rigid: number of modes without strain, the first ones.
    """

    eigenvalue: FloatArray
    natural_frequency: FloatArray
    shapes: FloatArray
    rigid: int


def solve_reduced(
    model: ReducedModel, stiffness: FloatArray, count: int | None = None
) -> ReducedModes:
    """Find the lowest modes of a reduced structure.

    Args:
        model: the reduced structure.
        stiffness: totals [N/m], shape (n_parameters,).
        count: number of modes; default is that of the model.

    Returns:
        The modes; rigid ones have frequency zero, all others one above zero.
    """
    values = np.asarray(stiffness, float)
    matrix = model.with_joints(values)
    turn, rigid = unstrained(model.strains, values > 0)
    wanted = min(count or model.modes, model.size)
    moved = turn.shape[0]
    matrix[:moved] = turn.T @ matrix[:moved]
    matrix[:, :moved] = matrix[:, :moved] @ turn
    value, vector = np.zeros(wanted), np.eye(model.size, wanted)
    if wanted > rigid:
        straining = matrix[rigid:, rigid:]
        # Softer joints cannot be distinguished from rounding.
        smallest = np.finfo(float).eps * float(np.abs(straining).max())
        found, vector[rigid:, rigid:] = eigh(
            straining,
            subset_by_index=(0, wanted - rigid - 1),
            driver="evr",
            check_finite=False,
        )
        value[rigid:] = np.maximum(found, smallest)
    vector[:moved] = turn @ vector[:moved]
    return ReducedModes(value, frequency_of(value), vector, min(rigid, wanted))


def frequency_bound(
    model: ReducedModel, stiffness: FloatArray, count: int | None = None
) -> tuple[FloatArray, FloatArray]:
    """Bound the error of reduced frequencies above those of the full mesh.

    With A = K(theta) + shift M, each residual r of a Ritz pair is measured in the norm
    of the inverse of the bodies' own K + shift M, which is never smaller than that of
    A. The error of the Ritz values of A^-1 M is then at most |r| (isolated), and at
    most the sum of |r|^2 over the gap to the rest of the spectrum (a group of
    neighbours). The gap is measured between Ritz values, less their own bounds.

    Args:
        model: the reduced structure.
        stiffness: totals [N/m], shape (n_parameters,).
        count: number of modes; default is that of the model.

    Returns:
        Natural frequencies [Hz] and the largest amount by which each exceeds that of
        the full mesh [Hz], both shape (n_modes,).

    Source:
        Parlett, The Symmetric Eigenvalue Problem (1998), ch. 11; Mathias 1998, SIAM J.
        Matrix Anal. Appl. 19, 541-550.
    """
    wanted = min(count or model.modes, model.size)
    found = solve_reduced(model, stiffness, min(wanted + _SPARE, model.size))
    level = found.eigenvalue + model.shift
    error = _residual_norms(model, found, stiffness) / np.sqrt(level)
    inverse = 1.0 / level
    slack = _inverse_slack(inverse, error)
    lowest = 1.0 / (inverse + slack) - model.shift
    frequency = found.natural_frequency
    bound = np.where(frequency > 0, frequency - frequency_of(lowest), 0.0)
    return frequency[:wanted], bound[:wanted]


def _residual_norms(
    model: ReducedModel, found: ReducedModes, stiffness: FloatArray
) -> FloatArray:
    y = found.shapes
    ratio = np.asarray(stiffness, float) / model.scale
    stack = np.concatenate(
        [y, -(found.eigenvalue + model.shift) * y, *(value * y for value in ratio)]
    )
    return np.asarray(np.linalg.norm(model.riesz @ stack, axis=0))


def _inverse_slack(inverse: FloatArray, error: FloatArray) -> FloatArray:
    """Return how much each eigenvalue of A^-1 M may exceed its Ritz value.

    Among all groups of neighbours of a mode, the one with the smallest sum of squares
    over its gap is used: with soft joints, modes are far closer to each other, relative
    to the shift, than to the rest.
    """
    slack = inverse * error
    last = inverse.size - 1
    squares = np.concatenate([[0.0], np.cumsum(slack**2)])
    # Inverses fall from the first mode to the last, whose lower neighbour is unknown.
    low, high = np.triu_indices(inverse.size)
    low, high = low[high < last], high[high < last]
    above = np.maximum(low - 1, 0)
    gap = inverse[high] - inverse[high + 1] - slack[high + 1]
    over = inverse[above] - slack[above] - inverse[low]
    gap = np.where(low > 0, np.minimum(gap, over), gap)
    whole = squares[high + 1] - squares[low]
    group = np.where(gap > 0, whole / np.where(gap > 0, gap, 1.0), np.inf)
    at = np.arange(inverse.size)[:, None]
    mine = np.where((low <= at) & (at <= high), group, np.inf)
    return np.asarray(np.minimum(slack, mine.min(axis=1, initial=np.inf)))
