# SPDX-License-Identifier: MIT
"""All parameters of a profile (ISO 21920-2) or of a map (ISO 25178-2)."""

import numpy as np

from jointbench.signal.roughness.height_statistics import (
    height_statistics,
    section_extremes,
)
from jointbench.signal.roughness.local_gradients import line_gradients, map_gradients
from jointbench.signal.roughness.material_ratio import (
    MaterialRatio,
    core_parameters,
    material_ratio,
    volume_parameters,
)
from jointbench.signal.roughness.profile_elements import (
    DISCRIMINATION,
    profile_elements,
)
from jointbench.signal.roughness.regression_filter import known_share
from jointbench.signal.roughness.texture_records import Texture, TextureParameters
from jointbench.signal.roughness.texture_spatial import decay_lengths, lay_direction


def texture_parameters(texture: Texture) -> TextureParameters:
    """Return all parameters of a scale-limited profile or map.

    Args:
        texture: heights about their reference.
    """
    if texture.heights.ndim == 1:
        return profile_parameters(texture)
    return map_parameters(texture)


def profile_parameters(texture: Texture) -> TextureParameters:
    """Return the parameters of ISO 21920-2 of one profile.

    Ra, Rq, Rsk, Rku and the material ratios are of the whole evaluation length, Rz, Rp
    and Rv means of its sections, Rt the range of all sections.
    """
    heights, valid = texture.heights, texture.valid
    (spacing,) = texture.spacing
    known = heights[valid]
    extremes = section_extremes(heights, known_share(valid), texture.sections)
    limits = (DISCRIMINATION * extremes["p"], DISCRIMINATION * extremes["v"])
    widths, tall = profile_elements(heights, valid, spacing, limits)
    slopes = line_gradients(heights, valid, spacing)
    curve = material_ratio(known)
    values: dict[str, float | None] = {
        "Rsm": float(widths.mean()) if widths.size else None,
        "Rc": float(tall.mean()) if tall.size else None,
        "Rdq": float(np.sqrt(np.mean(slopes**2))) if slopes.size else None,
    }
    values |= {f"R{name}": value for name, value in extremes.items()}
    values |= {f"R{name}": one for name, one in height_statistics(known).items()}
    values |= _core("R", curve)
    return TextureParameters(values, curve)


def map_parameters(texture: Texture) -> TextureParameters:
    """Return the parameters of ISO 25178-2 of one map."""
    heights, valid = texture.heights, texture.valid
    spacing = (texture.spacing[0], texture.spacing[1])
    known = heights if bool(valid.all()) else heights[valid]
    curve = material_ratio(known)
    gradient, area = map_gradients(heights, valid, spacing)
    decay = decay_lengths(heights, valid, spacing)
    top, bottom = float(curve.heights[0]), float(curve.heights[-1])
    values: dict[str, float | None] = {
        "Sz": top - bottom,
        "Sp": top,
        "Sv": 0.0 - bottom,
        "Sdq": None if np.isnan(gradient) else gradient,
        "Sdr": None if np.isnan(area) else area,
        "Sal": decay.shortest,
        "Str": decay.aspect_ratio,
        "Std": lay_direction(heights, valid, spacing),
    }
    values |= {f"S{name}": one for name, one in height_statistics(known).items()}
    values |= _core("S", curve) | volume_parameters(curve)
    return TextureParameters(values, curve)


def _core(letter: str, curve: MaterialRatio) -> dict[str, float | None]:
    """Return the core parameters under the names of their standard."""
    found = core_parameters(curve)
    return {
        letter + ("mrk" + name[2:] if name.startswith("mr") else name): one
        for name, one in found.items()
    }
