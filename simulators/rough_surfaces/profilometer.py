# SPDX-License-Identifier: MIT
"""A simulated profilometer that measures and exports a surface."""

from dataclasses import dataclass, replace

import numpy as np
import scipy.ndimage

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.provenance import Step, step
from jointbench.acquisition.records.surfaces import Areal, Profile, SurfaceInstrument


@dataclass(frozen=True, slots=True)
class Profilometer:
    """An optical or a stylus instrument.

    Attributes:
        noise: standard deviation of one height [m].
        spot: standard deviation of its Gaussian point spread [m]; 0 for none.
        tip: radius of its round stylus tip [m]; 0 for none.
        drift: drift of the base during the scan [m], half a wave of random phase.
        missing: share of points without a height [-].
        resolution: step of the exported heights [m].
    """

    noise: float = 1e-9
    spot: float = 0.0
    tip: float = 0.0
    drift: float = 0.0
    missing: float = 0.0
    resolution: float = 1e-10

    def __post_init__(self) -> None:
        """Refuse shares outside 0..1 and negative sizes."""
        if not 0 <= self.missing < 1:
            raise UsageError(f"missing is {self.missing!r}, it must be in 0..1")
        lengths = (self.noise, self.spot, self.tip, self.drift)
        if min(lengths) < 0 or self.resolution <= 0:
            raise UsageError(
                "noise, spot, tip and drift must not be negative, resolution must be "
                f"positive; got {lengths!r} and {self.resolution!r} m"
            )


def measure_profile(
    profile: Profile, instrument: Profilometer, *, seed: int
) -> Profile:
    """Measure a profile with tip, noise, point spread, drift and drop-outs.

    Args:
        profile: the true surface.
        instrument: its parameters.
        seed: of noise, drift and drop-outs.

    Returns:
        The exported profile; heights 0 where not valid.
    """
    heights = traced(profile.heights, (profile.spacing,), instrument.tip)
    if instrument.spot > 0:
        width = instrument.spot / profile.spacing
        heights = scipy.ndimage.gaussian_filter1d(heights, width, mode="nearest")
    heights, valid = _read(heights, instrument, seed)
    return replace(
        profile,
        heights=heights,
        valid=profile.valid & valid,
        instrument=SurfaceInstrument(name="simulated profilometer"),
        provenance=(*profile.provenance, _measured(instrument, seed)),
    )


def measure_areal(areal: Areal, instrument: Profilometer, *, seed: int) -> Areal:
    """Measure a map with tip, noise, point spread, drift and drop-outs.

    Args:
        areal: the true surface.
        instrument: its parameters.
        seed: of noise, drift and drop-outs.

    Returns:
        The exported map; heights 0 where not valid.
    """
    heights = traced(areal.heights, areal.spacing, instrument.tip)
    if instrument.spot > 0:
        width = tuple(instrument.spot / spacing for spacing in areal.spacing)
        heights = scipy.ndimage.gaussian_filter(heights, width, mode="nearest")
    heights, valid = _read(heights, instrument, seed)
    return replace(
        areal,
        heights=heights,
        valid=areal.valid & valid,
        instrument=SurfaceInstrument(name="simulated profilometer"),
        provenance=(*areal.provenance, _measured(instrument, seed)),
    )


def traced(
    heights: FloatArray, spacing: tuple[float, ...], radius: float
) -> FloatArray:
    """Return the path of the lowest point of a round tip that touches a surface.

    Args:
        heights: of the surface [m], along one or two directions.
        spacing: of the heights in each direction [m].
        radius: of the tip [m]; 0 for a point.

    Returns:
        Heights of the tip [m], same shape.

    Source:
        ISO 16610-41: the path of the tip is the dilation of the heights by the tip.
    """
    relief = float(np.ptp(heights))
    if radius == 0 or relief == 0:
        return heights
    # Further out the tip is higher above its lowest point than all relief.
    reach = radius if relief >= radius else np.sqrt(relief * (2 * radius - relief))
    lines = [np.arange(-int(reach / s), int(reach / s) + 1) * s for s in spacing]
    square = sum(np.square(line) for line in np.meshgrid(*lines, indexing="ij"))
    inside = square <= radius**2
    rise = np.where(inside, radius - np.sqrt(np.maximum(radius**2 - square, 0)), np.inf)
    return np.asarray(
        scipy.ndimage.grey_dilation(heights, structure=-rise, mode="nearest")
    )


def _read(
    heights: FloatArray, instrument: Profilometer, seed: int
) -> tuple[FloatArray, BoolArray]:
    """Return the reading at every point, and whether it is valid."""
    rng = np.random.default_rng([seed, 6])
    noisy = heights + instrument.noise * rng.standard_normal(heights.shape)
    valid = rng.uniform(size=heights.shape) >= instrument.missing
    if instrument.drift > 0:
        time = np.arange(heights.size).reshape(heights.shape) / heights.size
        phase = rng.uniform(0, 2 * np.pi)
        noisy = noisy + 0.5 * instrument.drift * np.sin(np.pi * time + phase)
    counts = np.round(noisy / instrument.resolution) * instrument.resolution
    return np.where(valid, counts, 0.0), valid


def _measured(instrument: Profilometer, seed: int) -> Step:
    return step(
        "simulated_profilometer",
        noise_m=instrument.noise,
        spot_m=instrument.spot,
        tip_m=instrument.tip,
        drift_m=instrument.drift,
        missing=instrument.missing,
        resolution_m=instrument.resolution,
        seed=seed,
    )
