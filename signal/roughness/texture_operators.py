# SPDX-License-Identifier: MIT
"""F-operation, S-filter and L-filter: from measured heights to texture."""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.surfaces import Areal, Profile, Surface
from jointbench.signal.roughness.regression_filter import (
    known_share,
    smooth_line,
    smooth_map,
)
from jointbench.signal.roughness.robust_filter import smooth_robustly
from jointbench.signal.roughness.setting_classes import SECTIONS
from jointbench.signal.roughness.texture_records import Texture, TextureSettings
from jointbench.signal.surface.applied_filters import long_waves_removed
from jointbench.signal.surface.form_removal import remove_form
from jointbench.signal.surface.levelling import MINIMUM_VALID_POINTS, level

ENDS = 0.5
"""Length left out at each end, over the nesting index of the L-filter [-]."""
_SAME = (1.0, 1.0)
_ROUNDING = 1e-12
"""Height that is rounding, over the largest measured height [-]."""
_ALREADY = 1e-3
"""Relative difference below which a stated cut-off is the nesting index [-]."""


def surface_texture(
    surface: Surface, settings: TextureSettings, *, stretch: tuple[float, float] = _SAME
) -> Texture:
    """Return the scale-limited profile or map of a surface.

    Args:
        surface: as measured.
        settings: nesting indices and form.
        stretch: factors of the indices of the S-filter and the L-filter [-]; the
            evaluation length does not change with them.

    Raises:
        UsageError: a surface too small for its nesting indices.
        SurfaceTooSmall: too few measured points.
    """
    if isinstance(surface, Profile):
        return _profile_texture(surface, settings, stretch)
    return _map_texture(surface, settings, stretch)


def _profile_texture(
    profile: Profile, settings: TextureSettings, stretch: tuple[float, float]
) -> Texture:
    """Return the roughness profile: form removed, then S-filter, then L-filter.

    Half a nesting index is left out at each end; a profile too short for it keeps its
    ends, where the filters fit the measured side only (ISO 16610-28). Sections that do
    not fit are left out as well. Each departure is a remark.
    """
    remarks: list[str] = []
    given = _stretched(_undone(profile, settings, remarks), stretch)
    flat = _without_form(profile, settings)
    primary, valid = _short_waves_removed(flat, given)
    long = smooth_long(primary, valid, (profile.spacing,), given)
    inner, sections = _evaluated(profile, settings, given.long is not None, remarks)
    known = (valid & np.isfinite(long))[inner]
    rough = _without_rounding(primary - long, profile)
    heights = np.where(known, rough[inner], 0.0)
    if int(known.sum()) < MINIMUM_VALID_POINTS:
        raise UsageError(
            f"profile {profile.name!r} has {int(known.sum())} points in its evaluation "
            "length; choose a longer nesting index, or measure with a smaller pitch"
        )
    # The mean line of the evaluation length is the reference of all its parameters.
    mean = heights[known].mean() if given.long is None else 0.0
    return Texture(
        heights=np.where(known, heights - mean, 0.0),
        valid=known,
        spacing=(profile.spacing,),
        reference=np.where(np.isfinite(long), long, 0.0)[inner] + mean,
        settings=settings,
        sections=sections,
        remarks=tuple(remarks),
        offset=(inner.start,),
    )


def _map_texture(
    areal: Areal, settings: TextureSettings, stretch: tuple[float, float]
) -> Texture:
    """Return the S-F or S-L surface of a map.

    Without an L-filter the whole map is evaluated, about its form; with one, half a
    nesting index is left out at each side where at least one nesting index remains.
    """
    remarks: list[str] = []
    given = _stretched(_undone(areal, settings, remarks), stretch)
    side = min(n * d for n, d in zip(areal.heights.shape, areal.spacing, strict=True))
    if given.short is not None and side < given.short:
        remarks.append(
            f"the map is {side * 1e6:.3g} µm wide, less than the nesting index of the "
            f"S-filter of {given.short * 1e6:.3g} µm: across it little but the mean "
            "remains"
        )
    flat = _without_form(areal, settings)
    primary, valid = _short_waves_removed(flat, given)
    long = smooth_long(primary, valid, areal.spacing, given)
    inner = _inner_map(areal, settings, given.long is not None, remarks)
    known = (valid & np.isfinite(long))[inner]
    heights = _without_rounding(primary - long, areal)[inner]
    mean = heights[known].mean() if known.any() else 0.0
    return Texture(
        heights=np.where(known, heights - mean, 0.0),
        valid=known,
        spacing=areal.spacing,
        reference=np.where(np.isfinite(long), long, 0.0)[inner] + mean,
        settings=settings,
        remarks=tuple(remarks),
        offset=(inner[0].start, inner[1].start),
    )


def _without_rounding(heights: FloatArray, surface: Surface) -> FloatArray:
    """Return zeros where all that remains of a surface is rounding [m]."""
    largest = float(np.abs(surface.heights).max())
    if np.nanmax(np.abs(heights), initial=0.0) <= _ROUNDING * largest:
        return np.zeros(heights.shape)
    return heights


