# SPDX-License-Identifier: MIT
"""Regression of an FRF on the level of the hits, one hit at a time.

H(f) = mean(f) + slope(f) log2(level), each hit weighted by |F|^2. What H1 of the
earlier hits leaves of a hit is rotated as its level is: both are then orthogonal to the
mean, and the slope is one more coefficient of recursive least squares.

Source:
    Brown, Durbin and Evans, J. R. Stat. Soc. B 37 (1975) 149 (recursive residuals);
    Ljung, System Identification (1999), sec. 11.2.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import (
    ComplexArray,
    FloatArray,
    squared_size,
)


@dataclass(frozen=True, slots=True, eq=False)
class LevelUpdate:
    """What a hit changes in all regressions over the same earlier hits.

    Attributes:
        root: square root of the share of |F|^2 that the earlier hits have [-], shape
            (n_lines,).
        lever: level of the hit from the mean of the earlier ones, times force and
            `root` [N s], same shape.
        gain: conj(lever) over `total` [1/(N s)], same shape.
        kept: square root of the share of `total` that the earlier hits have [-].
        mean: of the level over the hits with this one, log2, same shape.
        total: sum of |lever|^2 with this hit [N^2 s^2], same shape.
        turn: by which the phase of the force advances from each line to the next,
            conjugate, shape (n_lines - 1,).
    """

    root: FloatArray
    lever: ComplexArray
    gain: ComplexArray
    kept: FloatArray
    mean: FloatArray
    total: FloatArray
    turn: ComplexArray


@dataclass(slots=True, eq=False)
class LevelSlope:
    """The regression of one output from one input.

    Attributes:
        slope: change of H for a doubling of the level [response unit/N], shape
            (n_lines,).
        scatter: what the regression leaves, sum of squares, same shape.
        mean: of the level over the hits, log2, same shape.
        total: sum of squares of the levels from their mean, times |F|^2 [N^2 s^2].
        shared: sum over neighbouring lines of the product of their residuals, without
            the phase of the force, which turns from line to line with the trigger.
    """

    slope: ComplexArray
    scatter: FloatArray
    mean: FloatArray
    total: FloatArray
    shared: float = 0.0

    @classmethod
    def empty(cls, nothing: FloatArray) -> "LevelSlope":
        """Return the regression over no hit; `nothing` is zeros, shape (n_lines,)."""
        size = nothing.size
        return cls(np.zeros(size, complex), np.zeros(size), nothing, nothing)

    def update(
        self, force: ComplexArray, share: FloatArray, level: float
    ) -> LevelUpdate:
        """Return what a hit changes.

        Args:
            force: its spectrum [N s], shape (n_lines,).
            share: of |F|^2 that the earlier hits have [-], same shape.
            level: of the hit, log2.
        """
        root = np.sqrt(share)
        away = level - self.mean
        lever = force * (away * root)
        total = self.total + squared_size(lever)
        safe = np.where(total > 0.0, total, 1.0)
        size = np.abs(force)
        phase = force / np.where(size > 0.0, size, 1.0)
        return LevelUpdate(
            root,
            lever,
            lever.conj() / safe,
            np.sqrt(self.total / safe),
            self.mean + (1.0 - share) * away,
            total,
            phase[:-1] * phase[1:].conj(),
        )

    def add(self, hit: LevelUpdate, error: ComplexArray) -> None:
        """Add one hit.

        Args:
            hit: from `update`.
            error: what H1 of the earlier hits leaves of its response, shape (n_lines,).
        """
        left = error * hit.root
        left -= self.slope * hit.lever
        self.slope += left * hit.gain
        left *= hit.kept
        self.scatter += squared_size(left)
        self.shared += float(np.vdot(left[:-1], left[1:] * hit.turn).real)
        self.mean, self.total = hit.mean, hit.total
