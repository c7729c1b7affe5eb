# SPDX-License-Identifier: MIT
"""What the options of ``jointbench surface`` ask beside the fit of each surface."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.errors import UnitError, UsageError
from jointbench.acquisition.basics.units import parse_value
from jointbench.acquisition.records.provenance import Step
from jointbench.acquisition.records.surfaces import Areal, Profile, Surface
from jointbench.signal.fractal.weierstrass_fit import DIMENSION_RANGE, fit_weierstrass
from jointbench.signal.surface.structure_function import (
    StructureFunction,
    structure_function,
)
from jointbench.signal.surface.structure_map import isotropy
from jointbench.signal.surface.surface_treatment import UNTREATED, SurfaceTreatment
from jointbench.station.roughness.texture_request import TextureRequest
from jointbench.station.screen.value_text import engineering, with_sd

_AT_THE_END = 1e-3
"""A D this near to the end of its range is no D [-]."""


@dataclass(frozen=True, slots=True)
class SurfaceOptions:
    """What is asked of all surfaces of a command.

    Attributes:
        treatment: before the fit.
        pool: all profiles as one structure function too.
        directions: compare the directions of each map.
        weierstrass: frequency ratio of a Weierstrass-Mandelbrot profile to fit beside
            [-]; None for no such fit.
        structure_map: file for S at all lags of one surface; None for none.
        texture: standard parameters to compute; None for none.
    """

    treatment: SurfaceTreatment = UNTREATED
    pool: bool = False
    directions: bool = False
    weierstrass: float | None = None
    structure_map: Path | None = None
    texture: TextureRequest | None = None


@dataclass(frozen=True, slots=True)
class Beside:
    """What one surface has beside its fit: lines for the screen, keys for JSON."""

    lines: tuple[str, ...] = ()
    keys: tuple[tuple[str, object], ...] = ()


PLAIN = SurfaceOptions()
"""Nothing but the fit."""
NOTHING_BESIDE = Beside()


def surface_treatment(
    form: int | None,
    outliers: float | None,
    waves: str | None,
    degrees: float | None,
) -> SurfaceTreatment:
    """Return the treatment as typed.

    Args:
        form: degree of the polynomial [-].
        outliers: limit in robust standard deviations [-].
        waves: cut-offs ``"2.5 um:0.8 mm"``, either of them may be left out.
        degrees: direction of the lines of a map [deg].

    Raises:
        UsageError: the cut-offs are not two parts, or one has no unit of length.
    """
    short, long = (None, None) if waves is None else _cutoffs(waves)
    radians = None if degrees is None else float(np.radians(degrees))
    return SurfaceTreatment(form, outliers, radians, short, long)


def _cutoffs(text: str) -> tuple[float | None, float | None]:
    parts = [part.strip() for part in text.split(":")]
    if len(parts) != 2 or not any(parts):
        raise UsageError(
            f"--filter is {text!r}; give lambda_s and lambda_c, for example "
            "'2.5 um:0.8 mm', '2.5 um:' or ':0.8 mm'"
        )
    try:
        short, long = (parse_value(part, "length") if part else None for part in parts)
    except UnitError as error:
        raise UsageError(f"--filter is {text!r}: {error}") from error
    return short, long


def surface_options(
    treatment: SurfaceTreatment,
    *,
    pool: bool,
    directions: bool,
    weierstrass: float | None,
    structure_map: Path | None = None,
    texture: TextureRequest | None = None,
) -> SurfaceOptions:
    """Return the options as typed."""
    return SurfaceOptions(
        treatment, pool, directions, weierstrass, structure_map, texture
    )


def require_suited(surfaces: Sequence[Surface], options: SurfaceOptions) -> None:
    """Raise `UsageError` where an option asks of a surface what it cannot give."""
    of_maps = {
        "--direction": options.treatment.direction is not None,
        "--directions": options.directions,
    }
    of_profiles = {
        "--pool": options.pool,
        "--weierstrass": options.weierstrass is not None,
    }
    if options.structure_map is not None and len(surfaces) > 1:
        raise UsageError(
            f"--structure-map takes one surface, {len(surfaces)} are given; run the "
            "command for each"
        )
    for option in (name for name, asked in of_maps.items() if asked):
        _require_all(surfaces, Areal, option, "map")
    for option in (name for name, asked in of_profiles.items() if asked):
        _require_all(surfaces, Profile, option, "profile")


def _require_all(
    surfaces: Sequence[Surface], kind: type[Surface], option: str, word: str
) -> None:
    wrong = [one.name for one in surfaces if not isinstance(one, kind)]
    if wrong:
        raise UsageError(
            f"surface {wrong[0]!r} is no {word}, and {option} takes {word}s only; "
            f"leave out the surface or {option}"
        )


def beside_the_fit(
    surface: Surface, estimate: StructureFunction, options: SurfaceOptions
) -> Beside:
    """Return what the options ask of one treated surface beside its fit.

    Raises:
        UsageError: a map too small to compare its directions, or a profile too short
            for its waves.
    """
    parts = []
    if options.treatment.changes_heights:
        parts.append(_changes(surface))
    if options.treatment.direction is not None:
        parts.append(_direction(estimate))
    if options.directions and isinstance(surface, Areal):
        parts.append(_directions(surface))
    if options.weierstrass is not None:
        parts.append(_weierstrass(surface, options.weierstrass))
    return Beside(
        tuple(line for part in parts for line in part.lines),
        tuple(key for part in parts for key in part.keys),
    )


def _changes(surface: Surface) -> Beside:
    """State what was masked and removed; in JSON it is in the provenance."""
    lines = [_said(one, surface) for one in surface.provenance]
    return Beside(tuple(line for line in lines if line))


def _said(done: Step, surface: Surface) -> str:
    detail = dict(done.detail)
    if done.name == "mask_outliers":
        points = surface.heights.size
        return f"{detail['masked']} of {points} points masked as outliers"
    if done.name == "remove_form":
        taken = engineering(float(detail["rms_taken_m"]), "m")
        return f"form of degree {detail['degree']} removed, {taken} rms"
    if done.name == "gaussian_filter":
        return _filtered(float(detail["short_m"]), float(detail["long_m"]), done)
    return ""


def _filtered(short: float, long: float, done: Step) -> str:
    said = [
        f"{word} than {engineering(cutoff, 'm')}"
        for word, cutoff in (("shorter", short), ("longer", long))
        if cutoff > 0
    ]
    ends = dict(done.detail)["ends"]
    return f"waves {' and '.join(said)} filtered out, {ends} points cut off at each end"


def _direction(estimate: StructureFunction) -> Beside:
    """Name the lines of a map that were used."""
    found = [s for s in estimate.provenance if s.name == "profiles_along"]
    detail = dict(found[-1].detail)
    asked, met = (
        float(np.degrees(float(detail[key]))) for key in ("asked_rad", "met_rad")
    )
    face = estimate.samplings[0]
    line = (
        f"along {met:.1f} degrees from the rows ({asked:g} asked): {face.profiles} "
        f"lines of {face.points} points, {engineering(face.spacing, 'm')} apart"
    )
    keys = {
        "asked_deg": asked,
        "met_deg": met,
        "lines": face.profiles,
        "points": face.points,
        "spacing_m": face.spacing,
    }
    return Beside((line,), (("direction", keys),))


def _directions(areal: Areal) -> Beside:
    """State whether a map is equally rough in all directions."""
    found = isotropy(areal)
    word = "isotropic" if found.isotropic else "anisotropic, with a lay"
    keys = {
        "isotropic": found.isotropic,
        "reason": found.reason,
        "angle_deg": np.degrees(found.angle).tolist(),
        "ratio": found.ratio.tolist(),
        "lag_m": found.lag.tolist(),
        "value_m2": found.value.tolist(),
    }
    return Beside((f"{word}: {found.reason}",), (("directions", keys),))


def _weierstrass(surface: Surface, gamma: float) -> Beside:
    """Fit the waves of a Weierstrass-Mandelbrot profile to the heights as they are."""
    found = fit_weierstrass(structure_function(surface, remove="mean"), gamma=gamma)
    low, high = (engineering(end, "m") for end in found.roughness_interval)
    waves = " to ".join(engineering(1 / end, "m") for end in found.band[::-1])
    ends = [abs(found.dimension - end) for end in DIMENSION_RANGE]
    at_the_end = bool(min(ends) < _AT_THE_END)
    line = (
        f"Weierstrass-Mandelbrot profile of ratio {gamma:g}: "
        f"D = {with_sd(found.dimension, found.dimension_sd)}, "
        f"G = {engineering(found.roughness, 'm')} ({low} to {high}), waves of {waves}, "
        f"ln S within {found.residual_rms:.2g} (rms)"
    )
    if at_the_end:
        line += "; D is at the end of its range: it is no such profile"
    keys = {
        "gamma": gamma,
        "dimension": found.dimension,
        "dimension_sd": found.dimension_sd,
        "dimension_at_limit": at_the_end,
        "roughness_m": found.roughness,
        "roughness_interval_m": found.roughness_interval,
        "band_per_m": found.band,
        "misfit": found.residual_rms,
    }
    return Beside((line,), (("weierstrass", keys),))
