# SPDX-License-Identifier: MIT
"""Time, memory and precision beside SurfaceTopography and FracDimPy, in one run.

python -m benchmarks.surface.speed prints two tables. FracDimPy is no dependency: it
takes part where it is installed (pip install --no-deps FracDimPy).
"""

import importlib.util
import resource
import sys
import time
from pathlib import Path

import numpy as np
from SurfaceTopography import UniformLineScan

from jointbench.acquisition.records.surfaces import Areal, Profile, all_valid
from jointbench.signal.fractal.fractal_fit import fit_fractal
from jointbench.signal.surface.structure_function import structure_function
from jointbench.signal.surface.structure_map import structure_map
from jointbench.simulators.rough_surfaces.brownian import brownian_lines
from jointbench.simulators.rough_surfaces.rough_surface import rough_profile

# Generators and second methods that the tests use as well.
sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "judges"))

from papers_recipe import fit_papers_recipe

POINTS, REPEATS, SIDE = 1_000_000, 3, 4096
FITTED, PROFILES = 20_000, 30


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
    started = time.process_time()
    found = structure_map(profile)
    spent = time.process_time() - started
    print(
        f"| jointbench, all {found.value.size - 1} lags to a tenth | {spent:.2f} s | |"
    )
    if importlib.util.find_spec("fracDimPy"):
        from fracDimPy import structural_function

        started = time.process_time()
        structural_function(heights[: POINTS // 10])
        spent = 10 * (time.process_time() - started)
        own = best(lambda: structure_function(profile, lags=range(2, 30)))
        print(
            f"| FracDimPy, lags 2 to 29 (ten times a tenth of the points) "
            f"| {spent:.1f} s "
            f"| jointbench at these {own:.2f} s, {spent / own:.0f} times |"
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
    accuracy()


def accuracy() -> None:
    """Print how D of exact profiles scatters by each route."""
    print("\n| D of the profiles | route | bias | sd |\n|---|---|---|---|")
    for dimension in (1.3, 1.7):
        profiles = [
            rough_profile(
                FITTED, spacing=1e-7, dimension=dimension, roughness=1e-10, seed=seed
            )
            for seed in range(PROFILES)
        ]
        routes = {
            "jointbench, fit_fractal": [
                fit_fractal(structure_function(one)).dimension for one in profiles
            ],
            "jointbench, the papers' recipe": [
                fit_papers_recipe([one]).dimension for one in profiles[:5]
            ],
        }
        if importlib.util.find_spec("fracDimPy"):
            from fracDimPy import structural_function

            routes["FracDimPy, structural_function"] = [
                structural_function(one.heights)[0] for one in profiles
            ]
        for name, values in routes.items():
            error = np.array(values, dtype=float) - dimension
            print(
                f"| {dimension} | {name}, {error.size} profiles | {error.mean():+.4f} "
                f"| {error.std(ddof=1):.4f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
