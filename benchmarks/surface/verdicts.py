# SPDX-License-Identifier: MIT
"""Which verdict surfaces get that are fractal nowhere, or within a band only.

python benchmarks/surface/verdicts.py --seeds 20 prints a table for docs/surface.md.
"""

import argparse
from collections import Counter
from collections.abc import Callable

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.signal import lfilter

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.surfaces import Profile, all_valid
from jointbench.signal.fractal.fractal_fit import fit_fractal
from jointbench.signal.surface.structure_function import structure_function
from jointbench.simulators.rough_surfaces.rough_surface import rough_profile

POINTS, SPACING = 12_000, 0.25e-6  # [-], [m]
FULL = "fractal"


def rough(dimension: float, seed: int) -> FloatArray:
    """Return an exact self-affine profile with steps of unit size."""
    profile = rough_profile(
        POINTS, spacing=SPACING, dimension=dimension, roughness=1e-10, seed=seed
    )
    return _of_unit_steps(profile.heights)


def saturating(seed: int) -> FloatArray:
    """Stop growing at a correlation length of 40 to 200 samples."""
    rng = np.random.default_rng([seed, 1])
    length = rng.uniform(40, 200)
    white = rng.standard_normal(POINTS)
    return np.asarray(lfilter([1.0], [1.0, -np.exp(-1 / length)], white))


def filtered(seed: int) -> FloatArray:
    """Lose waves longer than 200 to 600 samples to a Gaussian filter."""
    cutoff = np.random.default_rng([seed, 2]).uniform(200, 600)
    heights = rough(1.5, seed)
    # Gaussian filter of ISO 16610-21: half amplitude at the cut-off.
    return np.asarray(heights - gaussian_filter1d(heights, 0.187 * cutoff))


def two_slopes(seed: int) -> FloatArray:
    """Add a smooth and a jagged surface that meet at about 60 samples."""
    jagged, smooth = rough(1.85, seed), rough(1.15, seed + 10_000)
    return np.asarray(jagged + smooth * 60 ** (0.15 - 0.85))


def bent_spectrum(seed: int) -> FloatArray:
    """Turn from one D to another, 0.4 or more apart, at a lag of 20 to 60 samples."""
    rng = np.random.default_rng([seed, 5])
    low = rng.uniform(1.15, 1.45)
    ends = [low, low + rng.uniform(0.4, 0.45)]
    short, long = ends if seed % 2 else ends[::-1]
    frequency = np.fft.rfftfreq(8 * POINTS)[1:] * 2 * np.pi * rng.uniform(20, 60)
    exponents = np.where(frequency > 1, 5 - 2 * short, 5 - 2 * long)
    waves = rng.standard_normal((2, frequency.size))
    heights = frequency ** (-exponents / 2) * (waves[0] + 1j * waves[1])
    return _of_unit_steps(np.fft.irfft(np.append(0, heights))[:POINTS])


def _of_unit_steps(heights: FloatArray) -> FloatArray:
    """Return heights scaled so that neighbours differ by one on average."""
    return np.asarray(heights / np.std(np.diff(heights)))


def noise(seed: int) -> FloatArray:
    """Draw white noise."""
    return np.random.default_rng([seed, 3]).standard_normal(POINTS)


def form(seed: int) -> FloatArray:
    """Bend smoothly, with noise at a ten-thousandth of the bend."""
    rng = np.random.default_rng([seed, 4])
    x = np.linspace(-1, 1, POINTS)
    shape = np.polyval(rng.standard_normal(5), x) + np.sin(rng.uniform(2, 9) * x)
    return np.asarray(shape + 1e-4 * rng.standard_normal(POINTS))


KINDS: dict[str, tuple[Callable[[int], FloatArray], str]] = {
    "saturating": (saturating, "not over the whole range"),
    "filtered": (filtered, "not over the whole range"),
    "two slopes": (two_slopes, "not over the whole range"),
    "bent spectrum": (bent_spectrum, "not over the whole range"),
    "white noise": (noise, "never fractal"),
    "smooth form": (form, "never fractal"),
}


def main() -> None:
    """Fit and count."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=20)
    asked = parser.parse_args()
    print("| surface | right | verdicts | right in |\n|---|---|---|---|")
    for name, (make, right) in KINDS.items():
        found: Counter[str] = Counter()
        for seed in range(asked.seeds):
            heights = 1e-8 * make(seed)
            profile = Profile(name, heights, SPACING, all_valid(heights))
            found[fit_fractal(structure_function(profile)).verdict.value] += 1
        wrong = found[FULL]
        if right == "never fractal":
            wrong += found["fractal within a band"]
        words = ", ".join(f"{word} {count}" for word, count in found.items())
        share = 100 * (asked.seeds - wrong) / asked.seeds
        print(f"| {name} | {right} | {words} | {share:.0f} % |", flush=True)


if __name__ == "__main__":
    main()
