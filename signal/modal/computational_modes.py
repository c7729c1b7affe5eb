# SPDX-License-Identifier: MIT
"""Computational modes: poles beyond the band, fitted but not reported.

Lines that were left out within the band, as at a null of the force, leave a gap; what
is in it is beyond the band as well.

The residual terms are polynomials; they represent distant modes but not the flank of a
mode just beyond the edge, and that error biases the modes within. So one more pole is
tried at many places beyond each edge. The likeliest is refined together with the modes
and kept where the fit needs it, and then the next is tried.
"""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, IntArray
from jointbench.signal.modal.frf_lines import FrfLines, gaps_of
from jointbench.signal.modal.pole_limits import unresolved
from jointbench.signal.modal.refined_pole_covariance import RefinedPoles, refine_poles
from jointbench.signal.modal.residual_search.local_fit import (
    Group,
    WholeFit,
    group_around,
    residue_scale,
    try_poles,
)

# Lines at an edge whose residual is compared with the noise: share of the band.
_EDGE = 0.1
# Modes up to which poles beyond are fitted on all lines; else on this share of them.
_FEW_MODES, _REACH = 16, 0.4
# FRFs on which places are compared, those with the largest residual at the edge.
_FEW_FRFS = 4
# Places: distance from the edge and decay rate, as shares of the band.
_DISTANCES = (0.004, 0.01, 0.02, 0.04, 0.07, 0.12, 0.2, 0.3)
_DECAYS = (0.004, 0.012, 0.03)
# Places in a gap of the lines and their decay rates, as shares of the gap.
_WITHIN, _DECAYS_WITHIN = (0.2, 0.35, 0.5, 0.65, 0.8), (0.01, 0.05, 0.15)
# Log Bayes factor from which a place is refined.
_LEAST_EVIDENCE = 2.0
# Places refined, until one is needed; distance of two poles over the sum of their decay
# rates, below which they are one.
_STARTS, _ONE_POLE = 3, 0.1
# A pole is kept where chi-squared falls by this many times its unknowns, in units of
# what it leaves.
_GAIN = 3.0
# Residual power over the noise up to which that suffices; else a pole must leave less
# than this share of what exceeds the noise at the edges.
_ADMISSIBLE, _LEFT = 4.0, 0.5
# Poles added at once, at most.
_MOST = 5
_STEPS = 15


def find_beyond(whole: WholeFit) -> ComplexArray:
    """Look for poles beyond each edge at which the fit falls short.

    Args:
        whole: fit of all lines with modes and poles beyond the band so far.

    Returns:
        The poles beyond the band so far, and further ones.
    """
    low, high = whole.lines.laplace.imag[[0, -1]]
    known = whole.pole[whole.n_modes :]
    if whole.n_modes == 0:
        return known
    # There are no modes below a band that begins next to zero.
    edges = (True,) if low < _EDGE * high else (True, False)
    if whole.n_modes <= _FEW_MODES:
        group = group_around(whole, high, 1.01 * (high - low), with_beyond=True)
        return _beyond_edges(whole, group, edges)
    for above in edges:
        reach = 1.01 * _REACH * (high - low)
        group = group_around(whole, high if above else low, reach, with_beyond=True)
        # A group replaces the poles that it held.
        known = known[~np.isin(known, whole.pole[group.beyond])]
        known = np.append(known, _beyond_edges(whole, group, (above,)))
    return known


def _beyond_edges(
    whole: WholeFit, group: Group, edges: tuple[bool, ...]
) -> ComplexArray:
    """Add poles beyond edges to those of a group while the fit needs them."""
    pole, beyond = whole.pole[group.modes], whole.pole[group.beyond]
    fitted: RefinedPoles | None = None
    rows = _rows(whole, edges)
    for _ in range(_MOST):
        starts = _starts(whole, group, np.append(pole, beyond), rows, edges)
        if starts.size == 0:
            break
        fitted = fitted or _refined(group, pole, beyond)
        better = _first_needed(whole, group, fitted, starts, edges)
        if better is None:
            break
        fitted, pole, beyond = better, better.pole, better.beyond
    return beyond


