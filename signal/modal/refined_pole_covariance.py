# SPDX-License-Identifier: MIT
"""Poles refined by nonlinear least squares (variable projection), with covariance.

LSCF minimises an equation error, which biases damping where noise is strong. A few
Gauss-Newton steps on the output error, started from its poles, remove the bias:
residues and residual terms are solved for inside every step, so that only the poles are
searched (Golub and Pereyra; Kaufman's Jacobian). With per-line variances this is
maximum likelihood.
"""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    squared_size,
)
from jointbench.signal.modal.frf_lines import FrfLines, measured_width
from jointbench.signal.modal.line_noise import residual_around
from jointbench.signal.modal.lsfd import LinearFit, wald_significance
from jointbench.signal.modal.normal_equations import (
    combined,
    correlations,
    gram_matrices,
    inverses,
)
from jointbench.signal.modal.pole_columns import basis_and_slopes, modal_size
from jointbench.signal.modal.pole_limits import PolePrior, kept_beyond, lost_poles

# Stop when no pole moves by more than this share of its own half-power width.
_SMALL_STEP = 1e-4
# ... and chi-squared falls by less than this, in units of what is left.
_SMALL_GAIN = 0.05
# Where others still move, a pole that moved less than this has converged.
_SETTLED = 1e-2
# Damping of the step above which the pole is dropped instead.
_PATIENCE = 1.0
# Damping up to which a step is that of Gauss and Newton, chi-squared of a value up to
# which the residual is noise, a step that is small over the half-power half-width, and
# what it may leave of a standard deviation: then the optimum is one step away.
_NEWTON, _NOISE_ONLY, _NEAR, _NEGLIGIBLE = 1e-3, 1.5, 1e-3, 1e-2
# The same where another refinement follows.
_ROUGHLY_NEAR, _ROUGHLY = 3e-2, 1.0
_STUCK = 1e6


@dataclass(frozen=True, slots=True, eq=False)
class Linearised:
    """Poles and residues around the optimum, to first order.

    Attributes:
        poles: covariance of (Re p, Im p) of all poles, shape (2 n_modes, 2 n_modes).
        residue_noise: covariance of (Re R, Im R) of all residues of an FRF at fixed
            poles, shape (n_frf, 2 n_modes, 2 n_modes).
        residue_slope: their change with (Re p, Im p), same shape.
    """

    poles: FloatArray
    residue_noise: FloatArray
    residue_slope: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class RefinedPoles:
    """Poles at the least-squares optimum.

    Attributes:
        pole: [rad/s], shape (n_modes,).
        covariance: of (Re p, Im p) of each pole [rad^2/s^2] if the given variances are
            right, shape (n_modes, 2, 2).
        inflation: residual around each pole over those variances, correlation between
            lines included; about 1 where they are right, less where they are too
            large; shape (n_modes,).
        converged: False for a pole that diverged and was reset to its start, and for
            all if the iteration limit was reached; shape (n_modes,).
        linearised: how residues depend on poles, computational poles last.
        beyond: computational poles after the refinement [rad/s], shape (n,).
        residual: measured less fitted FRF, shape (n_frf, n_lines).
        fit: residues of modes and computational poles, with these variances.
    """

    pole: ComplexArray
    covariance: FloatArray
    inflation: FloatArray
    converged: BoolArray
    linearised: Linearised
    beyond: ComplexArray
    residual: ComplexArray
    fit: LinearFit


@dataclass(frozen=True, slots=True, eq=False)
class _Point:
    """Cost and normal equations at one set of poles.

    Residues and residual terms follow the poles: `residue_noise` is the covariance of
    residues at fixed poles, shape (n_frf, 2 n_modes, 2 n_modes), `slope` the change of
    all coefficients with (Re p, Im p), shape (n_frf, n_linear, 2 n_modes).
    """

    cost: float
    gram: FloatArray
    gradient: FloatArray
    residual: ComplexArray
    coefficients: FloatArray
    residue_noise: FloatArray
    slope: FloatArray


