# SPDX-License-Identifier: MIT
"""Fit a Weierstrass-Mandelbrot profile, which has waves in a known band only.

Its structure function is a power law neither at short lags, where waves under two
samples are missing, nor at long ones, where those longer than the profile are.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.signal.fractal.structure_covariance import structure_covariance
from jointbench.signal.surface.structure_constant import DEFAULT_GAMMA
from jointbench.signal.surface.structure_function import StructureFunction

LONGEST_SHARE = 0.1
"""Longest lag of the fit over the length of the profile [-]."""
NODES = 1500
"""Integration points of the band [-]."""
DIMENSION_RANGE = (1.02, 1.98)
_TABLE = 240
_STEPS = 40
_NORMAL = 1.959963984540054


@dataclass(frozen=True, slots=True)
class WeierstrassFit:
    """D and G of a Weierstrass-Mandelbrot profile.

    Attributes:
        dimension: D [-].
        dimension_sd: standard deviation of D [-], for Gaussian heights; the waves have
            fixed amplitudes, so D scatters less.
        roughness: G [m].
        roughness_interval: 2.5 % and 97.5 % points of G [m].
        band: lowest and highest frequency of the band [1/m].
        residual_rms: root mean square of ln S about the fit [-].
    """

    dimension: float
    dimension_sd: float
    roughness: float
    roughness_interval: tuple[float, float]
    band: tuple[float, float]
    residual_rms: float


def fit_weierstrass(
    estimate: StructureFunction,
    *,
    gamma: float = DEFAULT_GAMMA,
    band: tuple[float, float] | None = None,
) -> WeierstrassFit:
    """Fit ln S by its band-limited integral with known edges.

    Args:
        estimate: of a profile that was not levelled (`remove="mean"`): it contains no
            waves longer than itself.
        gamma: frequency ratio [-].
        band: lowest and highest frequency [1/m]; by default half a step of gamma
            beyond the waves that fit the profile and its sampling.

    Returns:
        D and G with intervals.

    Raises:
        UsageError: gamma not above 1, an empty band, or too few lags.

    Source:
        S = G^(2(D-1)) / ln gamma times the integral of f^(2D-5) (1 - cos 2 pi f lag)
        over the band: the sum over the waves with an integral in its place.
    """
    if not gamma > 1:
        raise UsageError(f"gamma is {gamma:g}, it must be above 1, for example 1.5")
    edges = band or known_band(estimate, gamma)
    length = estimate.spacing * estimate.points
    inside = (estimate.value > 0) & (estimate.lag <= LONGEST_SHARE * length)
    part = estimate.only(inside)
    if not 0 < edges[0] < edges[1] or part.lag.size < 4:
        raise UsageError(
            f"a band of {edges[0]:g} to {edges[1]:g} 1/m and {part.lag.size} lags up "
            "to a tenth of the length give no fit; measure a longer line"
        )
    log_value = np.log(part.value)
    dimension = _best_dimension(part.lag, log_value, edges)
    shape = np.log(band_integral(part.lag, dimension, edges))
    level = float(np.mean(log_value - shape))
    covariance = _covariance(part, dimension, level, edges)
    return _result(dimension, level, covariance, gamma, edges, log_value - shape)


def known_band(estimate: StructureFunction, gamma: float) -> tuple[float, float]:
    """Return the edges of a band of waves gamma^n between length and two samples."""
    length = estimate.spacing * estimate.points
    first = np.ceil(np.log(1 / length) / np.log(gamma) - 1e-9)
    last = np.floor(np.log(0.5 / estimate.spacing) / np.log(gamma) + 1e-9)
    return float(gamma ** (first - 0.5)), float(gamma ** (last + 0.5))


def band_integral(
    lag: FloatArray, dimension: float, band: tuple[float, float]
) -> FloatArray:
    """Return the integral of f^(2D-5) (1 - cos 2 pi f lag) over a band.

    Args:
        lag: [m], any shape.
        dimension: D [-].
        band: lowest and highest frequency [1/m].

    Returns:
        The integral [m^(4-2D)]; cosines with many periods within a node's share are
        averaged out.
    """
    edge = np.linspace(np.log(band[0]), np.log(band[1]), NODES + 1)
    middle = 0.5 * (edge[1:] + edge[:-1])
    width = float(edge[1] - edge[0])
    frequency = np.exp(middle)
    weight = frequency ** (2 * dimension - 4) * width
    phase = 2 * np.pi * np.multiply.outer(lag, frequency)
    # The mean of the cosine over the share of a node.
    blur = np.sinc(phase * width / (2 * np.pi))
    total: FloatArray = (1 - np.cos(phase) * blur) @ weight
    return total


def _best_dimension(
    lag: FloatArray, log_value: FloatArray, band: tuple[float, float]
) -> float:
    """Return D at the least scatter of ln S about its form, by golden section."""

    def scatter(dimension: float) -> float:
        return float(np.var(log_value - np.log(band_integral(lag, dimension, band))))

    low, high = DIMENSION_RANGE
    ratio = (np.sqrt(5) - 1) / 2
    left, right = high - ratio * (high - low), low + ratio * (high - low)
    at_left, at_right = scatter(left), scatter(right)
    for _ in range(_STEPS):
        if at_left < at_right:
            high, right, at_right = right, left, at_left
            left = high - ratio * (high - low)
            at_left = scatter(left)
        else:
            low, left, at_left = left, right, at_right
            right = low + ratio * (high - low)
            at_right = scatter(right)
    return 0.5 * (low + high)


def _covariance(
    part: StructureFunction, dimension: float, level: float, band: tuple[float, float]
) -> FloatArray:
    """Return the covariance of (D, level) for Gaussian heights of the same spectrum."""
    longest = part.spacing * part.points * 2
    table = np.geomspace(0.5 * part.spacing, longest, _TABLE)
    known = np.exp(level) * band_integral(table, dimension, band)

    def seen(lag: FloatArray) -> FloatArray:
        value = np.interp(lag, table, known)
        near = known[0] * (lag / table[0]) ** 2
        extended: FloatArray = np.where(lag < table[0], near, value)
        return extended

    step = 1e-4
    up, down = (
        np.log(band_integral(part.lag, dimension + move, band))
        for move in (step, -step)
    )
    design = np.stack([(up - down) / (2 * step), np.ones(part.lag.size)], axis=1)
    gain = np.linalg.solve(design.T @ design, design.T)
    result: FloatArray = gain @ structure_covariance(part)(seen) @ gain.T
    return result


def _result(
    dimension: float,
    level: float,
    covariance: FloatArray,
    gamma: float,
    band: tuple[float, float],
    residual: FloatArray,
) -> WeierstrassFit:
    """Derive G = (ln gamma e^level)^(1 / (2 (D - 1))) and its interval."""
    power = 1 / (2 * (dimension - 1))
    log_g = power * (level + np.log(np.log(gamma)))
    gradient = np.array([-log_g / (dimension - 1), power])
    reach = _NORMAL * float(np.sqrt(gradient @ covariance @ gradient))
    return WeierstrassFit(
        dimension=dimension,
        dimension_sd=float(np.sqrt(covariance[0, 0])),
        roughness=float(np.exp(log_g)),
        roughness_interval=(float(np.exp(log_g - reach)), float(np.exp(log_g + reach))),
        band=band,
        residual_rms=float(np.std(residual)),
    )
