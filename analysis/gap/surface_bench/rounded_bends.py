# SPDX-License-Identifier: MIT
"""Kurtosis of the bends of a rounded line."""

from functools import cache

import numpy as np
from scipy.optimize import minimize
from scipy.special import ndtri
from scipy.stats import qmc

from jointbench.acquisition.basics.arrays import FloatArray, read_only
from jointbench.analysis.gap.surface_bench.surface_settings import SURFACE


def rounded_bend_kurtosis(lines: FloatArray, step: float) -> float:
    """Return the excess kurtosis of second differences that rounding causes.

    A step of several times the difference of neighbours leaves most second differences
    at zero and few at one step. Mean squares of the first and second differences of the
    rounded line determine those of the Gaussian line ahead of the converter, and they
    the fourth moment.

    Args:
        lines: levelled heights, rounded [m], shape (n_lines, n).
        step: of the converter [m].

    Returns:
        0 without a step.

    Source:
        Moments of round(u + d / step), u uniform over a step and d Gaussian, by
        quasi-random sums: Sobol' 1967, USSR Comp. Math. Math. Phys. 7, 86.
    """
    if step <= 0.0:
        return 0.0
    first = float(np.mean(np.diff(lines, axis=1) ** 2)) / step**2
    second = float(np.mean(np.diff(lines, 2, axis=1) ** 2)) / step**2
    if min(first, second) <= 0.0:
        return 0.0
    wanted = np.log((first, second))
    start = np.array([0.5 * np.log(first), 0.0])

    def off(x: FloatArray) -> float:
        one, two = _bends(*x)
        moments = np.array([np.mean(one**2), np.mean(two**2)])
        return float(
            np.sum((np.log(np.maximum(moments, 1.0 / one.size)) - wanted) ** 2)
        )

    # Moments of counted steps change by whole points, so that slopes are of no use.
    corners = start + SURFACE.rounding_reach * np.array([[0, 0], [1, 0], [0, 1]])
    found = minimize(
        off,
        start,
        method="Nelder-Mead",
        options={"initial_simplex": corners, "xatol": 1e-3, "fatol": 1e-6},
    )
    bend = _bends(*found.x)[1]
    square = float(np.mean(bend**2))
    return float(np.mean(bend**4)) / square**2 - 3.0 if square > 0.0 else 0.0


def _bends(size: float, turn: float) -> tuple[FloatArray, FloatArray]:
    """Return first and second differences of rounded heights in steps.

    Args:
        size: ln of the rms of a difference over the step.
        turn: inverse hyperbolic tangent of the correlation of neighbouring differences.
    """
    place, one, two = _points()
    along = np.tanh(turn)
    other = along * one + np.sqrt(1.0 - along**2) * two
    before, after = np.exp(size) * one, np.exp(size) * other
    here = np.round(place)
    ahead = np.round(place + after) - here
    return ahead, ahead - (here - np.round(place - before))


@cache
def _points() -> FloatArray:
    """Return a place within a step and two normal numbers, shape (3, n)."""
    points = qmc.Sobol(3, seed=1).random_base2(SURFACE.rounding_points).T
    return read_only(np.concatenate([points[:1], ndtri(points[1:])]))