def refine_poles(
    lines: FrfLines,
    start: ComplexArray,
    variance: FloatArray,
    *,
    beyond: ComplexArray | None = None,
    doubt: FloatArray | None = None,
    begin: ComplexArray | None = None,
    steps: int = 30,
    rough: bool = False,
) -> RefinedPoles:
    """Refine poles by Levenberg-Marquardt on the output error.

    Args:
        lines: lines of the fit.
        start: poles from which the result may not diverge [rad/s], shape (n_modes,).
        variance: E|error|^2 of each line, shape (n_frf, n_lines).
        beyond: computational poles outside the band, free as long as they stay outside
            [rad/s], shape (n,), or None.
        doubt: inflation found in an earlier fit, shape (n_modes,): the weight of the
            start grows with it; inf holds a pole at its start; None for 1.
        begin: start of the search from an earlier fit; None for `start`.
        steps: most evaluations; 0 keeps the start and only returns its covariance.
        rough: whether the poles may be a standard deviation from the optimum, because
            another refinement follows.

    Returns:
        Refined poles; those that diverged are reset to their start.

    Source:
        Golub and Pereyra, Inverse Problems 19 (2003) R1; Kaufman, BIT 15 (1975) 49.
    """
    n_modes = start.size
    extra = np.empty(0, complex) if beyond is None else beyond
    prior = PolePrior.around(lines, start, extra, 1.0 if doubt is None else doubt)
    pole = np.append(start if begin is None else begin, extra)
    near = (_ROUGHLY_NEAR, _ROUGHLY) if rough else (_NEAR, _NEGLIGIBLE)
    pole, here, converged = _search(lines, prior, pole, variance, steps, near)
    joint = _joint_covariance(here, prior)
    own = pole[:n_modes]
    return RefinedPoles(
        own,
        _own_blocks(joint)[:n_modes],
        residual_around(lines, own, here.residual, variance),
        converged[:n_modes],
        Linearised(joint, here.residue_noise, here.slope[:, : 2 * pole.size]),
        pole[n_modes:],
        here.residual,
        LinearFit(
            here.coefficients,
            lines.response - here.residual,
            wald_significance(here.coefficients, here.residue_noise, pole.size),
        ),
    )


def _search(
    lines: FrfLines,
    prior: PolePrior,
    pole: ComplexArray,
    variance: FloatArray,
    steps: int,
    near: tuple[float, float],
) -> tuple[ComplexArray, _Point, BoolArray]:
    """Return the poles at the optimum, their cost terms, and which converged.

    `near` limits the last step and what it leaves, see `_is_last`.
    """
    free, damping = ~prior.pinned, 1e-3
    here, settled = _evaluate(lines, pole, variance), False
    moved = np.full(pole.size, np.inf)
    for _ in range(steps):
        trial, gain = _stepped(here, prior, pole, free, damping)
        trial[prior.n_modes :] = kept_beyond(lines, prior, pole, trial)
        lost = lost_poles(lines, trial, prior)
        if damping <= _NEWTON and not lost.any():
            moved = np.abs(trial - pole) / measured_width(lines, pole)
            if _is_last(moved, gain, here, near):
                return trial, _moved_on(lines, here, pole, trial - pole), free
        if lost.any() and damping > _PATIENCE:
            pole, free = np.where(lost, prior.start, pole), free & ~lost
            here, damping = _evaluate(lines, pole, variance), 1e-3
            continue
        there = None if lost.any() else _evaluate(lines, trial, variance)
        if there is None or there.cost + prior.cost(trial) > here.cost + prior.cost(
            pole
        ):
            damping *= 10.0
            settled = damping > _STUCK
        else:
            moved = np.abs(trial - pole) / measured_width(lines, pole)
            settled = _is_small(moved, here.cost - there.cost, there, prior)
            pole, here, damping = trial, there, max(damping / 10.0, 1e-9)
        if settled:
            break
    return pole, here, free & (settled | (moved < _SETTLED))


def _is_small(moved: FloatArray, gain: float, here: _Point, prior: PolePrior) -> bool:
    """Return whether a step changes nothing that the noise would not.

    Args:
        moved: by each pole, over its half-power half-width.
        gain: of chi-squared.
        here: one end of the step.
        prior: knows which poles are modes.
    """
    unit = max(1.0, here.cost / (2.0 * here.residual.size))
    slight = bool(np.all(moved[: prior.n_modes] < _SMALL_STEP))
    return slight and gain < _SMALL_GAIN * unit


def _is_last(
    moved: FloatArray, gain: float, here: _Point, near: tuple[float, float]
) -> bool:
    """Return whether the optimum is one Gauss-Newton step away.

    What a step leaves is about its square, both over the half-power half-width, where
    the residual is noise; over the standard deviation of the pole, which is the step
    over the root of its gain, that is the step times that root.
    """
    unit = here.cost / (2.0 * here.residual.size)
    largest = float(np.max(moved, initial=0.0))
    left = largest * np.sqrt(max(gain, 0.0))
    return bool(unit < _NOISE_ONLY and largest < near[0] and left < near[1])


def _moved_on(
    lines: FrfLines, here: _Point, pole: ComplexArray, change: ComplexArray
) -> _Point:
    """Return the point after the last step, to first order."""
    step = change.view(np.float64)
    turn = slope_turns(here.coefficients[:, : step.size])
    coefficients = here.coefficients + here.slope @ step
    both = np.hstack((coefficients, turn @ step))
    fitted = combined(both, basis_and_slopes(lines, pole))
    return replace(here, coefficients=coefficients, residual=lines.response - fitted)


