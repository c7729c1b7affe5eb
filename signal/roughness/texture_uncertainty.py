# SPDX-License-Identifier: MIT
"""Standard uncertainty of texture parameters: noise, filter, instrument, repeats."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from jointbench.acquisition.records.surfaces import Areal, Profile, Surface
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
_WHOLE_SIDE = 400
"""Side up to which they are determined on the whole map [points]."""
_OFFSETS = (0.5, 1.0, 1.5)
"""Deviations of a cause at which parameters are computed [standard deviations]."""
_HEIGHT_POWER = {"sk": 0, "ku": 0, "mrk1": 0, "mrk2": 0, "td": 0, "sm": 0, "al": 0}
_HEIGHT_POWER |= {"tr": 0, "dr": 2}
"""Powers of the height scale in the parameters; 1 for all others."""
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
    if not texture.heights.any():
        noise = 0.0  # What is left of equal heights is rounding, not noise.
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
    if isinstance(surface, Profile) or max(surface.heights.shape) <= _WHOLE_SIDE:
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
        "filter": _filter_part(surface, values, settings),
        "height": _height_part(values, errors.height),
        "pitch": _pitch_part(surface, values, settings, errors.pitch),
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


def _filter_part(
    surface: Surface, values: Values, settings: TextureSettings
) -> dict[str, float]:
    """Return what nesting indices within their tolerance change."""
    width = FILTER_TOLERANCE / np.sqrt(3)

    def at(short: float, long: float) -> Values:
        stretch = (1 + short, 1 + long)
        return texture_parameters(
            surface_texture(surface, settings, stretch=stretch)
        ).values

    both = []
    if settings.short is not None:
        both.append(_spread(values, lambda off: at(width * off, 0.0)))
    if settings.long is not None:
        both.append(_spread(values, lambda off: at(0.0, width * off)))
    return {
        name: float(np.sqrt(sum(one.get(name, 0.0) ** 2 for one in both)))
        for name in {name for one in both for name in one}
    }


def _height_part(values: Values, error: float) -> dict[str, float]:
    """Return what one standard deviation of the height scale changes."""
    return {
        name: error * _HEIGHT_POWER.get(name[1:], 1) * abs(value)
        for name, value in values.items()
        if value is not None
    }


def _pitch_part(
    surface: Surface, values: Values, settings: TextureSettings, error: float
) -> dict[str, float]:
    """Return what one standard deviation of the lateral scale changes.

    The evaluation length or area covers another piece of the surface with it.
    """
    if not error:
        return {}
    scale = _spread(values, lambda off: _of_pitch(surface, settings, off * error))
    if isinstance(surface, Profile):
        return scale
    margin = _margin_part(surface, values, settings, error)
    return {
        name: float(np.hypot(one, margin.get(name, 0.0))) for name, one in scale.items()
    }


def _of_pitch(surface: Surface, settings: TextureSettings, error: float) -> Values:
    """Return the parameters of a surface whose pitch is larger by a share."""
    if isinstance(surface, Profile):
        other: Surface = replace(surface, spacing=surface.spacing * (1 + error))
    else:
        down, along = surface.spacing
        other = replace(surface, spacing=(down * (1 + error), along * (1 + error)))
    return texture_parameters(surface_texture(other, settings)).values


def _margin_part(
    areal: Areal, values: Values, settings: TextureSettings, error: float
) -> dict[str, float]:
    """Return what a share of the sides of a map changes that lies beyond its area.

    Each side is cut alone: four strips of a rough surface are independent.
    """
    rows, columns = areal.heights.shape
    down, along = (max(1, round(0.5 * error * n)) for n in (rows, columns))
    pieces = (
        np.s_[down:, :],
        np.s_[: rows - down, :],
        np.s_[:, along:],
        np.s_[:, : columns - along],
    )
    cases = []
    for piece in pieces:
        inner = replace(areal, heights=areal.heights[piece], valid=areal.valid[piece])
        cases.append(texture_parameters(surface_texture(inner, settings)).values)
    share = min(1.0, 0.5 * error * max(rows, columns) / min(down, along))
    both = share * float(np.sqrt(len(cases)))
    return {name: both * one for name, one in _apart(values, cases).items()}


def _spread(values: Values, at: Callable[[float], Values]) -> dict[str, float]:
    """Return the deviation for one standard deviation of a cause.

    Parameters step where an element or the central region changes: several offsets on
    both sides give the root mean square of such steps, two do not.
    """
    cases = [at(sign * one) for one in _OFFSETS for sign in (1, -1)]
    total = 2 * sum(one**2 for one in _OFFSETS) / len(cases)
    found = _apart(values, cases)
    return {name: one / float(np.sqrt(total)) for name, one in found.items()}


def _apart(values: Values, cases: Sequence[Values]) -> dict[str, float]:
    """Return the root mean square deviation of cases from the value itself."""
    found = {}
    for name, value in values.items():
        others = [case[name] for case in cases]
        if value is None or any(one is None for one in others):
            continue
        apart = np.array(others, dtype=np.float64) - value
        if name == "Std":
            apart = (apart + np.pi / 2) % np.pi - np.pi / 2
        found[name] = float(np.sqrt(np.mean(apart**2)))
    return found
