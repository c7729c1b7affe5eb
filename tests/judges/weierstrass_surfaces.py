# SPDX-License-Identifier: MIT
"""Weierstrass-Mandelbrot profiles and maps: sums of waves at powers of one ratio."""

import numpy as np

from jointbench.acquisition.basics.array_checks import require_positive
from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.provenance import step
from jointbench.acquisition.records.surfaces import Areal, Profile, all_valid

FREQUENCY_RATIO = 1.5  # gamma [-]
FEWEST_RIDGES = 2


def wave_numbers(length: float, spacing: float, gamma: float) -> tuple[int, int]:
    """Return the first and last exponent n of waves gamma^n on a sampled line.

    Args:
        length: of the line [m]; the longest wave fits into it.
        spacing: of the samples [m]; the shortest wave has two.
        gamma: frequency ratio [-].
    """
    if not gamma > 1:
        raise UsageError(f"gamma is {gamma!r}, it must be above 1, for example 1.5")
    first = int(np.ceil(np.log(1 / length) / np.log(gamma) - 1e-9))
    last = int(np.floor(np.log(1 / (2 * spacing)) / np.log(gamma) + 1e-9))
    if last < first:
        raise UsageError(
            f"a line of {length:g} m at {spacing:g} m holds no wave of ratio "
            f"{gamma:g}; make it longer"
        )
    return first, last


def weierstrass_profile(
    points: int,
    *,
    spacing: float,
    dimension: float,
    roughness: float,
    seed: int,
    gamma: float = FREQUENCY_RATIO,
) -> Profile:
    """Make a Weierstrass-Mandelbrot profile with random phases.

    Args:
        points: number of heights.
        spacing: between them [m].
        dimension: D [-], 1 < D < 2.
        roughness: G [m].
        seed: of the phases.
        gamma: ratio of neighbouring frequencies [-].

    Returns:
        z = G^(D-1) sum gamma^((D-2)n) cos(2 pi gamma^n x + phi_n), mean height 0.

    Raises:
        UsageError: D or gamma out of range, or a line too short for any wave.

    Source:
        Berry and Lewis, Proc. R. Soc. A 370 (1980) 459; Appl. Sci. 2025, 15, 9040.
    """
    if not 1 < dimension < 2:
        raise UsageError(f"dimension is {dimension!r}, a profile has 1 < D < 2")
    require_positive("roughness", roughness)
    rng = np.random.default_rng([seed, 31])
    x = spacing * np.arange(points)
    first, last = wave_numbers(points * spacing, spacing, gamma)
    heights = np.zeros(points)
    for n in range(first, last + 1):
        wave = np.cos(2 * np.pi * gamma**n * x + rng.uniform(0, 2 * np.pi))
        heights += gamma ** ((dimension - 2) * n) * wave
    heights *= roughness ** (dimension - 1)
    made = step(
        "simulated_surface",
        kind="Weierstrass-Mandelbrot profile",
        dimension=dimension,
        roughness_m=roughness,
        gamma=gamma,
        seed=seed,
    )
    return Profile(
        name=f"weierstrass-{seed}",
        heights=heights - heights.mean(),
        spacing=spacing,
        valid=all_valid(heights),
        provenance=(made,),
    )


def weierstrass_map(
    rows: int,
    columns: int,
    *,
    spacing: float,
    areal_dimension: float,
    roughness: float,
    ridges: int,
    seed: int,
    gamma: float = FREQUENCY_RATIO,
) -> Areal:
    """Make a Weierstrass-Mandelbrot map of superposed ridges.

    Args:
        rows: heights along y.
        columns: heights along x.
        spacing: between neighbours in both directions [m].
        areal_dimension: D of the map [-], 2 < D < 3.
        roughness: G of the map [m]; it is no profile's G.
        ridges: M, directions of the waves; 10 or more look alike in all directions,
            the 2 of the papers do not.
        seed: of the phases.
        gamma: ratio of neighbouring frequencies [-].

    Returns:
        The map, mean height 0; a phase of its own for every direction and wave.

    Raises:
        UsageError: D, M or gamma out of range, or a map too small for any wave.

    Source:
        Yan and Komvopoulos, J. Appl. Phys. 84 (1998) 3617, eq. (3).
    """
    if not 2 < areal_dimension < 3:
        raise UsageError(f"areal_dimension is {areal_dimension!r}, a map has 2 < D < 3")
    if ridges < FEWEST_RIDGES:
        raise UsageError(f"ridges is {ridges!r}, at least {FEWEST_RIDGES} make a map")
    require_positive("roughness", roughness)
    rng = np.random.default_rng([seed, 32])
    length = spacing * max(rows, columns)
    last = int(np.floor(np.log(length / (2 * spacing)) / np.log(gamma)))
    x, y = spacing * np.arange(columns), spacing * np.arange(rows)[:, None]
    heights = np.zeros((rows, columns))
    for m in range(1, ridges + 1):
        along = x * np.cos(np.pi * m / ridges) + y * np.sin(np.pi * m / ridges)
        for n in range(last + 1):
            heights += _ridge(along, n, length, areal_dimension, gamma, rng)
    scale = (roughness / length) ** (areal_dimension - 2)
    heights *= length * scale * np.sqrt(np.log(gamma) / ridges)
    made = step(
        "simulated_surface",
        kind="Weierstrass-Mandelbrot map",
        areal_dimension=areal_dimension,
        roughness_m=roughness,
        ridges=ridges,
        gamma=gamma,
        seed=seed,
    )
    return Areal(
        name=f"weierstrass-map-{seed}",
        heights=heights - heights.mean(),
        spacing=(spacing, spacing),
        valid=all_valid(heights),
        provenance=(made,),
    )


def _ridge(
    along: FloatArray,
    order: int,
    length: float,
    dimension: float,
    gamma: float,
    rng: np.random.Generator,
) -> FloatArray:
    """Return one wave of one direction, 0 at the origin."""
    phase = rng.uniform(0, 2 * np.pi)
    wave = np.cos(phase) - np.cos(2 * np.pi * gamma**order * along / length + phase)
    return np.asarray(gamma ** ((dimension - 3) * order) * wave)
