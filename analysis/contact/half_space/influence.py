# SPDX-License-Identifier: MIT
"""Displacements of a half-space under pressures on a grid, by Fourier transform."""

from dataclasses import dataclass

import numpy as np
from scipy import fft

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Influence:
    """Response of the surface of a half-space.

    Attributes:
        factors: of the transform of the pressures [m/Pa], shape (n, m // 2 + 1).
        shape: of the transformed grid; larger than that of the map where the map is
            alone on the half-space.
    """

    factors: ComplexArray | FloatArray
    shape: tuple[int, int]

    def displacement(self, pressure: FloatArray) -> FloatArray:
        """Return normal displacements of the surface [m], shape of `pressure`."""
        rows, columns = pressure.shape
        waves = fft.rfft2(pressure, s=self.shape) * self.factors
        moved: FloatArray = fft.irfft2(waves, s=self.shape)[:rows, :columns]
        return moved


def periodic_influence(
    shape: tuple[int, int], spacing: tuple[float, float], modulus: float
) -> Influence:
    """Return the influence of a map that repeats itself in both directions.

    The mean displacement is left out: it is the compliance of the bodies.

    Args:
        shape: of the map.
        spacing: of rows and of columns [m].
        modulus: E* of both bodies [Pa].

    Source:
        Johnson, Contact Mechanics (1985), sec. 13.2: u = 2 p / (E* q) of a wave q.
    """
    rows = 2 * np.pi * fft.fftfreq(shape[0], spacing[0])
    columns = 2 * np.pi * fft.rfftfreq(shape[1], spacing[1])
    size = np.hypot(rows[:, None], columns[None, :])
    size[0, 0] = np.inf
    return Influence(2 / (modulus * size), shape)


def single_influence(
    shape: tuple[int, int], spacing: tuple[float, float], modulus: float
) -> Influence:
    """Return the influence of a map that is alone on the half-space.

    Args:
        shape: of the map.
        spacing: of rows and of columns [m].
        modulus: E* of both bodies [Pa].

    Source:
        Love, Phil. Trans. R. Soc. A 228 (1929) 377: even pressure on a rectangle, as
        Johnson (1985), eq. (3.25).
    """
    wide = (2 * shape[0], 2 * shape[1])
    y, x = (
        fft.fftfreq(count, 1 / count) * step
        for count, step in zip(wide, spacing, strict=True)
    )
    top, low = y[:, None] + spacing[0] / 2, y[:, None] - spacing[0] / 2
    right, left = x[None, :] + spacing[1] / 2, x[None, :] - spacing[1] / 2
    field = _corner(right, top) - _corner(right, low)
    field += _corner(left, low) - _corner(left, top)
    return Influence(fft.rfft2(field / (np.pi * modulus)), wide)


def _corner(x: FloatArray, y: FloatArray) -> FloatArray:
    """Return x asinh(y/x) + y asinh(x/y) with signs; the corners are never at 0."""
    field: FloatArray = x * np.arcsinh(y / np.abs(x)) + y * np.arcsinh(x / np.abs(y))
    return field
