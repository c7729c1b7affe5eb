# SPDX-License-Identifier: MIT
"""Poles of coupled bodies from the FRFs of each, without a model of what is above.

At a pole the gap matrix T H(s) T' + 1 / (k + s c) of the links is singular. The FRFs
are needed next to the pole only, where they were measured.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, freeze
from jointbench.analysis.structures.measured.fitted_frfs import BodyResponse

_MOST_STEPS = 40
# Largest step of a pole, and the one at which it is found, relative to its size.
_LARGEST_STEP, _FOUND = 0.03, 1e-10


@dataclass(frozen=True, slots=True, eq=False)
class GapMatrix:
    """The matrix that is singular at the poles of coupled bodies.

    Attributes:
        bodies: their FRFs, in order.
        ties: relative motion of the links from the points of all bodies, shape
            (n_links, n_points).
        stiffness: of the links [N/m], shape (n_links,); may be infinite.
        damping: of the links [N s/m], shape (n_links,).
    """

    bodies: tuple[BodyResponse, ...]
    ties: FloatArray
    stiffness: FloatArray
    damping: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "ties", "stiffness", "damping")

    def at(self, s: complex) -> ComplexArray:
        """Return the matrix [m/N], shape (n_links, n_links)."""
        whole = block_diag(*(one.at(s) for one in self.bodies))
        soft = np.diag(1.0 / (self.stiffness + s * self.damping))
        return np.asarray(self.ties @ whole @ self.ties.T + soft)

    def slope(self, s: complex) -> ComplexArray:
        """Return its derivative over s, same shape."""
        whole = block_diag(*(one.slope(s) for one in self.bodies))
        soft = self.damping / (self.stiffness + s * self.damping) ** 2
        return np.asarray(self.ties @ whole @ self.ties.T - np.diag(soft))


def pole_near(gap: GapMatrix, start: complex) -> complex | None:
    """Return the pole of coupled bodies next to a start, by Newton's method.

    Args:
        gap: of the bodies and their links.
        start: [1/s].

    Returns:
        [1/s]; None if there is none near it.
    """
    s = complex(start)
    for _ in range(_MOST_STEPS):
        if not np.isfinite(s):
            break
        value, vector = np.linalg.eig(gap.at(s))
        # The matrix is symmetric: rows of the inverse are transposed vectors.
        slope = np.einsum("im,im->m", vector, gap.slope(s) @ vector)
        size = np.einsum("im,im->m", vector, vector)
        steps = -value * size / np.where(slope == 0, 1e-300, slope)
        step = complex(steps[int(np.argmin(np.abs(steps)))])
        if abs(step) <= _FOUND * abs(s):
            return s + step
        s += step * min(1.0, _LARGEST_STEP * abs(s) / abs(step))
    return None


def poles_near(gap: GapMatrix, starts: Sequence[complex]) -> ComplexArray:
    """Return the pole next to each start; NaN where there is none, shape (n,)."""
    found = [pole_near(gap, one) for one in starts]
    return np.array([complex(np.nan, np.nan) if one is None else one for one in found])
