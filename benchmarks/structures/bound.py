# SPDX-License-Identifier: MIT
"""Reduced against full at random joints of the whole box, and the bound beside.

python benchmarks/structures/bound.py [--points 200] [--cells 4 3 1]
"""

import argparse
import time

import numpy as np
from cases import two_plates

from jointbench.analysis.structures.reduction.full_modes import solve_full
from jointbench.analysis.structures.reduction.reduce import reduce_structure
from jointbench.analysis.structures.reduction.reduced_model import frequency_bound

MODES = 18
ROUNDING = 1e-8


def main() -> None:
    """Compare at random points and print the largest error and bound."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--points", type=int, default=200)
    parser.add_argument("--cells", type=int, nargs=3, default=(4, 3, 1))
    options = parser.parse_args()
    structure = two_plates(options.cells)
    begin = time.process_time()
    model = reduce_structure(structure, modes=MODES)
    print(
        f"{structure.size} degrees of freedom to {model.size}: "
        f"{time.process_time() - begin:.1f} CPU s"
    )
    random = np.random.default_rng(11)
    errors, bounds, broken = [], [], 0
    for _ in range(options.points):
        stiffness = 10.0 ** random.uniform(6, 11, 3)
        reduced, bound = frequency_bound(model, stiffness)
        full = solve_full(structure, stiffness, MODES).natural_frequency
        elastic = full > 0
        error = np.abs(reduced - full)[elastic] / full[elastic]
        allowed = bound[elastic] / full[elastic]
        broken += bool(np.any(error > allowed + ROUNDING))
        errors.append(error.max())
        bounds.append(allowed.max())
    print(
        f"{options.points} random points of 1e6 to 1e11 N/m, {MODES} modes: largest "
        f"frequency error {max(errors):.2g}, largest bound {max(bounds):.2g}, bound "
        f"broken at {broken} points"
    )


if __name__ == "__main__":
    main()
