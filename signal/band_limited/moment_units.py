# SPDX-License-Identifier: MIT
"""Moments of a fit as those of the surface."""

from jointbench.signal.band_limited.band_records import Interval95, RoughnessMoments


def in_metres(
    pitch: float,
    scale: float,
    waves: tuple[float, float],
    parts: list[Interval95],
    *,
    modelled: bool,
) -> RoughnessMoments:
    """Return moments in units of the pitch and the scale as those of the surface.

    Args:
        pitch: of the heights [m].
        scale: of the heights [m].
        waves: shortest and longest wavelength [pitches].
        parts: rms height, slope and curvature.
        modelled: whether they are those of a model.
    """
    factors = (scale, scale / pitch, scale / pitch**2)
    height, slope, curvature = (
        part.times(factor) for part, factor in zip(parts, factors, strict=True)
    )
    return RoughnessMoments(
        shortest=waves[0] * pitch,
        longest=waves[1] * pitch,
        height=height,
        slope=slope,
        curvature=curvature,
        modelled=modelled,
    )
