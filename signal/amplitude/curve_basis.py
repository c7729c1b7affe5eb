# SPDX-License-Identifier: MIT
"""Functions of the logarithm of amplitude that frequency and damping are made of."""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline

from jointbench.acquisition.basics.arrays import FloatArray, freeze

# Step of the grid on which decays are tabulated [-].
_STEP = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class CurveBasis:
    """Functions of L = ln a, constant beyond both ends.

    Attributes:
        grid: of L, ascending and even, reaching below the lowest decay, shape (n,).
        values: of each function there, shape (n, n_functions).
        penalty: squares of second differences of the coefficients, shape
            (n_functions, n_functions).
        rank: of the penalty.
        low: least L with information.
        high: largest L.
        knots: of the splines; empty for polynomials.
    """

    grid: FloatArray
    values: FloatArray
    penalty: FloatArray
    rank: int
    low: float
    high: float
    knots: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "grid", "values", "penalty", "knots")

    @property
    def pitch(self) -> float:
        """Distance of the knots in L; that of the range for polynomials."""
        if self.knots.size:
            return float(self.knots[1] - self.knots[0])
        return self.high - self.low

    @property
    def size(self) -> int:
        """Number of functions."""
        return int(self.values.shape[1])

    def at(self, level: FloatArray) -> FloatArray:
        """Return the functions at given L, shape (n, n_functions)."""
        return np.asarray(
            np.stack(
                [np.interp(level, self.grid, column) for column in self.values.T],
                axis=1,
            )
        )


def _grid(bottom: float, high: float) -> FloatArray:
    return np.asarray(np.arange(bottom, high + 1.0 + _STEP, _STEP))


def constant_basis(bottom: float, low: float, high: float) -> CurveBasis:
    """Return one constant: a mode that does not depend on amplitude."""
    grid = _grid(bottom, high)
    none, nothing = np.zeros((1, 1)), np.empty(0)
    return CurveBasis(grid, np.ones((grid.size, 1)), none, 0, low, high, nothing)


def slope_basis(bottom: float, low: float, high: float) -> CurveBasis:
    """Return constant, slope and curvature: what the test for dependence looks at."""
    grid = _grid(bottom, high)
    x = 2.0 * (np.clip(grid, low, high) - low) / (high - low) - 1.0
    values = np.stack((np.ones_like(x), x, x**2 - 1.0 / 3.0), axis=1)
    return CurveBasis(grid, values, np.zeros((3, 3)), 0, low, high, np.empty(0))


def spline_basis(bottom: float, low: float, high: float, pitch: float) -> CurveBasis:
    """Return cubic B-splines on even knots.

    Args:
        bottom: lowest L of any decay.
        low: least L with information; constant below.
        high: largest L; constant above.
        pitch: wanted distance of the knots in L.
    """
    grid = _grid(bottom, high)
    spans = max(2, round((high - low) / pitch))
    inner = np.linspace(low, high, spans + 1)
    step = inner[1] - inner[0]
    knots = np.concatenate(
        (low - step * np.arange(3, 0, -1), inner, high + step * np.arange(1, 4))
    )
    size = spans + 3
    values = BSpline.design_matrix(np.clip(grid, low, high), knots, 3).toarray()
    second = np.diff(np.eye(size), 2, axis=0)
    penalty = second.T @ second
    return CurveBasis(grid, values, penalty, size - 2, low, high, knots)
