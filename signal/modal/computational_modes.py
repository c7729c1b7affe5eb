# SPDX-License-Identifier: MIT
"""Computational modes: poles beyond the band, fitted but not reported.

The residual terms are polynomials; they represent distant modes but not the flank of a
mode just beyond the edge, and that error biases the modes within. So where the residual
at an edge exceeds the noise, a pole beyond it is fitted too.
"""

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.signal.modal.frf_lines import FrfLines
from jointbench.signal.modal.refined_pole_covariance import refine_poles

# Lines at an edge whose residual is tested for a pole beyond: share of the band.
_EDGE = 0.1
# Least residual power over noise that indicates one.
_EDGE_RESIDUAL = 1.2
# Start of the search: distance and decay rate as shares of the band.
_STARTS = ((0.03, 0.01), (0.1, 0.03), (0.3, 0.05))
# A computational mode is kept where it leaves less than this share of the excess.
_LEFT = 0.5


def find_beyond(
    lines: FrfLines,
    pole: ComplexArray,
    known: ComplexArray,
    residual: ComplexArray,
    noise: FloatArray,
    variance: FloatArray,
) -> ComplexArray:
    """Look for a pole beyond each edge at which the fit falls short.

    Args:
        lines: lines of the fit.
        pole: modes so far [rad/s], shape (n_modes,).
        known: poles beyond the band so far, shape (n,).
        residual: residual of a fit with both, shape (n_frf, n_lines).
        noise: noise variance of the lines, same shape.
        variance: noise and model error, same shape.

    Returns:
        `known` and at most one more pole at each edge.
    """
    for above in (False, True):
        if _has(lines, known, above=above):
            continue
        before = _edge_residual(lines, residual, noise, above=above)
        if before < _EDGE_RESIDUAL:
            continue
        more = np.append(known, _best_start(lines, pole, known, variance, above=above))
        after = refine_poles(
            lines, pole, variance, beyond=np.asarray(more, np.complex128), steps=12
        )
        gained = _edge_residual(lines, after.residual, noise, above=above)
        if gained - 1.0 < _LEFT * (before - 1.0):
            known, residual = after.beyond, after.residual
    return known


def _has(lines: FrfLines, known: ComplexArray, *, above: bool) -> bool:
    """Return whether there is a pole at that edge already."""
    middle = 0.5 * float(lines.laplace.imag[[0, -1]].sum())
    return bool(np.any((known.imag > middle) == above))


def _edge_residual(
    lines: FrfLines, residual: ComplexArray, noise: FloatArray, *, above: bool
) -> float:
    """Return the residual over the noise at an edge of the band [-]."""
    low, high = lines.laplace.imag[[0, -1]]
    if not above and low < _EDGE * high:
        return 0.0
    width = max(10, int(_EDGE * lines.laplace.size))
    edge = slice(-width, None) if above else slice(None, width)
    return float(np.mean(np.abs(residual[:, edge]) ** 2 / noise[:, edge]))


def _best_start(
    lines: FrfLines,
    pole: ComplexArray,
    known: ComplexArray,
    variance: FloatArray,
    *,
    above: bool,
) -> complex:
    """Return the start beyond an edge with the smallest residual."""
    low, high = lines.laplace.imag[[0, -1]]
    best, least = 0.0j, np.inf
    for distance, decay in _STARTS:
        away = distance * (high - low)
        omega = high + away if above else max(low - away, 0.5 * low)
        start = complex(-decay * (high - low), omega)
        beyond = np.asarray(np.append(known, start), np.complex128)
        found = refine_poles(lines, pole, variance, beyond=beyond, steps=0)
        left = float(np.sum(np.abs(found.residual) ** 2 / variance))
        if left < least:
            best, least = start, left
    return best
