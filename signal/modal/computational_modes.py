# SPDX-License-Identifier: MIT
"""Computational modes: poles beyond the band, fitted but not reported.

The residual terms are polynomials; they represent distant modes but not the flank of a
mode just beyond the edge, and that error biases the modes within. So where the residual
at an edge exceeds the noise, poles beyond it are fitted too, one after the other.
"""

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.signal.modal.local_fit import Group, WholeFit, group_around
from jointbench.signal.modal.lsfd import fit_residues
from jointbench.signal.modal.refined_pole_covariance import refine_poles, unresolved

# Lines at an edge whose residual is tested for a pole beyond: share of the band.
_EDGE = 0.1
# Modes up to which poles beyond are fitted on all lines; else on this share of them.
_FEW_MODES, _REACH = 16, 0.4
# Least residual power over noise that indicates one.
_EDGE_RESIDUAL = 1.2
# Start of the search: distance and decay rate as shares of the band.
_STARTS = ((0.01, 0.005), (0.03, 0.01), (0.1, 0.03), (0.3, 0.05))
# A computational mode is kept where it leaves less than this share of the excess.
_LEFT = 0.5
# Poles added beyond one edge, at most.
_MOST = 4
_STEPS = 12


def find_beyond(whole: WholeFit) -> ComplexArray:
    """Look for poles beyond each edge at which the fit falls short.

    Args:
        whole: fit of all lines with modes and poles beyond the band so far.

    Returns:
        The poles beyond the band so far, and up to four more at each edge.
    """
    lines = whole.lines
    low, high = lines.laplace.imag[[0, -1]]
    width = max(10, int(_EDGE * lines.laplace.size))
    known = whole.pole[whole.n_modes :]
    for above in (False, True):
        edge = slice(-width, None) if above else slice(None, width)
        # There are no modes below a band that begins next to zero.
        if not above and low < _EDGE * high:
            continue
        if _excess(whole.residual, whole.noise, edge) < _EDGE_RESIDUAL:
            continue
        reach = (1.0 if whole.n_modes <= _FEW_MODES else _REACH) * (high - low)
        place = high if above else low
        group = group_around(whole, place, 1.01 * reach, with_beyond=True)
        # A group replaces the poles that it held.
        known = known[~np.isin(known, whole.pole[group.beyond])]
        known = np.append(known, _beyond_edge(whole, group, edge, above=above))
    return known


def _beyond_edge(
    whole: WholeFit, group: Group, edge: slice, *, above: bool
) -> ComplexArray:
    """Add poles beyond an edge to those of a group while each explains the residual."""
    pole, beyond = whole.pole[group.modes], whole.pole[group.beyond]
    fitted = refine_poles(
        group.lines, pole, group.variance, beyond=beyond, steps=_STEPS
    )
    before = _excess(fitted.residual, group.noise, edge)
    for _ in range(_MOST):
        if before < _EDGE_RESIDUAL:
            break
        start = _best_start(whole, group, fitted.pole, fitted.beyond, above=above)
        trial = refine_poles(
            group.lines,
            fitted.pole,
            group.variance,
            beyond=np.append(fitted.beyond, start),
            steps=_STEPS,
        )
        after = _excess(trial.residual, group.noise, edge)
        outside = unresolved(whole.lines, trial.beyond).all()
        if not outside or after - 1.0 > _LEFT * (before - 1.0):
            break
        fitted, before = trial, after
    return fitted.beyond


def _excess(residual: ComplexArray, noise: FloatArray, edge: slice) -> float:
    """Return the residual over the noise at an edge of the band [-]."""
    return float(np.mean(np.abs(residual[:, edge]) ** 2 / noise[:, edge]))


def _best_start(
    whole: WholeFit,
    group: Group,
    pole: ComplexArray,
    known: ComplexArray,
    *,
    above: bool,
) -> complex:
    """Return the start beyond an edge with the smallest residual."""
    low, high = whole.lines.laplace.imag[[0, -1]]
    best, least = 0.0j, np.inf
    for distance, decay in _STARTS:
        away = distance * (high - low)
        omega = high + away if above else max(low - away, 0.5 * low)
        start = complex(-decay * (high - low), omega)
        everything = np.concatenate((pole, known, [start]))
        fit = fit_residues(group.lines, everything, group.variance)
        left = np.abs(group.lines.response - fit.synthesis) ** 2 / group.variance
        if float(np.sum(left)) < least:
            best, least = start, float(np.sum(left))
    return best
