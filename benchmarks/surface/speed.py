# SPDX-License-Identifier: MIT
"""Time and memory of the structure function beside SurfaceTopography, in one run.

python benchmarks/surface/speed.py prints a table for docs/surface.md.
"""

import resource
import time

import numpy as np
from SurfaceTopography import UniformLineScan

from jointbench.acquisition.surfaces import Areal, Profile, all_valid
from jointbench.signal.structure_function import structure_function
from jointbench.simulators.brownian import brownian_lines

POINTS, REPEATS, SIDE = 1_000_000, 3, 4096


def best(action: object) -> float:
    """Return the least processor time of a few runs [s]."""
    times = []
    for _ in range(REPEATS):
        started = time.process_time()
        action()  # type: ignore[operator]
        times.append(time.process_time() - started)
    return min(times)


def main() -> None:
    """Time both routes at the same lags, then one large map."""
    heights = brownian_lines(1, POINTS, 0.5, np.random.default_rng(1))[0] * 1e-9
    profile = Profile("p", heights, 1e-7, all_valid(heights))
    scan = UniformLineScan(heights, POINTS * 1e-7)
    ours = structure_function(profile, remove="mean")
    lags = np.rint(ours.lag / 1e-7).astype(int)

    def their_route() -> np.ndarray:
        _, correlation = scan.autocorrelation_from_profile(
            reliable=False, resampling_method=None
        )
        return np.asarray(correlation)[lags]

    apart = np.max(np.abs(2 * their_route() / ours.value - 1))
    direct = best(lambda: structure_function(profile, lags=lags.tolist()))
    theirs = best(their_route)
    print("| what | processor time | |\n|---|---|---|")
    print(f"| jointbench, {lags.size} lags of 1e6 points | {direct:.2f} s | |")
    print(
        f"| SurfaceTopography, same lags | {theirs:.2f} s | "
        f"{theirs / direct:.1f} times, largest relative difference {apart:.1e} |"
    )
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    square = np.random.default_rng(2).standard_normal((SIDE, SIDE))
    areal = Areal("m", square, (1e-7, 1e-7), all_valid(square))
    started = time.process_time()
    structure_function(areal)
    spent = time.process_time() - started
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    print(
        f"| map of {SIDE} x {SIDE} | {spent:.1f} s | peak {peak / 2**20:.2f} GiB, "
        f"{(peak - before) / 2**20:.2f} GiB of it for the map |"
    )


if __name__ == "__main__":
    main()
