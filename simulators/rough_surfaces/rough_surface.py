# SPDX-License-Identifier: MIT
"""Self-affine surfaces of known fractal dimension and roughness, exact at every lag.

Profiles are fractional Brownian motion by circulant embedding; maps are fractional
Brownian fields by Stein's embedding. Both are exact: the structure function along any
line of the surface is the stated power law at all lags.
"""

import numpy as np
from scipy.special import gamma as gamma_function

from jointbench.acquisition.basics.array_checks import require_positive
from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.provenance import Step, step
from jointbench.acquisition.records.surfaces import Areal, Profile, all_valid
from jointbench.simulators.rough_surfaces.brownian import brownian_field, brownian_lines

FREQUENCY_RATIO = 1.5  # gamma of the Weierstrass-Mandelbrot sum [-]


def structure_constant(dimension: float, *, gamma: float = FREQUENCY_RATIO) -> float:
    """Return C of S(tau) = C G^(2(D-1)) tau^(4-2D) for a profile.

    Args:
        dimension: fractal dimension D of the profile [-], 1 < D < 2.
        gamma: ratio of successive frequencies [-].

    Returns:
        C [-] for profiles of cos(2 pi gamma^n x) terms.

    Source:
        Band integral of the Weierstrass-Mandelbrot spectrum,
        C = (2 pi)^s I(s) / ln gamma, I(s) = pi / (2 Gamma(1+s) sin(pi s/2)),
        s = 4 - 2 D; the printed C lacks the factor (2 pi)^s.
    """
    exponent = 4 - 2 * dimension
    integral = np.pi / (2 * gamma_function(1 + exponent) * np.sin(np.pi * exponent / 2))
    return float((2 * np.pi) ** exponent * integral / np.log(gamma))


def structure_of_line(
    lag: FloatArray, *, dimension: float, roughness: float
) -> FloatArray:
    """Return S(tau) [m^2] of the surfaces of this file at lags tau [m].

    Args:
        lag: tau [m].
        dimension: fractal dimension D of a line on the surface [-].
        roughness: fractal roughness G [m].

    Returns:
        S, of the shape of `lag`.
    """
    factor = structure_constant(dimension) * roughness ** (2 * (dimension - 1))
    return np.asarray(factor * lag ** (4 - 2 * dimension), dtype=float)


def rough_profile(
    points: int, *, spacing: float, dimension: float, roughness: float, seed: int
) -> Profile:
    """Simulate a self-affine profile.

    Args:
        points: number of heights.
        spacing: between them [m].
        dimension: fractal dimension D [-], 1 < D < 2.
        roughness: fractal roughness G [m].
        seed: of the realisation.

    Returns:
        The profile, mean height 0.

    Source:
        Davies and Harte, Biometrika 74 (1987) 95: exact fractional Gaussian
        noise by circulant embedding.
    """
    _check(dimension, roughness, spacing)
    rng = np.random.default_rng([seed, 3])
    unit = brownian_lines(1, points, 2 - dimension, rng)[0]
    heights = unit * _height_of_one_step(dimension, roughness, spacing)
    return Profile(
        name=f"fractal-{seed}",
        heights=heights - heights.mean(),
        spacing=spacing,
        valid=all_valid(heights),
        provenance=(_made("fractional Brownian line", dimension, roughness, seed),),
    )


def rough_rows(
    rows: int,
    points: int,
    *,
    spacing: float,
    dimension: float,
    roughness: float,
    seed: int,
) -> Areal:
    """Simulate a map whose rows are independent self-affine profiles.

    Args:
        rows: number of profiles.
        points: heights in each.
        spacing: between heights and between rows [m].
        dimension: fractal dimension D of a row [-], 1 < D < 2.
        roughness: fractal roughness G [m].
        seed: of the realisation.

    Returns:
        The map, mean height of every row 0; only its rows are self-affine.
    """
    _check(dimension, roughness, spacing)
    rng = np.random.default_rng([seed, 4])
    unit = brownian_lines(rows, points, 2 - dimension, rng)
    heights = unit * _height_of_one_step(dimension, roughness, spacing)
    heights -= heights.mean(axis=1, keepdims=True)
    return Areal(
        name=f"fractal-rows-{seed}",
        heights=heights,
        spacing=(spacing, spacing),
        valid=all_valid(heights),
        provenance=(_made("independent rows", dimension, roughness, seed),),
    )


def rough_map(
    rows: int,
    columns: int,
    *,
    spacing: float,
    dimension: float,
    roughness: float,
    seed: int,
) -> Areal:
    """Simulate an isotropic self-affine map.

    Args:
        rows: heights along y.
        columns: heights along x.
        spacing: between neighbours in both directions [m].
        dimension: fractal dimension D of a line on the map [-], 1 < D < 2 (the map's
            own is D + 1).
        roughness: fractal roughness G of a line on the map [m].
        seed: of the realisation.

    Returns:
        The map, mean height 0.

    Source:
        Stein, J. Comput. Graph. Stat. 11 (2002) 587: exact fractional Brownian
        surfaces on a torus larger than the map.
    """
    _check(dimension, roughness, spacing)
    rng = np.random.default_rng([seed, 5])
    unit = brownian_field(rows, columns, 2 - dimension, rng)
    heights = unit * _height_of_one_step(dimension, roughness, spacing)
    return Areal(
        name=f"fractal-map-{seed}",
        heights=heights - heights.mean(),
        spacing=(spacing, spacing),
        valid=all_valid(heights),
        provenance=(_made("fractional Brownian field", dimension, roughness, seed),),
    )


def _check(dimension: float, roughness: float, spacing: float) -> None:
    if not 1 < dimension < 2:
        raise UsageError(f"dimension is {dimension!r}, a profile has 1 < D < 2")
    require_positive("roughness", roughness)
    require_positive("spacing", spacing)


def _made(what: str, dimension: float, roughness: float, seed: int) -> Step:
    return step(
        "simulated_surface",
        kind=what,
        dimension=dimension,
        roughness_m=roughness,
        seed=seed,
    )


def _height_of_one_step(dimension: float, roughness: float, spacing: float) -> float:
    """Return the standard deviation of the height difference of neighbours [m]."""
    one = np.array([spacing])
    square = structure_of_line(one, dimension=dimension, roughness=roughness)
    return float(np.sqrt(square[0]))
