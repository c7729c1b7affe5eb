# SPDX-License-Identifier: MIT
"""What noise of the heights adds to texture parameters, by adding more of it."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.surfaces import Profile, Surface
from jointbench.signal.roughness.texture_operators import surface_texture
from jointbench.signal.roughness.texture_parameters import texture_parameters
from jointbench.signal.roughness.texture_records import Texture
from jointbench.signal.roughness.uncertain_parameters import Values

_PAIRS = 12
"""Pairs of noise, each with both signs, for a profile [-]."""
_MAP_PAIRS = 6
_DOSES = (1.0, 2.0)
"""Variances of added noise over that of the measured heights [-]."""
_CLEAR = 4.0
"""Extrapolated part of a parameter over the scatter of its steps, from which it shifts
the interval [-]: the extrapolation counts a step of the value itself twice, and two
standard deviations of that are clear."""
_SEED = 20211201


def noise_part(
    surface: Surface, texture: Texture, values: Values, noise: float | None
) -> tuple[dict[str, float], dict[str, float]]:
    """Return what noise adds to each parameter, and how it makes it scatter.

    Further noise is added to the texture in two doses; a parabola through the means
    leads back to no noise (simulation and extrapolation). Half of its difference from
    a straight line is part of the scatter. What is not clear beside the steps of a
    parameter (material ratios, profile elements) adds to the scatter instead.
    """
    if not noise:
        return {}, {}
    pairs = _PAIRS if isinstance(surface, Profile) else _MAP_PAIRS
    drawn = _noise_draws(surface, texture, noise, pairs)
    names = [name for name, value in values.items() if value is not None]
    base = np.array([values[name] for name in names], dtype=np.float64)
    doses = [
        np.array(
            [
                [_numbers(texture, sign * root * one, names, base) for sign in (1, -1)]
                for one in drawn
            ]
        )
        for root in np.sqrt(_DOSES)
    ]
    added = [cases.mean(axis=1) - base for cases in doses]
    straight, curved = added[0].mean(axis=0), 3 * added[0] - added[1]
    bias = curved.mean(axis=0)
    # The mean of both signs holds no straight part: what scatters in it are steps.
    steps = np.sqrt(2) * added[0].std(axis=0, ddof=1)
    clear = np.abs(bias) > _CLEAR * steps
    rest = np.where(clear, (bias - straight) / 2, straight)
    # Scatter by noise, of the extrapolation and of its finite number of draws.
    by_noise = doses[0].reshape(-1, base.size).std(axis=0, ddof=1)
    of_mean = curved.std(axis=0, ddof=1) / np.sqrt(len(drawn))
    scatter = np.sqrt(by_noise**2 + of_mean**2 + rest**2)
    bias = np.where(clear, bias, 0.0)
    return (
        dict(zip(names, bias.tolist(), strict=True)),
        dict(zip(names, scatter.tolist(), strict=True)),
    )


def _noise_draws(
    surface: Surface, texture: Texture, noise: float, pairs: int
) -> list[FloatArray]:
    """Return noise of the texture: white noise of a height after the same filters."""
    rng = np.random.default_rng(_SEED)
    plain = replace(texture.settings, robust=False)
    drawn = []
    for _ in range(pairs):
        heights = noise * rng.standard_normal(surface.heights.shape)
        given = replace(surface, heights=np.where(surface.valid, heights, 0.0))
        drawn.append(surface_texture(given, plain).heights)
    return drawn


def _numbers(
    texture: Texture, added: FloatArray, names: Sequence[str], base: FloatArray
) -> FloatArray:
    """Return the parameters of a texture with added noise; `base` where undefined."""
    heights = np.where(texture.valid, texture.heights + added, 0.0)
    found = texture_parameters(replace(texture, heights=heights)).values
    values = np.array([found[name] for name in names], dtype=np.float64)
    return np.where(np.isfinite(values), values, base)
