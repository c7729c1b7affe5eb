# SPDX-License-Identifier: MIT
"""Poles refined by nonlinear least squares (variable projection), with covariance.

LSCF minimises an equation error, which biases damping where noise is strong. From its
poles a few Gauss-Newton steps on the output error remove that: residues and residual
terms are solved for inside every step, so that only the poles are searched (Golub and
Pereyra; Kaufman's Jacobian). With per-line variances this is maximum likelihood.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.arrays import BoolArray, ComplexArray, FloatArray
from jointbench.signal.lsfd import (
    Lines,
    measured_width,
    modal_basis,
    modal_size,
    solve_gram,
    stacked,
    unstacked,
)

# Stop when no pole moves by more than this share of its own half-power width.
_SMALL_STEP = 1e-4
# A pole that leaves its start by this many half-power half-widths is lost, not refined.
_LEASH = 1.0
_LEASH_DAMPING = 10.0
# LSCF is trusted to within this share of the half-power half-width.
_TRUST = 0.15
# Damping of the step beyond which it is the pole that is wrong, not the step.
_PATIENCE = 1.0
_STUCK = 1e6


@dataclass(frozen=True, slots=True, eq=False)
class RefinedPoles:
    """Poles at the least-squares optimum.

    Attributes:
        pole: [rad/s], shape (n_modes,).
        covariance: of (Re p, Im p) of each pole [rad^2/s^2] if the variances handed in
            are right, shape (n_modes, 2, 2).
        inflation: factor by which the residual around each pole exceeds those
            variances, correlation between lines included, at least 1; shape (n_modes,).
        converged: False for a pole that ran away and was put back where it started,
            and for all if the steps ran out; shape (n_modes,).
    """

    pole: ComplexArray
    covariance: FloatArray
    inflation: FloatArray
    converged: BoolArray


@dataclass(frozen=True, slots=True, eq=False)
class _Point:
    """Cost and normal equations at one set of poles."""

    cost: float
    gram: FloatArray
    gradient: FloatArray
    residual: ComplexArray


@dataclass(frozen=True, slots=True, eq=False)
class _Prior:
    """Where LSCF put the poles, and how much that weighs.

    Modes that overlap closely can trade damping for residue at no cost in misfit; only
    the start then tells them apart. Where the lines say anything, they win.
    """

    start: ComplexArray
    weight: FloatArray

    def cost(self, pole: ComplexArray) -> float:
        """Return the weighted squared distance from the start."""
        return float(self.weight @ np.abs(pole - self.start) ** 2)


def refine_poles(
    lines: Lines,
    start: ComplexArray,
    variance: FloatArray,
    *,
    doubt: FloatArray | None = None,
    begin: ComplexArray | None = None,
    steps: int = 30,
) -> RefinedPoles:
    """Refine poles by Levenberg-Marquardt on the output error.

    Args:
        lines: what is fitted.
        start: poles that the answer may not leave [rad/s], shape (n_modes,).
        variance: E|error|^2 of each line, shape (n_frf, n_lines).
        doubt: inflation met in an earlier fit, shape (n_modes,): the start weighs that
            much more against lines that were wrong by as much; None for 1.
        begin: where the search begins, if an earlier one came close; None for `start`.
        steps: most evaluations; 0 keeps the start and only tells its covariance.

    Returns:
        Refined poles; those that ran away stand where they started.

    Source:
        Golub and Pereyra, Inverse Problems 19 (2003) R1; Kaufman, BIT 15 (1975) 49.
    """
    pole = start.copy() if begin is None else begin.copy()
    free, damping = np.ones(start.size, bool), 1e-3
    here, settled = _evaluate(lines, pole, variance), False
    doubt = np.ones(start.size) if doubt is None else doubt
    prior = _Prior(start, doubt / (_TRUST * measured_width(lines, start)) ** 2)
    for _ in range(steps):
        trial = pole + np.where(free, _step(here, prior, pole, free, damping), 0.0)
        lost = _lost(lines, trial, start)
        if lost.any() and damping > _PATIENCE:
            pole, free, damping = np.where(lost, start, pole), free & ~lost, 1e-3
            here = _evaluate(lines, pole, variance)
            continue
        there = None if lost.any() else _evaluate(lines, trial, variance)
        if there is None or there.cost + prior.cost(trial) > here.cost + prior.cost(
            pole
        ):
            damping *= 10.0
            settled = damping > _STUCK
        else:
            moved = np.abs(trial - pole) / measured_width(lines, pole)
            pole, here, damping = trial, there, max(damping / 10.0, 1e-9)
            settled = bool(np.all(moved < _SMALL_STEP))
        if settled:
            break
    return RefinedPoles(
        pole,
        _pole_covariance(here),
        _inflation(lines, pole, here.residual, variance),
        free & settled,
    )


def _evaluate(lines: Lines, pole: ComplexArray, variance: FloatArray) -> _Point:
    """Project the residues out and return cost, gradient and Gauss-Newton matrix.

    The slopes with respect to a pole are the same two columns for every FRF, turned and
    scaled by its residue, so that one weighted product of fixed columns serves an FRF.
    """
    n_linear, n_poles = modal_size(pole), 2 * pole.size
    columns = stacked(np.hstack((modal_basis(lines, pole), _pole_slopes(lines, pole))))
    gram, gradient, cost = np.zeros((n_poles, n_poles)), np.zeros(n_poles), 0.0
    residual = np.empty_like(lines.response)
    for i, (response, noise) in enumerate(zip(lines.response, variance, strict=True)):
        weight = np.tile(np.sqrt(2.0 / noise), 2)
        weighted = columns * weight[:, None]
        products = weighted.T @ weighted
        target = stacked(response) * weight
        solved, inverse = solve_gram(
            products[:n_linear, :n_linear], weighted[:, :n_linear].T @ target
        )
        error = target - weighted[:, :n_linear] @ solved
        turn = _turn(solved[:n_poles])
        overlap = products[:n_linear, n_linear:] @ turn
        gram += turn.T @ products[n_linear:, n_linear:] @ turn
        gram -= overlap.T @ inverse @ overlap
        # The error is orthogonal to the linear columns: the projection drops out.
        gradient += turn.T @ (weighted[:, n_linear:].T @ error)
        cost += float(error @ error)
        residual[i] = unstacked(error / weight)
    return _Point(cost, gram, gradient, residual)


def _pole_slopes(lines: Lines, pole: ComplexArray) -> ComplexArray:
    """Return d/dp of the two columns of each pole, shape (n_lines, 2 n_modes)."""
    s, power = lines.laplace[:, None], (lines.laplace**lines.derivatives)[:, None]
    own, mirrored = power / (s - pole) ** 2, power / (s - pole.conj()) ** 2
    slopes = np.empty((own.shape[0], 2 * pole.size), complex)
    slopes[:, ::2] = own + mirrored
    slopes[:, 1::2] = 1j * (own - mirrored)
    return slopes


def _turn(residue: FloatArray) -> FloatArray:
    """Return the block-diagonal matrix that makes slopes of (Re p, Im p).

    With R = a + j b: d/d Re p is a times the first column plus b times the second,
    d/d Im p is a times the second minus b times the first.
    """
    size = residue.size
    turn, even = np.zeros((size, size)), np.arange(0, size, 2)
    turn[even, even] = turn[even + 1, even + 1] = residue[::2]
    turn[even + 1, even] = residue[1::2]
    turn[even, even + 1] = -residue[1::2]
    return turn


def _step(
    here: _Point, prior: _Prior, pole: ComplexArray, free: BoolArray, damping: float
) -> ComplexArray:
    """Return the Levenberg-Marquardt step of the free poles."""
    movable, weight = np.repeat(free, 2), np.repeat(prior.weight, 2)
    gram = here.gram + np.diag(weight)
    gram = np.where(np.outer(movable, movable), gram, 0.0)
    gram += np.diag(damping * np.diag(gram) + ~movable)
    away = (prior.start - pole).view(np.float64)
    change, _ = solve_gram(gram, np.where(movable, here.gradient + weight * away, 0.0))
    return np.asarray(change.view(np.complex128))


def _lost(lines: Lines, pole: ComplexArray, start: ComplexArray) -> BoolArray:
    """Tell which poles are no longer damped, or no longer those they started as."""
    ratio = pole.real / start.real
    before, now = measured_width(lines, start), measured_width(lines, pole)
    astray: BoolArray = np.abs((pole - start).imag) > _LEASH * np.maximum(before, now)
    astray |= (ratio < 1.0 / _LEASH_DAMPING) | (ratio > _LEASH_DAMPING)
    return astray


def _pole_covariance(here: _Point) -> FloatArray:
    """Return the covariance of each (Re p, Im p), shape (n_modes, 2, 2)."""
    _, inverse = solve_gram(here.gram, here.gradient)
    # Rounding can leave a variance of exact data below zero.
    np.fill_diagonal(inverse, np.maximum(np.diag(inverse), 0.0))
    index = np.arange(here.gradient.size).reshape(-1, 2)
    return np.asarray(inverse[index[:, :, None], index[:, None, :]])


def _inflation(
    lines: Lines, pole: ComplexArray, residual: ComplexArray, variance: FloatArray
) -> FloatArray:
    """Compare the residual around each pole with the variances it was given."""
    standard = residual / np.sqrt(variance)
    omega = lines.laplace.imag
    pitch = float(np.median(np.diff(omega)))
    factors = []
    for p, width in zip(pole, measured_width(lines, pole), strict=True):
        reach = max(4.0 * width, 10.0 * pitch)
        around = standard[:, np.abs(omega - p.imag) < reach]
        power = float(np.mean(np.abs(around) ** 2)) if around.size else 1.0
        factors.append(max(1.0, power * _correlation_length(around)))
    return np.array(factors)


def _correlation_length(residual: ComplexArray) -> float:
    """Return how many neighbouring lines carry one independent error, 1 or more."""
    power = float(np.sum(np.abs(residual) ** 2))
    if residual.shape[1] < 3 or power == 0.0:
        return 1.0
    shared = np.sum(residual[:, 1:] * residual[:, :-1].conj()).real / power
    share = min(max(float(shared), 0.0), 0.99)
    return (1.0 + share) / (1.0 - share)