def smooth_long(
    heights: FloatArray,
    valid: BoolArray,
    spacing: tuple[float, ...],
    settings: TextureSettings,
) -> FloatArray:
    """Return the waves beyond the L-filter [m]; 0 without one."""
    index = settings.long
    if index is None:
        return np.zeros(heights.shape)

    def smooth(share: FloatArray) -> FloatArray:
        if heights.ndim == 1:
            return smooth_line(heights, share, index, spacing[0])
        return smooth_map(heights, share, index, (spacing[0], spacing[1]))

    if settings.robust:
        return smooth_robustly(heights, valid, smooth)
    return smooth(known_share(valid))


def _stretched(
    settings: TextureSettings, stretch: tuple[float, float]
) -> TextureSettings:
    """Return the settings with their indices multiplied."""
    short, long = (
        None if one is None else one * factor
        for one, factor in zip((settings.short, settings.long), stretch, strict=True)
    )
    return replace(settings, short=short, long=long)


def _undone(
    surface: Surface, settings: TextureSettings, remarks: list[str]
) -> TextureSettings:
    """Return the settings without filters that the instrument has applied already."""
    given = settings
    stated = surface.instrument
    if (
        stated.cutoff_long is not None
        and settings.long is not None
        and long_waves_removed(surface)
    ):
        if stated.cutoff_long < settings.long * (1 - _ALREADY):
            raise UsageError(
                f"surface {surface.name!r} was filtered with lambda_c = "
                f"{stated.cutoff_long:g} m, below the nesting index of "
                f"{settings.long:g} m; choose a shorter nesting index, or read the "
                "unfiltered profile"
            )
        if stated.cutoff_long <= settings.long * (1 + _ALREADY):
            remarks.append("the file states that the L-filter was applied already")
            given = replace(given, long=None)
    if stated.cutoff_short is not None and settings.short is not None:
        if stated.cutoff_short > settings.short * (1 + _ALREADY):
            remarks.append(
                f"the file states an S-filter of {stated.cutoff_short * 1e6:g} µm, "
                "longer than the nesting index"
            )
        if stated.cutoff_short >= settings.short * (1 - _ALREADY):
            given = replace(given, short=None)
    return given


def _without_form(surface: Surface, settings: TextureSettings) -> Surface:
    if settings.form > 1:
        return remove_form(surface, degree=settings.form)
    return level(surface)


def _short_waves_removed(
    flat: Surface, settings: TextureSettings
) -> tuple[FloatArray, BoolArray]:
    """Return the primary profile or map [m] and where it is known."""
    if settings.short is None:
        return flat.heights, flat.valid
    share = known_share(flat.valid)
    if isinstance(flat, Profile):
        found = smooth_line(flat.heights, share, settings.short, flat.spacing)
    else:
        found = smooth_map(flat.heights, share, settings.short, flat.spacing)
    known = flat.valid & np.isfinite(found)
    return np.where(known, found, 0.0), known


def _evaluated(
    profile: Profile, settings: TextureSettings, filtered: bool, remarks: list[str]
) -> tuple[slice, int]:
    """Return the evaluation length and the number of its sections."""
    points, pitch = profile.heights.size, profile.spacing
    if settings.long is None:
        return slice(0, points), SECTIONS
    section = settings.long / pitch
    ends = 2 * ENDS * section if filtered else 0.0
    sections = int((points - ends) / section + 1e-6)
    if sections < SECTIONS and int(points / section + 1e-6) > sections:
        sections = int(points / section + 1e-6)
        remarks.append(
            "the profile is too short to leave out half a nesting index at each end; "
            "there the filter has measured heights on one side only"
        )
    sections = min(sections, SECTIONS)
    if sections < 1:
        raise UsageError(
            f"profile {profile.name!r} is {points * pitch:.3g} m long, shorter than "
            f"one section of {settings.long:g} m; choose a shorter nesting index with "
            "--filter, or measure a longer profile"
        )
    if sections < SECTIONS:
        remarks.append(
            f"{sections} of {SECTIONS} sections of {settings.long * 1e3:g} mm fit into "
            "the profile"
        )
    used = round(sections * section)
    start = (points - used) // 2
    return slice(start, start + used), sections


def _inner_map(
    areal: Areal, settings: TextureSettings, filtered: bool, remarks: list[str]
) -> tuple[slice, slice]:
    """Return the evaluation area."""
    rows, columns = areal.heights.shape
    if settings.long is None or not filtered:
        return slice(0, rows), slice(0, columns)
    cut = [int(np.ceil(ENDS * settings.long / one - 1e-9)) for one in areal.spacing]
    sides = [n * d for n, d in zip((rows, columns), areal.spacing, strict=True)]
    if min(sides) < settings.long * (1 - 1e-9):
        raise UsageError(
            f"map {areal.name!r} is {min(sides):.3g} m wide, less than the nesting "
            f"index of {settings.long:g} m; choose a shorter one, or measure a larger "
            "map"
        )
    if min(sides) < (1 + 2 * ENDS) * settings.long * (1 - 1e-9):
        remarks.append(
            "the map is too small to leave out half a nesting index at each side; "
            "there the filter has measured heights on one side only"
        )
        return slice(0, rows), slice(0, columns)
    return slice(cut[0], rows - cut[0]), slice(cut[1], columns - cut[1])
