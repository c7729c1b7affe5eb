# SPDX-License-Identifier: MIT
"""Standard uncertainty of texture parameters: noise, filter, instrument, repeats."""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.records.surfaces import Profile, Surface
from jointbench.signal.roughness.height_noise import height_noise
from jointbench.signal.roughness.noise_extrapolation import noise_part
from jointbench.signal.roughness.texture_operators import surface_texture
from jointbench.signal.roughness.texture_parameters import texture_parameters
from jointbench.signal.roughness.texture_records import Texture, TextureSettings
from jointbench.signal.roughness.uncertain_parameters import (
    NO_ERRORS,
    InstrumentErrors,
    MeasuredTexture,
    TextureValue,
    Values,
)

FILTER_TOLERANCE = 0.05
"""Half width of the nesting indices of filters that count as equal [-]; the deviation
of their values is taken as rectangular."""
_MAP_SIDE = 320
"""Side of the piece of a map on which components are determined [points]."""
_ABSOLUTE = frozenset({"sk", "ku", "mrk1", "mrk2", "td"})
"""Parameters about zero or with an end: their deviations are no shares of the value."""


def measured_texture(
    surface: Surface,
    settings: TextureSettings,
    errors: InstrumentErrors = NO_ERRORS,
) -> MeasuredTexture:
    """Return the texture parameters of a surface with their uncertainties.

    The components of a map are determined on a piece of it and taken over as shares of
    the value.

    Args:
        surface: as measured.
        settings: nesting indices and form.
        errors: of the instrument.

    Raises:
        UsageError: a surface too small for its nesting indices.
        SurfaceTooSmall: too few measured points.
    """
    texture = surface_texture(surface, settings)
    values = texture_parameters(texture).values
    noise = errors.noise if errors.noise is not None else height_noise(surface)
    piece = _piece(surface, settings)
    if piece is surface:
        near, here = values, texture
    else:
        here = surface_texture(piece, settings)
        near = texture_parameters(here).values
    found = _components(piece, here, near, settings, replace(errors, noise=noise))
    return MeasuredTexture(
        surface.name,
        texture,
        tuple(_scaled(name, values[name], near, found) for name in values),
        noise,
    )


def _piece(surface: Surface, settings: TextureSettings) -> Surface:
    """Return the middle of a large map, and any other surface as it is."""
    if isinstance(surface, Profile) or max(surface.heights.shape) <= 2 * _MAP_SIDE:
        return surface
    least = [
        _MAP_SIDE if settings.long is None else int(2.2 * settings.long / one) + 64
        for one in surface.spacing
    ]
    sides = [
        min(n, max(_MAP_SIDE, one))
        for n, one in zip(surface.heights.shape, least, strict=True)
    ]
    rows, columns = (
        slice((n - side) // 2, (n - side) // 2 + side)
        for n, side in zip(surface.heights.shape, sides, strict=True)
    )
    return replace(
        surface,
        heights=surface.heights[rows, columns],
        valid=surface.valid[rows, columns],
    )


def _components(
    surface: Surface,
    texture: Texture,
    values: Values,
    settings: TextureSettings,
    errors: InstrumentErrors,
) -> dict[str, TextureValue]:
    """Return the uncertainty of each parameter of a surface by its causes."""
    parts = {
        "filter": _filter_part(surface, settings),
        "height": _difference(
            *(_of_scaled(texture, 1 + sign * errors.height) for sign in (1, -1))
        ),
        "pitch": _pitch_part(surface, settings, errors.pitch),
    }
    bias, spread = noise_part(surface, texture, values, errors.noise)
    return {
        name: TextureValue(
            name,
            value,
            bias.get(name, 0.0),
            (
                ("noise", spread.get(name, 0.0)),
                *((cause, part.get(name, 0.0)) for cause, part in parts.items()),
            ),
        )
        for name, value in values.items()
    }


def _scaled(
    name: str, value: float | None, near: Values, found: dict[str, TextureValue]
) -> TextureValue:
    """Return components of a piece as those of the whole."""
    one, there = found[name], near[name]
    if value is None or there is None:
        return TextureValue(name, value)
    absolute = name[1:] in _ABSOLUTE or there == 0
    share = 1.0 if absolute else value / there
    parts = tuple((cause, abs(share) * part) for cause, part in one.parts)
    return replace(one, value=value, bias=share * one.bias, parts=parts)


def _filter_part(surface: Surface, settings: TextureSettings) -> dict[str, float]:
    """Return what nesting indices within their tolerance change."""
    both: list[dict[str, float]] = []
    for k, index in enumerate((settings.short, settings.long)):
        if index is None:
            continue
        ends = []
        for sign in (1, -1):
            stretch = [1.0, 1.0]
            stretch[k] = 1 + sign * FILTER_TOLERANCE
            ends.append(_at(surface, settings, (stretch[0], stretch[1])))
        both.append(_difference(*ends))
    return {
        name: float(np.sqrt(sum(one.get(name, 0.0) ** 2 for one in both) / 3))
        for name in {name for one in both for name in one}
    }


def _at(
    surface: Surface, settings: TextureSettings, stretch: tuple[float, float]
) -> Values:
    return texture_parameters(
        surface_texture(surface, settings, stretch=stretch)
    ).values


def _pitch_part(
    surface: Surface, settings: TextureSettings, error: float
) -> dict[str, float]:
    """Return what one standard deviation of the lateral scale changes."""
    if not error:
        return {}
    ends = []
    for sign in (1, -1):
        factor = 1 + sign * error
        if isinstance(surface, Profile):
            other: Surface = replace(surface, spacing=surface.spacing * factor)
        else:
            down, along = surface.spacing
            other = replace(surface, spacing=(down * factor, along * factor))
        ends.append(_at(other, settings, (1.0, 1.0)))
    return _difference(*ends)


def _of_scaled(texture: Texture, factor: float) -> Values:
    other = replace(texture, heights=texture.heights * factor)
    return texture_parameters(other).values


def _difference(one: Values, other: Values) -> dict[str, float]:
    """Return half the absolute differences of the parameters that both have."""
    found = {}
    for name, value in one.items():
        beside = other[name]
        if value is None or beside is None:
            continue
        apart = value - beside
        if name == "Std":
            apart = (apart + np.pi / 2) % np.pi - np.pi / 2
        found[name] = abs(apart) / 2
    return found
