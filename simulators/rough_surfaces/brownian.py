# SPDX-License-Identifier: MIT
"""Exact fractional Brownian lines and fields in units of one grid step."""

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import FloatArray


def brownian_lines(
    rows: int, points: int, hurst: float, rng: np.random.Generator
) -> FloatArray:
    """Draw independent fractional Brownian lines.

    Args:
        rows: number of lines.
        points: on each.
        hurst: Hurst exponent [-], 0 < H < 1.
        rng: source of randomness.

    Returns:
        Lines that start at 0, shape (rows, points); neighbours differ by a variance
        of 1, points l apart by l^(2H).

    Source:
        Davies and Harte, Biometrika 74 (1987) 95.
    """
    lag = np.arange(points, dtype=float)
    covariance = 0.5 * (
        np.abs(lag + 1) ** (2 * hurst)
        - 2 * lag ** (2 * hurst)
        + np.abs(lag - 1) ** (2 * hurst)
    )
    circle = np.concatenate((covariance, covariance[-2:0:-1]))
    # Non-negative for every Hurst exponent; rounding may leave -1e-16.
    spectrum = np.maximum(scipy.fft.fft(circle).real, 0)
    white = _complex_white((rows, circle.size), rng)
    noise = scipy.fft.fft(white * np.sqrt(spectrum / circle.size), axis=1).real
    lines = np.zeros((rows, points))
    np.cumsum(noise[:, : points - 1], axis=1, out=lines[:, 1:])
    return lines


def brownian_field(
    rows: int, columns: int, hurst: float, rng: np.random.Generator
) -> FloatArray:
    """Draw an isotropic fractional Brownian field.

    The field is intrinsic: on distances up to the diagonal of the map, a stationary
    field on a torus plus a random plane has exactly its variogram.

    Args:
        rows: of the map.
        columns: of the map.
        hurst: Hurst exponent [-], 0 < H < 1.
        rng: source of randomness.

    Returns:
        The field, shape (rows, columns); points l steps apart in any direction
        differ by a variance of l^(2H).

    Source:
        Stein, J. Comput. Graph. Stat. 11 (2002) 587.
    """
    diagonal = float(np.hypot(rows - 1, columns - 1))
    covariance = torus_covariance(diagonal, hurst)
    size = covariance.shape[0]
    spectrum = np.maximum(scipy.fft.fft2(covariance).real, 0)
    white = _complex_white(covariance.shape, rng)
    white *= np.sqrt(spectrum) / size
    field = scipy.fft.fft2(white, overwrite_x=True).real[:rows, :columns]
    slope = np.sqrt(2 * plane_variance(hurst)) * rng.standard_normal(2) / diagonal
    plane = slope[0] * np.arange(rows)[:, None] + slope[1] * np.arange(columns)
    # Stein's variance of a difference is 2 |h|^(2H) with h in diagonals.
    return np.asarray((field + plane) * diagonal**hurst / np.sqrt(2), dtype=float)


def torus_covariance(diagonal: float, hurst: float) -> FloatArray:
    """Return the covariance of the stationary part on its torus.

    Args:
        diagonal: largest distance on the map [grid steps].
        hurst: Hurst exponent [-].

    Returns:
        Covariance with the point (0, 0) in units of diagonal^(2H), shape (n, n);
        its Fourier transform is not negative.
    """
    reach, knee, square, level = _stein_constants(2 * hurst)
    size = scipy.fft.next_fast_len(2 * (int(np.ceil(reach * diagonal)) + 1))
    index = np.minimum(np.arange(size), size - np.arange(size)) / diagonal
    distance = np.hypot(index[:, None], index[None, :])
    covariance = np.zeros((size, size))
    near = distance <= 1
    far = (distance > 1) & (distance <= reach)
    h = distance[near]
    covariance[near] = level + square * h**2 - h ** (2 * hurst)
    h = distance[far]
    covariance[far] = knee * (reach - h) ** 3 / h
    return covariance


def plane_variance(hurst: float) -> float:
    """Return the weight of h^2 added by the random plane [-]."""
    return _stein_constants(2 * hurst)[2]


def _stein_constants(exponent: float) -> tuple[float, float, float, float]:
    """Return reach, knee, square term and level of the embedding covariance."""
    if exponent <= 1.5:
        return 1.0, 0.0, exponent / 2, 1 - exponent / 2
    reach = 2.0
    knee = exponent * (2 - exponent) / (3 * reach * (reach**2 - 1))
    square = (exponent - knee * (reach - 1) ** 2 * (reach + 2)) / 2
    level = knee * (reach - 1) ** 3 + 1 - square
    return reach, knee, square, level


def _complex_white(
    shape: tuple[int, ...], rng: np.random.Generator
) -> np.ndarray[tuple[int, ...], np.dtype[np.complex128]]:
    white = np.empty(shape, dtype=np.complex128)
    white.real = rng.standard_normal(shape)
    white.imag = rng.standard_normal(shape)
    return white
