# SPDX-License-Identifier: MIT
"""D and G of Weierstrass-Mandelbrot profiles by the band-limited form.

python -m benchmarks.surface.weierstrass --profiles 100 prints a table.
"""

import argparse
import sys
from pathlib import Path

import numpy as np

from jointbench.signal.fractal.weierstrass_fit import fit_weierstrass
from jointbench.signal.surface.structure_function import structure_function

# Generators and second methods that the tests use as well.
sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "judges"))

from weierstrass_surfaces import weierstrass_profile

POINTS, LENGTH, ROUGHNESS = 8192, 2e-3, 1e-10  # [-], [m], [m]
DIMENSIONS = (1.2, 1.3, 1.4, 1.54, 1.7, 1.85)


def line(dimension: float, profiles: int) -> str:
    """Return one line of the table."""
    found = [
        fit_weierstrass(
            structure_function(
                weierstrass_profile(
                    POINTS,
                    spacing=LENGTH / POINTS,
                    dimension=dimension,
                    roughness=ROUGHNESS,
                    seed=seed,
                ),
                remove="mean",
            )
        )
        for seed in range(profiles)
    ]
    values = np.array([one.dimension for one in found])
    stated = np.array([one.dimension_sd for one in found])
    held = [
        one.roughness_interval[0] < ROUGHNESS < one.roughness_interval[1]
        for one in found
    ]
    ratio = np.median([one.roughness for one in found]) / ROUGHNESS
    cells = (
        f"{dimension}",
        f"{profiles}",
        f"{values.mean() - dimension:+.4f}",
        f"{values.std(ddof=1):.4f}",
        f"{stated.mean():.4f}",
        f"{100 * np.mean(np.abs(values - dimension) < 2 * stated):.0f} %",
        f"{ratio:.3f}",
        f"{100 * np.mean(held):.0f} %",
    )
    return "| " + " | ".join(cells) + " |"


def main() -> None:
    """Fit and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--profiles", type=int, default=100)
    asked = parser.parse_args()
    print(
        "| D | profiles | bias of D | sd | stated sd | 2-sigma coverage of D | "
        "median G over the truth | 95 % interval of G covers |\n" + "|---" * 8 + "|"
    )
    for dimension in DIMENSIONS:
        print(line(dimension, asked.profiles), flush=True)


if __name__ == "__main__":
    main()
