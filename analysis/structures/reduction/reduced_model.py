# SPDX-License-Identifier: MIT
"""A reduced structure, solved in about a millisecond, with an error bound."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.structures.reduction.dense_modes import (
    dense_modes_below,
    lowest_dense_modes,
)
from jointbench.analysis.structures.reduction.full_modes import frequency_of
from jointbench.analysis.structures.reduction.joint_spread import JointSpread
from jointbench.analysis.structures.reduction.residual_norm import ResidualNorm
from jointbench.analysis.structures.reduction.rigid_motions import unstrained

_Pairs = tuple[FloatArray, FloatArray]
"""Eigenvalues, the lowest first, and vectors as columns."""

# Extra modes solved, so that the last requested one has neighbours.
_SPARE = 4


@dataclass(frozen=True, slots=True, eq=False)
class ReducedModel:
    """Matrices of a structure in a basis valid for a whole box of joints.

    Attributes:
        stiffness: of the bodies, shape (r, r); the mass is the unit matrix.
        spread: of every joint and direction.
        loss: loss factor times stiffness, shape (r, r).
        damping: viscous, of the bodies [1/s], shape (r, r).
        residual: norm of what the basis leaves out.
        strains: of every joint and direction by the first coordinates, the motions
            without strain of the bodies; relative to the trace, shape (n_parameters,
            n_motions, n_motions) [-].
        shift: of the norm [1/s^2].
        box: smallest and largest valid stiffness [N/m].
        modes: number of accurate modes, rigid ones included.
        names: of the parameters.
        fixed_strain: of springs without parameters by the same motions, relative to the
            trace, shape (n_motions, n_motions) [-]; None is none.
        guess: motions near the lowest modes, shape (r, k): a start of their solution.
        held: `unstrained` where every joint is stiff.
    """

    stiffness: FloatArray
    spread: JointSpread
    loss: FloatArray
    damping: FloatArray
    residual: ResidualNorm
    strains: FloatArray
    shift: float
    box: tuple[float, float]
    modes: int
    names: tuple[str, ...]
    guess: FloatArray | None = None
    fixed_strain: FloatArray | None = None
    held: tuple[FloatArray, int] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "stiffness", "loss", "damping", "strains", "guess")
        freeze(self, "fixed_strain")
        held = self.unstrained(np.ones(self.strains.shape[0], bool))
        object.__setattr__(self, "held", held)

    @property
    def size(self) -> int:
        """Number of reduced degrees of freedom."""
        return int(self.stiffness.shape[0])

    def with_joints(self, stiffness: FloatArray) -> FloatArray:
        """Return reduced K(theta) [1/s^2], shape (r, r)."""
        values = np.asarray(stiffness, float)
        if values.shape != (len(self.names),) or not np.all(values >= 0):
            raise BadData(
                f"joint stiffnesses are {values.tolist()} N/m; give "
                f"{len(self.names)} values, none below zero"
            )
        return self.spread.total(values, self.stiffness)

    def unstrained(self, stiff: BoolArray) -> tuple[FloatArray, int]:
        """Rotate the rigid motions of the bodies: those that nothing strains first."""
        if self.fixed_strain is None:
            return unstrained(self.strains, stiff)
        strains = np.concatenate([self.strains, self.fixed_strain[None]])
        return unstrained(strains, np.append(stiff, True))

    def restricted(self, turn: FloatArray) -> "ReducedModel":
        """Return the model in fewer coordinates.

        Args:
            turn: orthonormal columns, shape (r, s); the motions without strain of the
                bodies stay the first coordinates.
        """
        return replace(
            self,
            stiffness=_between(self.stiffness, turn),
            spread=self.spread.restricted(turn),
            loss=_between(self.loss, turn),
            damping=_between(self.damping, turn),
            residual=self.residual.restricted(turn),
            guess=None,
        )


def _between(matrix: FloatArray, turn: FloatArray) -> FloatArray:
    small = turn.T @ matrix @ turn
    return np.asarray(0.5 * (small + small.T))


def motion_of(model: ReducedModel, shapes: FloatArray) -> FloatArray:
    """Return the motion of the mesh from reduced coordinates.

    Args:
        model: of bodies with a mesh.
        shapes: columns, shape (r, m).

    Returns:
        Over the degrees of freedom of all bodies, in their order, shape (n_free, m).
    """
    residual = model.residual
    whole = residual.turn @ shapes
    return np.concatenate(
        [
            body.basis @ whole[place]
            for body, place in zip(residual.components, residual.places, strict=True)
        ]
    )


def rows_of(model: ReducedModel, rows: FloatArray) -> FloatArray:
    """Return rows over the degrees of freedom in reduced coordinates.

    Args:
        model: of bodies with a mesh.
        rows: shape (n, n_free).

    Returns:
        Shape (n, r).
    """
    residual = model.residual
    wide = np.zeros((rows.shape[0], residual.turn.shape[0]))
    at = 0
    for body, place in zip(residual.components, residual.places, strict=True):
        size = body.basis.shape[0]
        wide[:, place] = rows[:, at : at + size] @ body.basis
        at += size
    return np.asarray(wide @ residual.turn)


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
    wanted = min(count or model.modes, model.size)

    def solve(matrix: FloatArray, start: FloatArray | None) -> _Pairs:
        missing = wanted - model.size + matrix.shape[0]
        if missing <= 0:
            return np.zeros(0), np.zeros((matrix.shape[0], 0))
        return lowest_dense_modes(matrix, model.shift, missing, start)

    return _solved(model, stiffness, solve, wanted)


def solve_below(
    model: ReducedModel, stiffness: FloatArray, limit: float
) -> ReducedModes:
    """Find the modes below a limit, as accurately as a basis needs them.

    Args:
        model: the reduced structure.
        stiffness: totals [N/m], shape (n_parameters,).
        limit: of the eigenvalues [1/s^2].

    Returns:
        All rigid modes, and the others below the limit.
    """

    def solve(matrix: FloatArray, start: FloatArray | None) -> _Pairs:
        if not matrix.size:
            return np.zeros(0), np.zeros((0, 0))
        return dense_modes_below(matrix, model.shift, limit, start)

    return _solved(model, stiffness, solve, model.size)


def _solved(
    model: ReducedModel,
    stiffness: FloatArray,
    solve: Callable[[FloatArray, FloatArray | None], _Pairs],
    most: int,
) -> ReducedModes:
    """Return rigid motions, then what `solve` finds among the others."""
    values = np.asarray(stiffness, float)
    matrix = model.with_joints(values)
    stiff = values > 0
    turn, rigid = model.held if stiff.all() else model.unstrained(stiff)
    if not rigid:
        level, shapes = solve(matrix, model.guess)
        return ReducedModes(level, frequency_of(level), shapes, 0)
    moved = turn.shape[0]
    matrix[:moved] = turn.T @ matrix[:moved]
    matrix[:, :moved] = matrix[:, :moved] @ turn
    level, shapes = solve(matrix[rigid:, rigid:], _turned(model.guess, turn, rigid))
    count = min(rigid + level.size, most)
    value, vector = np.zeros(count), np.eye(model.size, count)
    value[rigid:], vector[rigid:, rigid:] = level, shapes
    vector[:moved] = turn @ vector[:moved]
    return ReducedModes(value, frequency_of(value), vector, min(rigid, count))


def _turned(
    guess: FloatArray | None, turn: FloatArray, rigid: int
) -> FloatArray | None:
    """Return the guess in turned coordinates, without rigid motions."""
    if guess is None:
        return None
    moved = turn.shape[0]
    return np.concatenate([turn.T @ guess[:moved], guess[moved:]])[rigid:]


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
    norm = model.residual.of_modes(found.shapes, found.eigenvalue, stiffness)
    error = norm / np.sqrt(level)
    inverse = 1.0 / level
    slack = inverse_slack(inverse, error)
    lowest = 1.0 / (inverse + slack) - model.shift
    frequency = found.natural_frequency
    bound = np.where(frequency > 0, frequency - frequency_of(lowest), 0.0)
    return frequency[:wanted], bound[:wanted]


def inverse_slack(inverse: FloatArray, error: FloatArray) -> FloatArray:
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
