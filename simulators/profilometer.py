# SPDX-License-Identifier: MIT
"""A simulated profilometer: measures a surface and exports it as instruments do."""

from dataclasses import dataclass, replace

import numpy as np
import scipy.ndimage

from jointbench.acquisition.arrays import BoolArray, FloatArray
from jointbench.acquisition.errors import UsageError
from jointbench.acquisition.records import Step, step
from jointbench.acquisition.surfaces import Areal, Profile, SurfaceInstrument


@dataclass(frozen=True, slots=True)
class Profilometer:
    """An optical instrument.

    Attributes:
        noise: standard deviation of one height [m].
        spot: standard deviation of its Gaussian point spread [m]; 0 for none.
        missing: share of points without an answer [-].
        resolution: step of the exported heights [m].
    """

    noise: float = 1e-9
    spot: float = 0.0
    missing: float = 0.0
    resolution: float = 1e-10

    def __post_init__(self) -> None:
        """Refuse shares outside 0..1 and negative sizes."""
        if not 0 <= self.missing < 1:
            raise UsageError(f"missing is {self.missing!r}, it must lie in 0..1")
        if min(self.noise, self.spot) < 0 or self.resolution <= 0:
            raise UsageError(
                "noise and spot must not be negative, resolution must be positive; "
                f"got {self.noise!r}, {self.spot!r} and {self.resolution!r} m"
            )


def measure_profile(
    profile: Profile, instrument: Profilometer, *, seed: int
) -> Profile:
    """Measure a profile with noise, point spread and drop-outs.

    Args:
        profile: the surface as it is.
        instrument: what measures it.
        seed: of noise and drop-outs.

    Returns:
        The profile as exported; heights 0 where not valid.
    """
    heights = profile.heights
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
    """Measure a map with noise, point spread and drop-outs.

    Args:
        areal: the surface as it is.
        instrument: what measures it.
        seed: of noise and drop-outs.

    Returns:
        The map as exported; heights 0 where not valid.
    """
    heights = areal.heights
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


def _read(
    heights: FloatArray, instrument: Profilometer, seed: int
) -> tuple[FloatArray, BoolArray]:
    """Return what the instrument answers at every point, and whether it does."""
    rng = np.random.default_rng([seed, 6])
    noisy = heights + instrument.noise * rng.standard_normal(heights.shape)
    valid = rng.uniform(size=heights.shape) >= instrument.missing
    counts = np.round(noisy / instrument.resolution) * instrument.resolution
    return np.where(valid, counts, 0.0), valid


def _measured(instrument: Profilometer, seed: int) -> Step:
    return step(
        "simulated_profilometer",
        noise_m=instrument.noise,
        spot_m=instrument.spot,
        missing=instrument.missing,
        resolution_m=instrument.resolution,
        seed=seed,
    )