def _evaluate(lines: FrfLines, pole: ComplexArray, variance: FloatArray) -> _Point:
    """Project the residues out and return cost, gradient and Gauss-Newton matrix.

    The derivatives with respect to a pole are the same two columns for every FRF,
    rotated and scaled by its residue, so that each FRF needs one weighted product of
    fixed columns.
    """
    n_linear, n_poles = modal_size(lines, pole), 2 * pole.size
    columns = basis_and_slopes(lines, pole)
    weight = 2.0 / variance
    products = gram_matrices(columns, weight)
    inverse = inverses(products[:, :n_linear, :n_linear])
    right = correlations(columns[:, :n_linear], weight * lines.response)
    solved = (inverse @ right[:, :, None])[:, :, 0]
    residual = lines.response - combined(solved, columns[:, :n_linear])
    turn = slope_turns(solved[:, :n_poles])
    overlap = products[:, :n_linear, n_linear:] @ turn
    gram = _transposed(turn) @ products[:, n_linear:, n_linear:] @ turn
    gram -= _transposed(overlap) @ inverse @ overlap
    # The error is orthogonal to the linear columns: the projection drops out.
    slope = correlations(columns[:, n_linear:], weight * residual)
    return _Point(
        cost=float(np.vdot(weight, squared_size(residual))),
        gram=np.sum(gram, axis=0),
        gradient=np.einsum("fij,fi->j", turn, slope),
        residual=residual,
        coefficients=solved,
        residue_noise=inverse[:, :n_poles, :n_poles],
        slope=-(inverse @ overlap),
    )


def _transposed(matrices: FloatArray) -> FloatArray:
    return matrices.transpose(0, 2, 1)


def slope_turns(residue: FloatArray) -> FloatArray:
    """Return for each FRF the block-diagonal matrix that makes slopes of (Re p, Im p).

    With R = a + j b: d/d Re p is a times the first column plus b times the second,
    d/d Im p is a times the second minus b times the first.
    """
    n_frf, size = residue.shape
    turn, even = np.zeros((n_frf, size, size)), np.arange(0, size, 2)
    turn[:, even, even] = turn[:, even + 1, even + 1] = residue[:, ::2]
    turn[:, even + 1, even] = residue[:, 1::2]
    turn[:, even, even + 1] = -residue[:, 1::2]
    return turn


def _stepped(
    here: _Point, prior: PolePrior, pole: ComplexArray, free: BoolArray, damping: float
) -> tuple[ComplexArray, float]:
    """Return the poles after a Levenberg-Marquardt step, and its gain to first order.

    Poles that are not free stay.
    """
    movable, weight = np.repeat(free, 2), np.repeat(prior.weight, 2)
    gram = here.gram + np.diag(weight)
    gram = np.where(np.outer(movable, movable), gram, 0.0)
    gram += np.diag(damping * np.diag(gram) + ~movable)
    away = (prior.start - pole).view(np.float64)
    force = np.where(movable, here.gradient + weight * away, 0.0)
    change = np.where(movable, inverses(gram) @ force, 0.0)
    return pole + change.view(np.complex128), float(force @ change)


def _joint_covariance(here: _Point, prior: PolePrior) -> FloatArray:
    """Return the covariance of all (Re p, Im p), with the prior of the start.

    Pinned poles have none.
    """
    free = np.repeat(~prior.pinned, 2)
    gram = here.gram + np.diag(np.repeat(prior.weight, 2))
    held = np.outer(free, free)
    gram = np.where(held, gram, np.diag(~free))
    inverse = inverses(gram)
    variance = np.diag(inverse)
    if np.any(variance <= 0.0):
        bounded = _bounded_inverse(gram)
        more = np.maximum(variance - np.diag(bounded), 0.0)
        inverse = bounded + np.diag(more)
    return np.where(held, inverse, 0.0)


def _bounded_inverse(gram: FloatArray) -> FloatArray:
    """Invert a matrix of which rounding has left an eigenvalue below zero.

    That direction of poles nearly at one place is known no better than rounding: the
    size of the eigenvalue stands for it, so that no variance is zero.
    """
    scale = np.sqrt(np.maximum(np.abs(np.diag(gram)), np.finfo(float).tiny))
    value, turn = np.linalg.eigh(gram / np.outer(scale, scale))
    size = np.maximum(np.abs(value), np.finfo(float).eps * np.abs(value).max())
    return np.asarray((turn / size) @ turn.T / np.outer(scale, scale))


def _own_blocks(joint: FloatArray) -> FloatArray:
    """Return the 2 x 2 block of each pole, shape (n_modes, 2, 2)."""
    index = np.arange(joint.shape[0]).reshape(-1, 2)
    return np.asarray(joint[index[:, :, None], index[:, None, :]])