def _first_needed(
    whole: WholeFit,
    group: Group,
    fitted: RefinedPoles,
    starts: ComplexArray,
    edges: tuple[bool, ...],
) -> RefinedPoles | None:
    """Return the fit with the first further pole that it needs, or None."""
    for start in starts:
        trial = _refined(group, fitted.pole, np.append(fitted.beyond, start))
        outside = unresolved(whole.lines, trial.beyond).all()
        if outside and _apart(trial.beyond) and _gained(group, fitted, trial, edges):
            return trial
    return None


def _apart(pole: ComplexArray) -> bool:
    """Return whether no two poles are one."""
    size = -pole.real
    away = np.abs(pole[:, None] - pole) / (size[:, None] + size)
    return bool(np.all(away[np.triu_indices(pole.size, 1)] > _ONE_POLE))


def _refined(group: Group, pole: ComplexArray, beyond: ComplexArray) -> RefinedPoles:
    return refine_poles(group.lines, pole, group.variance, beyond=beyond, steps=_STEPS)


def _gained(
    group: Group, before: RefinedPoles, after: RefinedPoles, edges: tuple[bool, ...]
) -> bool:
    """Return whether chi-squared falls by more than the unknowns of a pole explain."""
    first, left = (f.residual / np.sqrt(group.variance) for f in (before, after))
    unit = max(1.0, float(np.mean(np.abs(left) ** 2)))
    gain = 2.0 * float(np.sum(np.abs(first) ** 2 - np.abs(left) ** 2)) / unit
    explained = gain > _GAIN * (2 * group.variance.shape[0] + 2)
    return bool(explained) and _admissible(group, before, after, edges)


def _admissible(
    group: Group, before: RefinedPoles, after: RefinedPoles, edges: tuple[bool, ...]
) -> bool:
    """Return whether a fit leaves little, or at the edges half of what it left.

    Leakage and nonlinear structures leave residuals that no pole beyond explains.
    """
    if float(np.mean(np.abs(after.residual) ** 2 / group.noise)) < _ADMISSIBLE:
        return True
    outer = _outer(group.lines, edges)
    ratio = [
        float(np.mean(np.abs(f.residual[:, outer]) ** 2 / group.noise[:, outer]))
        for f in (before, after)
    ]
    return ratio[1] - 1.0 < _LEFT * (ratio[0] - 1.0)


def _rows(whole: WholeFit, edges: tuple[bool, ...]) -> IntArray:
    """Return the FRFs whose residual at the edges is largest."""
    ratio = np.abs(whole.residual) ** 2 / whole.noise
    worst = np.argsort(-np.mean(ratio[:, _outer(whole.lines, edges)], axis=1))
    return np.asarray(worst[:_FEW_FRFS])


def _outer(lines: FrfLines, edges: tuple[bool, ...]) -> IntArray:
    """Return the lines next to edges and gaps of the band."""
    omega = lines.laplace.imag
    width = max(10, int(_EDGE * omega.size))
    all_lines = np.arange(omega.size)
    ends = [all_lines[-width:] if above else all_lines[:width] for above in edges]
    for middle in np.searchsorted(omega, gaps_of(lines).mean(axis=1)):
        ends.append(all_lines[max(0, middle - width) : middle + width])
    return np.unique(np.concatenate(ends))


def _starts(
    whole: WholeFit,
    group: Group,
    pole: ComplexArray,
    rows: IntArray,
    edges: tuple[bool, ...],
) -> ComplexArray:
    """Return the likeliest places beyond the edges, none where none is likely."""
    low, high = whole.lines.laplace.imag[[0, -1]]
    away = (high - low) * np.array(_DISTANCES)
    beyond = [
        high + away if above else np.maximum(low - away, 0.5 * low) for above in edges
    ]
    place = np.unique(np.concatenate(beyond))
    decay = (high - low) * np.array(_DECAYS)
    trials = (1j * place[:, None] - decay).ravel()
    for begin, end in gaps_of(group.lines):
        place = begin + (end - begin) * np.array(_WITHIN)
        decay = (end - begin) * np.array(_DECAYS_WITHIN)
        trials = np.append(trials, (1j * place[:, None] - decay).ravel())
    lines = replace(group.lines, response=group.lines.response[rows])
    scale = residue_scale(whole)[rows]
    found = try_poles(lines, group.variance[rows], pole, trials, scale)
    best = np.argsort(-found.log_factor)[:_STARTS]
    return np.asarray(trials[best][found.log_factor[best] > _LEAST_EVIDENCE])
