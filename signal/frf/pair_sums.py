# SPDX-License-Identifier: MIT
"""Sums over the hits that measured one output from one input.

Power of the force, H1 and what H1 leaves of the response are updated with each hit. The
update of the residual is that of recursive least squares, so that a small residual is
not the difference of two large sums.

Source:
    Bendat and Piersol, Random Data (2010), sec. 6.1.4 (H1); Ljung, System
    Identification (1999), sec. 11.2 (recursive least squares).
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import (
    BoolArray,
    ComplexArray,
    FloatArray,
    squared_size,
)
from jointbench.signal.frf.level_slope import LevelSlope


@dataclass(frozen=True, slots=True, eq=False)
class ForceUpdate:
    """What a hit changes in all pairs whose earlier hits had the same force.

    Attributes:
        force: its spectrum [N s], shape (n_lines,).
        total: sum of |F|^2 with this hit, same shape.
        share: sum of |F|^2 without it over that with it [-], same shape.
        gain: conj(F) over the sum with it [1/(N s)], same shape.
        silent: lines on which no hit had a force, or None where there is none.
    """

    force: ComplexArray
    total: FloatArray
    share: FloatArray
    gain: ComplexArray
    silent: BoolArray | None


def force_update(force: ComplexArray, before: FloatArray) -> ForceUpdate:
    """Return what a hit changes.

    Args:
        force: its spectrum [N s], shape (n_lines,).
        before: sum of |F|^2 of the earlier hits, same shape.
    """
    total = before + squared_size(force)
    silent = total <= 0.0
    safe = np.where(silent, 1.0, total)
    return ForceUpdate(
        force,
        total,
        before / safe,
        force.conj() / safe,
        silent if silent.any() else None,
    )


@dataclass(slots=True, eq=False)
class PairSums:
    """Sums of the hits that measured one output from one input.

    Attributes:
        h1: response over force [response unit/N], shape (n_lines,).
        force_power: sum of |F|^2 [N^2 s^2], same shape.
        scatter: sum of |X - H1 F|^2, same shape.
        hits: number of hits.
        slope: regression on the level of the hits, None where it is not asked for.
    """

    h1: ComplexArray
    force_power: FloatArray
    scatter: FloatArray
    hits: int = 0
    slope: LevelSlope | None = None

    @classmethod
    def empty(cls, nothing: FloatArray) -> "PairSums":
        """Return the sums of no hit; `nothing` is zeros, shape (n_lines,)."""
        h1, scatter = np.zeros(nothing.size, complex), np.zeros(nothing.size)
        return cls(h1, nothing, scatter)

    @property
    def response_power(self) -> FloatArray:
        """Sum of |X|^2: what H1 explains and what it leaves are orthogonal."""
        return squared_size(self.h1) * self.force_power + self.scatter

    def add(self, hit: ForceUpdate, response: ComplexArray) -> ComplexArray:
        """Add one hit.

        Args:
            hit: from its force and `force_power`.
            response: its spectrum, shape (n_lines,).

        Returns:
            What H1 of the earlier hits leaves of the response, same shape.
        """
        error = self.h1 * hit.force
        np.subtract(response, error, out=error)
        self.scatter += squared_size(error) * hit.share
        self.h1 += error * hit.gain
        if hit.silent is not None:
            # A line without force holds nothing but noise of the response.
            self.scatter += np.where(hit.silent, squared_size(response), 0.0)
        self.force_power = hit.total
        self.hits += 1
        return error
