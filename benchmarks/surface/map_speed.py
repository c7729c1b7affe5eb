# SPDX-License-Identifier: MIT
"""Time and memory of the fits of maps, over the time of their structure function.

python -m benchmarks.surface.map_speed prints a table: the least processor time of a few
runs of S, of the band-limited fit over both wavenumbers and of the fit of D by S. Maps
are drawn by circulant embedding. With --large it fits one of 4096 x 4096 points alone
and prints the peak of the memory.
"""

import argparse
import resource
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from jointbench.acquisition.records.surfaces import Areal, all_valid
from jointbench.signal.band_limited.band_limited_fit import fit_band_limited
from jointbench.signal.fractal.fractal_fit import fit_fractal
from jointbench.signal.surface.structure_function import structure_function

# Generators and second methods that the tests use as well.
sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "judges"))

from lay_surfaces import Embedded

SIDES, LARGE, REPEATS, PITCH, HEIGHT = (256, 512, 1024), 4096, 5, 1e-6, 1e-6
# Roll-off along and across as shares of the side, H, blur [samples] and noise [-].
KINDS = {
    "isotropic": (0.12, 0.12, 0.7, 0.0, 0.0),
    "with a lay": (0.16, 0.06, 0.6, 0.0, 0.0),
    "with a lay, blurred, noisy": (0.16, 0.06, 0.7, 1.2, 0.002),
    "blurred, noisy": (0.12, 0.12, 0.7, 1.2, 0.002),
    "too short to decide": (1.0, 1.0, 0.7, 0.0, 0.0),
}


def drawn(kind: str, side: int, seed: int) -> Areal:
    """Return a map of a kind."""
    along, across, hurst, blur, noise = KINDS[kind]
    rng = np.random.default_rng(seed)
    maker = Embedded(
        (side, side),
        hurst=hurst,
        along=along * side,
        across=across * side,
        angle=0.5,
        blur=blur,
    )
    heights, _ = maker.draw(rng)
    heights = heights + noise * rng.standard_normal(heights.shape)
    heights = HEIGHT * np.ascontiguousarray(heights)
    return Areal(kind, heights, (PITCH, PITCH), all_valid(heights))


def least(*actions: Callable[[], object]) -> list[float]:
    """Return the least processor time of each action, taken in turns [s]."""
    times = np.full((REPEATS, len(actions)), np.inf)
    for turn in times:
        for k, action in enumerate(actions):
            started = time.process_time()
            action()
            turn[k] = time.process_time() - started
    return [float(one) for one in times.min(axis=0)]


def compare(seed: int, sides: list[int]) -> None:
    """Print times of S and of both fits for each kind and side."""
    print("| map | side | S [s] | band-limited fit [s] | over S | D by S | over S |")
    print("|---|---|---|---|---|---|---|")
    for side in sides:
        for kind in KINDS:
            areal = drawn(kind, side, seed)
            estimate = structure_function(areal)
            own, band, line = least(
                lambda areal=areal: structure_function(areal),
                lambda areal=areal: fit_band_limited([areal]),
                lambda estimate=estimate: fit_fractal(estimate),
            )
            print(
                f"| {kind} | {side} | {own:.4f} | {band:.3f} | {band / own:.1f} | "
                f"{line:.3f} | {line / own:.1f} |",
                flush=True,
            )


def large(seed: int) -> None:
    """Print time and memory of one large map."""
    heights = np.random.default_rng(seed).standard_normal((LARGE, LARGE))
    # Sums of neighbours along both sides: rough, and no copies beyond the heights.
    for axis in (0, 1):
        np.cumsum(heights, axis=axis, out=heights)
    areal = Areal("large", HEIGHT * heights, (PITCH, PITCH), all_valid(heights))
    del heights
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    times = []
    for action in (structure_function, lambda one: fit_band_limited([one])):
        started = time.process_time()
        action(areal)
        times.append(time.process_time() - started)
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        print(f"peak {peak / 2**20:.2f} GiB, {before / 2**20:.2f} GiB before the fits")
    print(
        f"S {times[0]:.2f} s, band-limited fit {times[1]:.2f} s, over S "
        f"{times[1] / times[0]:.2f}"
    )


def main() -> None:
    """Print the table, or the large map."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--large", action="store_true")
    parser.add_argument("--sides", type=int, nargs="+", default=list(SIDES))
    asked = parser.parse_args()
    if asked.large:
        large(asked.seed)
    else:
        compare(asked.seed, asked.sides)


if __name__ == "__main__":
    main()
