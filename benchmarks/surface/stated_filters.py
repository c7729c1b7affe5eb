# SPDX-License-Identifier: MIT
"""Filters that the instrument states: the fitted blur beside them, and H through them.

python -m benchmarks.surface.stated_filters --count 40 --seed N prints a table. Exact
self-affine profiles are traced by a round tip on points four times as dense, or
filtered by Gaussian weights in the time domain; the fit knows the radius or the
cut-off. Of a tip the deviation is that of the blur which the heights show without the
tip as a prior, from the stated one, over the scatter of both; of a cut-off that of H.
Tips are as stated, which leaves less than one standard deviation since that includes
an error of the radius, or within 25 % of it, the tolerance of 2 um in ISO 3274.
"""

import argparse
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.ndimage import gaussian_filter1d

from benchmarks.gap.outcomes import share_text
from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.provenance import step
from jointbench.acquisition.records.surfaces import Profile
from jointbench.signal.band_limited.band_limited_fit import fit_band_limited
from jointbench.signal.band_limited.band_records import BandLimitedFit
from jointbench.simulators.rough_surfaces.profilometer import traced
from jointbench.simulators.rough_surfaces.rough_surface import rough_profile

POINTS, PITCH, DENSE = 4000, 0.2e-6, 4
WIDTH = 0.4697186 / np.sqrt(2 * np.pi)
"""Standard deviation of the Gaussian weights of ISO 16610-21 over the cut-off [-]."""


def _drawn(
    rng: np.random.Generator, seed: int, pitch: float, points: int
) -> tuple[Profile, float]:
    """Return a self-affine profile, and its H."""
    hurst = float(rng.uniform(0.3, 0.85))
    profile = rough_profile(
        points, spacing=pitch, dimension=2 - hurst, roughness=1e-10, seed=seed
    )
    every = profile.heights[:: round(PITCH / pitch)]
    scale = PITCH * float(rng.uniform(0.05, 0.2)) / np.std(np.diff(every))
    return replace(profile, heights=profile.heights * scale), hurst


def worn_tip(seed: int) -> tuple[Profile, float]:
    """Return the path of a tip with a radius within the tolerance of the stated."""
    return tip(seed, tolerance=0.25)


def tip(seed: int, *, tolerance: float = 0.0) -> tuple[Profile, float]:
    """Return the path of a tip of 1.5 to 5 um, with its radius stated."""
    rng = np.random.default_rng([seed, 21])
    profile, hurst = _drawn(rng, seed, PITCH / DENSE, POINTS * DENSE)
    radius = float(rng.uniform(1.5e-6, 5e-6))
    own = radius * float(1 + tolerance * rng.uniform(-1, 1))
    heights = traced(profile.heights, (profile.spacing,), own)[::DENSE]
    stated = replace(profile.instrument, stylus_radius=radius)
    valid = profile.valid[::DENSE]
    made = replace(
        profile, heights=heights, valid=valid, spacing=PITCH, instrument=stated
    )
    return made, hurst


def short_cut(seed: int) -> tuple[Profile, float]:
    """Return a profile without waves below lambda_s of 5 to 15 samples, stated."""
    rng = np.random.default_rng([seed, 22])
    profile, hurst = _drawn(rng, seed, PITCH, POINTS + 200)
    waves = float(rng.uniform(5, 15))
    heights = _mean(profile.heights, waves)[100:-100]
    stated = replace(profile.instrument, cutoff_short=waves * PITCH)
    valid = profile.valid[100:-100]
    return replace(profile, heights=heights, valid=valid, instrument=stated), hurst


def long_cut(seed: int) -> tuple[Profile, float]:
    """Return a profile without waves above lambda_c of a tenth to a third, stated."""
    rng = np.random.default_rng([seed, 23])
    profile, hurst = _drawn(rng, seed, PITCH, 3 * POINTS)
    waves = POINTS * float(rng.uniform(0.1, 0.33))
    part = slice(POINTS, 2 * POINTS)
    heights = (profile.heights - _mean(profile.heights, waves))[part]
    stated = replace(profile.instrument, cutoff_long=waves * PITCH)
    applied = step("gaussian_filter", long_m=waves * PITCH, short_m=0.0)
    made = replace(
        profile,
        heights=heights,
        valid=profile.valid[part],
        instrument=stated,
        provenance=(*profile.provenance, applied),
    )
    return made, hurst


def _mean(heights: FloatArray, waves: float) -> FloatArray:
    found: FloatArray = gaussian_filter1d(heights, WIDTH * waves, truncate=6.0)
    return found


def tip_deviation(fit: BandLimitedFit, hurst: float) -> float | None:
    """Return how far the fitted blur is from that of the stated tip [sd]."""
    return fit.tip_deviation


def hurst_deviation(fit: BandLimitedFit, hurst: float) -> float | None:
    """Return how far H is from the truth, over a quarter of its interval [sd]."""
    if fit.hurst is None:
        return None
    end = fit.hurst.high if fit.hurst.value < hurst else fit.hurst.low
    return 1.96 * (fit.hurst.value - hurst) / abs(end - fit.hurst.value)


Deviation = Callable[[BandLimitedFit, float], float | None]
KINDS: dict[str, tuple[Callable[[int], tuple[Profile, float]], Deviation]] = {
    "radius of the tip: blur": (tip, tip_deviation),
    "radius of the tip: H": (tip, hurst_deviation),
    "radius within 25 %: blur": (worn_tip, tip_deviation),
    "radius within 25 %: H": (worn_tip, hurst_deviation),
    "lambda_s: H": (short_cut, hurst_deviation),
    "lambda_c: H": (long_cut, hurst_deviation),
}


def main() -> None:
    """Fit and print the deviations."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", default="", help="kinds that begin so")
    asked = parser.parse_args()
    print(
        "| stated: compared | n | no band | rms deviation [sd] | mean | largest "
        "| within 2 sd |"
    )
    print("|---|---|---|---|---|---|---|")
    done: dict[tuple[object, int], tuple[BandLimitedFit, float]] = {}
    for name, (make, deviation) in KINDS.items():
        if not name.startswith(asked.only):
            continue
        found = []
        for seed in range(asked.seed, asked.seed + asked.count):
            if (make, seed) not in done:
                profile, hurst = make(seed)
                done[make, seed] = fit_band_limited([profile]), hurst
            found.append(deviation(*done[make, seed]))
        known = np.array([one for one in found if one is not None])
        inside = share_text(int(np.sum(np.abs(known) <= 2)), known.size)
        rms = float(np.sqrt(np.mean(known**2)))
        print(
            f"| {name} | {len(found)} | {len(found) - known.size} | {rms:.2f} | "
            f"{known.mean():+.2f} | {np.abs(known).max():.2f} | {inside} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
