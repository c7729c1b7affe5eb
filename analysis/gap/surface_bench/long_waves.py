# SPDX-License-Identifier: MIT
"""Long waves of profiles as independent modes of the means of blocks."""

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
from jointbench.analysis.gap.surface_bench.surface_settings import SURFACE
from jointbench.signal.band_limited.block_means import BlockMeans, kernel_of

_FORMS = (2, 3)
_TYPICAL = 1.0 + 2.0 * SURFACE.hurst


@dataclass(frozen=True, slots=True, eq=False)
class LongWaves:
    """Mean squares of modes of levelled means, in bins.

    The modes are uncorrelated on a typical self-affine line; that they are levelled is
    part of their expected squares.

    Attributes:
        omega: wavenumbers at which a density is needed [rad/sample], shape (n_cells,).
        operator: from a density to the expected mean squares, shape (n_bins, n_cells).
        form: squares of polynomials of degree 2 and 3 in each bin, (n_bins, 2).
        power: measured mean squares, shape (n_bins,).
        count: half the number of squares in each [-], same shape.
        place: wavenumber of each bin [rad/sample], same shape.
    """

    omega: FloatArray
    operator: FloatArray
    form: FloatArray
    power: FloatArray
    count: FloatArray
    place: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "omega", "operator", "form", "power", "count", "place")


def long_waves(blocks: BlockMeans) -> LongWaves:
    """Return the long waves of block means.

    Args:
        blocks: of independent profiles.
    """
    count, lines = blocks.means.shape
    omega, kernel = kernel_of(count, blocks.size)
    typical = kernel @ np.maximum(omega, omega[1]) ** -_TYPICAL
    basis, _ = np.linalg.qr(blocks.trend)
    inside = np.eye(count) - basis @ basis.T
    covariance = inside @ scipy.linalg.toeplitz(typical) @ inside
    values, modes = np.linalg.eigh(covariance)
    kept = slice(None, blocks.trend.shape[1] - 1, -1)
    values, modes = values[kept], modes[:, kept]
    operator = np.array([_spread(mode) @ kernel for mode in modes.T])
    squares: FloatArray = np.asarray(
        np.mean((modes.T @ blocks.means) ** 2, axis=1), dtype=np.float64
    )
    place = np.linspace(-1, 1, count)
    shapes = np.polynomial.legendre.legvander(place, max(_FORMS))[:, _FORMS]
    form: FloatArray = np.asarray((modes.T @ shapes) ** 2, dtype=np.float64)
    starts = _starts(values.size)
    sizes = np.diff(np.append(starts, values.size))

    def binned(rows: FloatArray) -> FloatArray:
        scaled = rows / values.reshape(-1, *[1] * (rows.ndim - 1))
        total = np.add.reduceat(scaled, starts, axis=0)
        found: FloatArray = total / sizes.reshape(-1, *[1] * (rows.ndim - 1))
        return found

    number = np.arange(values.size) + blocks.trend.shape[1]
    waves = np.exp(np.add.reduceat(np.log(number), starts) / sizes)
    return LongWaves(
        omega,
        binned(operator),
        binned(form),
        binned(squares),
        0.5 * sizes * lines,
        np.pi * waves / (count * blocks.size),
    )


def _spread(mode: FloatArray) -> FloatArray:
    """Return how often each distance of two blocks counts in a mode's variance."""
    found = np.correlate(mode, mode, "full")[mode.size - 1 :].copy()
    found[1:] *= 2.0
    return found


def _starts(modes: int) -> IntArray:
    """Return the first mode of each bin: single ones, then bins of equal ratio."""
    starts = list(range(min(SURFACE.first_modes, modes)))
    while starts[-1] < modes:
        starts.append(max(starts[-1] + 1, int(starts[-1] * SURFACE.mode_ratio)))
    return np.array(starts[:-1])
