# SPDX-License-Identifier: MIT
"""Level a surface before its statistics, and record it in its provenance."""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.records.provenance import Step, step
from jointbench.acquisition.records.surfaces import Areal, Profile, Surface

MINIMUM_VALID_POINTS = 16
"""Least points for the dependence of roughness on the lag [-]."""


class SurfaceTooSmall(BadData):
    """A surface with too few measured points for any statistics."""


def level(surface: Surface) -> Surface:
    """Remove the least-squares mean line of a profile or mean plane of a map.

    Args:
        surface: a profile or a map; missing points are not used.

    Returns:
        The same surface with residual heights [m] (0 where missing) and one more
        step ``"level"`` in its provenance with the slopes [-] that were removed.

    Raises:
        SurfaceTooSmall: fewer than `MINIMUM_VALID_POINTS` points were measured.
    """
    count = int(np.count_nonzero(surface.valid))
    if count < MINIMUM_VALID_POINTS:
        raise SurfaceTooSmall(
            f"surface {surface.name!r} has {count} measured points, at least "
            f"{MINIMUM_VALID_POINTS} are needed; measure a longer line or a larger map"
        )
    if isinstance(surface, Profile):
        return _level_profile(surface)
    return _level_areal(surface)


def _level_profile(profile: Profile) -> Profile:
    """Remove the mean line of a profile."""
    position = _centred(profile.heights.size)
    residual, (slope,) = _residual(profile, [position])
    return replace(
        profile,
        heights=residual,
        provenance=(
            *profile.provenance,
            step("level", form="mean line", slope=slope / profile.spacing),
        ),
    )


def _level_areal(areal: Areal) -> Areal:
    """Remove the mean plane of a map."""
    rows, columns = areal.heights.shape
    residual, slopes = _residual(areal, [_centred(rows)[:, None], _centred(columns)])
    note: Step = step(
        "level",
        form="mean plane",
        slope_x=slopes[1] / areal.spacing[1],
        slope_y=slopes[0] / areal.spacing[0],
    )
    return replace(areal, heights=residual, provenance=(*areal.provenance, note))


def _centred(count: int) -> FloatArray:
    """Return the indices 0..count-1 about their mean, so that sums keep digits."""
    return np.arange(count, dtype=np.float64) - (count - 1) / 2


def _residual(
    surface: Surface, positions: list[FloatArray]
) -> tuple[FloatArray, list[float]]:
    """Return heights minus their best linear form, and its slopes [m per sample].

    Directions in which every measured point shares one position get slope 0.
    """
    weight = surface.valid.astype(np.float64)
    mean = np.sum(surface.heights * weight) / np.sum(weight)
    heights = (surface.heights - mean) * weight
    shape = surface.heights.shape
    bases = [np.broadcast_to(position, shape) for position in positions]
    bases = [base - np.sum(base * weight) / np.sum(weight) for base in bases]
    gram = np.array([[np.sum(a * b * weight) for b in bases] for a in bases])
    moment = np.array([np.sum(base * heights) for base in bases])
    slopes = np.linalg.lstsq(gram, moment, rcond=None)[0]
    for base, slope in zip(bases, slopes, strict=True):
        heights -= slope * base * weight
    return heights, [float(slope) for slope in slopes]
