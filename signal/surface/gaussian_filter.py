# SPDX-License-Identifier: MIT
"""Gaussian filters of surface texture: short waves lambda_s and long waves lambda_c."""

from dataclasses import replace

import numpy as np
import scipy.ndimage

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.provenance import step
from jointbench.acquisition.records.surfaces import (
    Areal,
    Profile,
    Surface,
    SurfaceInstrument,
)
from jointbench.signal.surface.levelling import MINIMUM_VALID_POINTS, level

GAUSSIAN_ALPHA = float(np.sqrt(np.log(2) / np.pi))
"""Constant of ISO 16610-21 that makes the transmission at the cut-off 50 % [-]."""
_SIGMA_SHARE = GAUSSIAN_ALPHA / float(np.sqrt(2 * np.pi))
"""Standard deviation of the weights over the cut-off wavelength [-]."""
_REACH = 4.0
"""Half width of the weights in standard deviations; beyond it they are below 1e-4."""
_ENDS_SHARE = 0.5
"""Length that is left out at each end, over the longest cut-off [-]: there the weights
reach beyond the heights."""


def transmission(wavenumber: FloatArray, cutoff: float) -> FloatArray:
    """Return the amplitude that a low-pass Gaussian filter transmits.

    Args:
        wavenumber: 2 pi over the wavelength [rad/m], any shape.
        cutoff: wavelength that it transmits by half [m].

    Source:
        ISO 16610-21:2011, 4.2: exp(-pi (alpha cutoff / wavelength)^2).
    """
    share = GAUSSIAN_ALPHA * cutoff * wavenumber / (2 * np.pi)
    passed: FloatArray = np.exp(-np.pi * share**2)
    return passed


def filter_waves(
    surface: Surface, *, short: float | None = None, long: float | None = None
) -> Surface:
    """Remove waves shorter than one cut-off and longer than another.

    Args:
        surface: a profile or a map; levelled first. Missing points have no weight and
            stay missing.
        short: cut-off lambda_s below which waves are removed [m]; None removes none.
        long: cut-off lambda_c above which waves are removed [m]; None removes none.

    Returns:
        The filtered surface without its ends, half the longest cut-off each; its
        instrument states the cut-offs, its provenance one more step
        ``"gaussian_filter"``.

    Raises:
        UsageError: no cut-off, one that is shorter than two samples, the wrong order,
            or a surface too short for them.
        SurfaceTooSmall: too few measured points.
    """
    spacing = _pitches(surface)
    longest = _checked(surface, short, long, max(spacing))
    flat = level(surface)
    heights = flat.heights
    if short is not None:
        heights = _smooth(heights, flat, short, spacing)
    if long is not None:
        heights = heights - _smooth(heights, flat, long, spacing)
    cut = [_ends(longest, one) for one in spacing]
    inner = tuple(slice(k, n - k) for k, n in zip(cut, heights.shape, strict=True))
    note = step(
        "gaussian_filter", short_m=short or 0.0, long_m=long or 0.0, ends=cut[-1]
    )
    valid = flat.valid[inner]
    return replace(
        flat,
        heights=np.where(valid, heights[inner], 0.0),
        valid=valid,
        instrument=_stated(surface.instrument, short, long),
        provenance=(*surface.provenance, note),
    )


def _pitches(surface: Surface) -> tuple[float, ...]:
    """Return the spacing in each direction [m]."""
    return (surface.spacing,) if isinstance(surface, Profile) else surface.spacing


def _checked(
    surface: Surface, short: float | None, long: float | None, pitch: float
) -> float:
    """Return the longest cut-off [m] after checking both."""
    given = [one for one in (short, long) if one is not None]
    if not given or min(given) < 2 * pitch:
        said = " and ".join(f"{one:g} m" for one in given) or "none"
        raise UsageError(
            f"cut-offs: {said}; a filter has one at least, and not below two samples "
            f"({2 * pitch:g} m)"
        )
    if short is not None and long is not None and not short < long:
        raise UsageError(
            f"lambda_s of {short:g} m is not below lambda_c of {long:g} m; give the "
            "short one first, as '2.5 um:0.8 mm'"
        )
    shape = zip(surface.heights.shape, _pitches(surface), strict=True)
    for points, one in shape:
        left = points - 2 * _ends(max(given), one)
        if left < MINIMUM_VALID_POINTS:
            raise UsageError(
                f"surface {surface.name!r} is {points * one:.3g} m long and a cut-off "
                f"of {max(given):g} m takes half of it at each end; choose a shorter "
                "cut-off, or measure a longer line"
            )
    return max(given)


def _ends(cutoff: float, pitch: float) -> int:
    """Return how many points are left out at each end."""
    return int(np.ceil(_ENDS_SHARE * cutoff / pitch - 1e-9))


def _smooth(
    heights: FloatArray,
    flat: Profile | Areal,
    cutoff: float,
    spacing: tuple[float, ...],
) -> FloatArray:
    """Return the weighted means of the measured points."""
    widths = [_SIGMA_SHARE * cutoff / one for one in spacing]
    known = flat.valid.astype(np.float64)
    total, weight = (
        scipy.ndimage.gaussian_filter(part, widths, mode="constant", truncate=_REACH)
        for part in (heights * known, known)
    )
    means: FloatArray = total / np.maximum(weight, np.finfo(np.float64).tiny)
    return means


def _stated(
    instrument: SurfaceInstrument, short: float | None, long: float | None
) -> SurfaceInstrument:
    """Return the instrument with the narrower of its own and the given cut-offs."""
    shorts = [c for c in (instrument.cutoff_short, short) if c is not None]
    longs = [c for c in (instrument.cutoff_long, long) if c is not None]
    return replace(
        instrument,
        cutoff_short=max(shorts, default=None),
        cutoff_long=min(longs, default=None),
    )
