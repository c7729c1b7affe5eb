# SPDX-License-Identifier: MIT
"""Which verdict saturated and fractal profiles of 16,000 points get.

python -m benchmarks.surface.roll_off --count 20 --seed 0 prints a table. Exponential
correlation is drawn as an autoregressive process, fractal profiles by circulants.
"""

import argparse
from collections import Counter
from collections.abc import Callable

import numpy as np
from scipy.signal import lfilter

from jointbench.acquisition.records.surfaces import Profile, all_valid
from jointbench.signal.band_limited.band_limited_fit import fit_band_limited
from jointbench.signal.fractal.fractal_fit import fit_fractal
from jointbench.signal.surface.structure_function import structure_function
from jointbench.simulators.rough_surfaces.rough_surface import rough_profile
from jointbench.station.screen.band_limited_words import qualified

POINTS, PITCH = 16_000, 1e-6  # [-], [m]
LENGTHS = (50, 100, 200, 400, 800, 2000)
DIMENSIONS = (1.3, 1.5, 1.7)


def exponential(length: int, seed: int) -> Profile:
    """Draw a profile of exponential correlation over a length [samples]."""
    keep = np.exp(-1 / length)
    white = np.random.default_rng([seed, length]).standard_normal(POINTS)
    white[1:] *= np.sqrt(1 - keep**2)
    heights = 1e-6 * lfilter([1.0], [1.0, -keep], white)
    return Profile("exponential", heights, PITCH, all_valid(heights))


def fractal(dimension: float, seed: int) -> Profile:
    """Draw a profile that is fractal over all lags."""
    return rough_profile(
        POINTS, spacing=PITCH, dimension=dimension, roughness=1e-10, seed=seed
    )


def verdicts(make: Callable[[int], Profile], seeds: range) -> tuple[str, str, int]:
    """Return the verdicts of the fit of D alone, of both, and unqualified ones."""
    alone: Counter[str] = Counter()
    both: Counter[str] = Counter()
    plain = 0
    for seed in seeds:
        profile = make(seed)
        fit = fit_fractal(structure_function(profile))
        band = fit_band_limited([profile])
        alone[fit.verdict.value] += 1
        both[band.verdict.value] += 1
        verdict, reason = qualified(fit, band)
        plain += verdict == "fractal" and "too short to decide" not in reason
    return _words(alone), _words(both), plain


def _words(counts: Counter[str]) -> str:
    return ", ".join(f"{word} {count}" for word, count in counts.most_common())


def main() -> None:
    """Fit and count."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    seeds = range(asked.seed, asked.seed + asked.count)
    print(
        "| profiles of 16,000 points | fit of D alone | longest waves | unqualified |"
    )
    print("|---|---|---|---|")
    kinds: dict[str, Callable[[int], Profile]] = {}
    for length in LENGTHS:
        kinds[f"exponential, {length}"] = lambda seed, n=length: exponential(n, seed)
    for dimension in DIMENSIONS:
        kinds[f"fractal, D {dimension:g}"] = lambda seed, d=dimension: fractal(d, seed)
    for name, make in kinds.items():
        alone, both, plain = verdicts(make, seeds)
        print(f"| {name} | {alone} | {both} | {plain} of {asked.count} |", flush=True)


if __name__ == "__main__":
    main()
