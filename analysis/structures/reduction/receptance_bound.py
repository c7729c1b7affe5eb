# SPDX-License-Identifier: MIT
"""Bound of the error of receptances of a reduced, damped assembly.

With A = K(theta) + s0 M and a basis V, the error of a receptance is r_a' S^-1 r_b: the
residuals of the responses to both loads, and the Schur complement S of the dynamic
stiffness Z on the motions that are A-orthogonal to V. There x'Kx - w^2 x'Mx is at least
(1 - (w^2 + s0) mu) x'Ax, as V holds the lowest modes, and dampers only add an imaginary
part. What these motions do to V and back is bounded pole by pole.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, freeze
from jointbench.analysis.structures.reduction.predict_modes import JointValues
from jointbench.analysis.structures.reduction.reduced_model import (
    ReducedModel,
    inverse_slack,
)
from jointbench.analysis.structures.reduction.residual_norm import Forces

# Rounding of a receptance, relative to the strain energy of the responses.
_ROUNDING = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class DampedSolution:
    """A damped assembly solved in its basis, in coordinates of undamped modes.

    The dynamic stiffness in these is diag(eigenvalue) + j loss + s damping + s^2.

    Attributes:
        model: over the basis.
        values: of its joints.
        eigenvalue: of all undamped modes [1/s^2], shape (n,).
        shapes: these modes as columns, orthonormal, shape (n, n).
        damping: viscous, of the joints alone [1/s], shape (n, n).
        modal_damping: viscous damping of each mode [1/s], shape (n,).
        structural: whether the loss factors of the bodies act as structural damping.
        poles: all of them, conjugates too [1/s], shape (n_poles,).
        vectors: of the poles, as columns, shape (n, n_poles).
    """

    model: ReducedModel
    values: JointValues
    eigenvalue: FloatArray
    shapes: FloatArray
    damping: FloatArray
    modal_damping: FloatArray
    structural: bool
    poles: ComplexArray
    vectors: ComplexArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "eigenvalue", "shapes", "damping", "modal_damping")
        freeze(self, "poles", "vectors")


def receptance_bound(
    solution: DampedSolution,
    load: tuple[int, slice],
    response: ComplexArray,
    lines: FloatArray,
) -> FloatArray:
    """Bound the error of receptances between the rows of one port.

    Args:
        solution: of the reduced equations.
        load: number of the body, and the columns of its patterns that are the port.
        response: modal coordinates of the responses to unit loads on these rows, shape
            (n, n_rows, n_lines).
        lines: angular frequencies [rad/s], shape (n_lines,).

    Returns:
        Largest size of the error of each receptance [m/N], shape (n_rows, n_rows,
        n_lines); infinity where the basis does not hold the modes around a line.
    """
    rest = _stability(solution, lines)
    size = _response_residual(solution, load, response, lines)
    safe = np.where(rest > 0.0, rest, np.nan)
    found = size[:, None] * size[None] / safe
    found = np.where(np.isnan(found), np.inf, found)
    level = solution.eigenvalue + solution.model.shift
    energy = np.sqrt(np.einsum("n,nrl->rl", level, np.abs(response) ** 2))
    return np.asarray(found + _ROUNDING * energy[:, None] * energy[None])


def _stability(solution: DampedSolution, lines: FloatArray) -> FloatArray:
    """Return a lower bound of the size of S in the norm of A [-], shape (n_lines,)."""
    outside = 1.0 - (lines**2 + solution.model.shift) * _largest_outside(solution)
    return np.asarray(outside - _coupling(solution, lines))


def _largest_outside(solution: DampedSolution) -> float:
    """Bound x'Mx / x'Ax for motions that are A-orthogonal to the basis [s^2].

    The first k modes of the basis and such a motion span k + 1 directions: by Cauchy
    their smallest Ritz value is below that of mode k + 1. No mode may be missing.
    """
    model, level = solution.model, solution.eigenvalue
    inverse = 1.0 / (level + model.shift)
    stiffness = solution.values.stiffness
    norm = model.residual.of_modes(solution.shapes, level, stiffness)
    slack = inverse_slack(inverse, norm * np.sqrt(inverse))
    squares = (norm * inverse**1.5) ** 2
    best = float(inverse[0])
    for k in range(1, inverse.size):
        above = inverse[k] + slack[k]
        gap = inverse[:k] - above
        if np.all(gap > 0.0):
            best = min(best, float(above + np.sum(squares[:k] / gap)))
    return best


def _coupling(solution: DampedSolution, lines: FloatArray) -> FloatArray:
    """Bound the norm of what the outside does to the basis and back, by poles [-].

    The inverse of the reduced dynamic stiffness is a sum of x x' / (s - p) over the
    poles; of Z(s) x the part outside of A V counts, a polynomial in s.
    """
    model, vectors, poles = solution.model, solution.vectors, solution.poles
    whole = solution.damping + np.diag(solution.modal_damping)
    slope = np.einsum("np,np->p", vectors, 2.0 * poles * vectors + whole @ vectors)
    still = _outside_norm(solution, vectors)
    moving = _outside_norm(
        solution, -(solution.modal_damping[:, None] * vectors), vectors
    )
    loss = np.zeros_like(still)
    if solution.structural and np.any(model.loss):
        loss = _loss_norm(solution, vectors)
    part = (model.shift + lines[:, None] ** 2) * still + lines[:, None] * moving + loss
    gain = np.abs(1j * lines[:, None] - poles) * np.abs(slope)
    return np.asarray((part**2 / np.maximum(gain, 1e-300)).sum(axis=1))


def _outside_norm(
    solution: DampedSolution, ritz: ComplexArray, damped: ComplexArray | None = None
) -> FloatArray:
    """Return the norm of residuals of modes and dampers outside of A V.

    Args:
        solution: of the reduced equations.
        ritz: factors of (K - lambda M) phi / (lambda + s0), modal coordinates, shape
            (n, m).
        damped: motion that moves the dampers of the joints, modal coordinates, shape
            (n, m).
    """
    values, level = solution.values, solution.eigenvalue[:, None]
    inverse = 1.0 / (level + solution.model.shift)
    still, heavy = inverse * ritz, -level * inverse * ritz
    springs = []
    turn = solution.model.residual.turn @ solution.shapes
    if damped is not None:
        back = inverse * (solution.damping @ damped)
        still, heavy = still - back, heavy - solution.model.shift * back
        springs.append((turn @ damped, values.damping[:, None]))
    motion, heavy = turn @ still, turn @ heavy
    if damped is not None:
        heavy = heavy + _own_damping(solution.model, turn @ damped)
    springs.append((motion, values.stiffness[:, None]))
    forces = Forces(motion, heavy, tuple(springs), ())
    return solution.model.residual.of_forces(forces, values.stiffness)


def _loss_norm(solution: DampedSolution, vectors: ComplexArray) -> FloatArray:
    """Return the norm of structural damping outside of A V."""
    model, values = solution.model, solution.values
    turn = model.residual.turn @ solution.shapes
    inside = solution.shapes.T @ (model.loss @ (solution.shapes @ vectors))
    back = turn @ (inside / (solution.eigenvalue[:, None] + model.shift))
    forces = Forces(
        _loss_factors(model)[:, None] * (turn @ vectors) - back,
        -model.shift * back,
        ((-back, values.stiffness[:, None]),),
        (),
    )
    return model.residual.of_forces(forces, values.stiffness)


def _own_damping(model: ReducedModel, motion: ComplexArray) -> ComplexArray:
    """Return the forces of the dampers of measured bodies, over their unit mass."""
    found = np.zeros_like(motion)
    for body, place in zip(
        model.residual.components, model.residual.places, strict=True
    ):
        if np.any(body.damping):
            found[place] = body.damping @ motion[place]
    return found


def _loss_factors(model: ReducedModel) -> FloatArray:
    """Return the loss factor of the body of each coordinate of the assembly [-]."""
    residual = model.residual
    found = np.zeros(residual.turn.shape[0])
    for body, place in zip(residual.components, residual.places, strict=True):
        found[place] = body.loss_factor
    return found


def _response_residual(
    solution: DampedSolution,
    load: tuple[int, slice],
    response: ComplexArray,
    lines: FloatArray,
) -> FloatArray:
    """Return the norm of the residual of each response, shape (n_rows, n_lines)."""
    model, values = solution.model, solution.values
    residual, count = model.residual, response.shape[1]
    s = np.tile(1j * lines, count)
    inside = response.reshape(response.shape[0], -1)
    turn = residual.turn @ solution.shapes
    motion = turn @ inside
    own = turn @ (solution.modal_damping[:, None] * inside)
    stretched = motion
    if solution.structural:
        stretched = (1.0 + 1j * _loss_factors(model))[:, None] * motion
    unit = np.repeat(np.eye(count), lines.size, axis=1)
    ties = values.stiffness[:, None] + s * values.damping[:, None]
    own = own + _own_damping(model, motion)
    forces = Forces(
        stretched,
        s**2 * motion + s * own,
        ((motion, ties),),
        ((load[0], load[1], -unit),),
    )
    norm = residual.of_forces(forces, values.stiffness).reshape(count, -1)
    return np.asarray(norm)
