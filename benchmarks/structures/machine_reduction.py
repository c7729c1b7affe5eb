# SPDX-License-Identifier: MIT
"""Seven bodies and six joints reduced by interfaces, against full solves.

OMP_NUM_THREADS=1 python benchmarks/structures/machine_reduction.py --scale 1
    [--points 200] [--lines 6] [--seed 11] [--cache DIR] [--append FILE]

Prints one JSON object: sizes, CPU seconds, memory, errors and bounds.
"""

import argparse
import json
import resource
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from grinder import JOINTS, TOOL, grinder, printed_values
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

from jointbench.analysis.structures.matrices.structure import Structure, pick
from jointbench.analysis.structures.reduction.assembled import Assembled
from jointbench.analysis.structures.reduction.full_modes import solve_full
from jointbench.analysis.structures.reduction.predict_modes import JointValues
from jointbench.analysis.structures.reduction.reduce import reduce_machine
from jointbench.analysis.structures.reduction.structure_bodies import LOADS

BAND = 1800.0
MODES = 20
BOX = (1e5, 1e11)
ROUNDING = 1e-7
PARAMETERS = 3 * len(JOINTS)
PLAUSIBLE = JointValues(
    np.tile([5e9, 2e9, 2e9], len(JOINTS)), np.tile([3e3, 1e3, 1e3], len(JOINTS))
)


def timed(action: Callable[[], Any]) -> tuple[Any, float]:
    """Return a result and its CPU seconds."""
    begin = time.process_time()
    found = action()
    return found, time.process_time() - begin


def memory() -> float:
    """Return the largest memory so far [GB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


def points_of(seed: int, count: int) -> list[np.ndarray]:
    """Return printed values, then random points of the box."""
    random = np.random.default_rng(seed)
    low, high = np.log10(BOX)
    return [printed_values()] + [
        10.0 ** random.uniform(low, high, PARAMETERS) for _ in range(count - 1)
    ]


def against_full(
    structure: Structure, whole: Assembled, points: list[np.ndarray]
) -> dict[str, Any]:
    """Compare frequencies at points of the box with full solves."""
    errors, bounds, seconds, broken, lowest = [], [], [], 0, []
    for point in points:
        values = JointValues(point, np.zeros(PARAMETERS))
        (found, _), spent = timed(lambda v=values: whole.modes(v, MODES))
        bound = whole.bound(values, MODES) / found
        full = solve_full(structure, point, MODES).natural_frequency
        error = found / full - 1.0
        broken += int(np.any(error > bound + ROUNDING))
        errors.append(float(np.abs(error).max()))
        bounds.append(float(bound.max()))
        seconds.append(spent)
        lowest.append(float(full[0]))
    return {
        "points": len(points),
        "largest_error": max(errors),
        "points_above_1e-4": sum(one > 1e-4 for one in errors),
        "errors": sorted(errors)[-5:],
        "median_bound": float(np.median(bounds)),
        "largest_bound": max(bounds),
        "bound_broken": broken,
        "modes_ms_median": 1e3 * float(np.median(seconds)),
        "modes_ms_largest": 1e3 * max(seconds),
        "lowest_hz": min(lowest),
    }


def receptance_check(
    structure: Structure, whole: Assembled, load: np.ndarray, lines: int
) -> dict[str, Any]:
    """Compare the tool's receptance at some of 2,000 lines with the full mesh."""
    frequency = np.linspace(1.0, 600.0, 2000)
    rows = whole.rows((TOOL[0], LOADS))
    whole.frf(PLAUSIBLE, frequency, rows, rows)
    found, spent = timed(lambda: whole.frf(PLAUSIBLE, frequency, rows, rows))
    stiffness = structure.with_joints(PLAUSIBLE.stiffness) + 1j * structure.loss
    damper = sum(
        c * g for c, g in zip(PLAUSIBLE.damping, structure.spread, strict=True)
    )
    worst, at = 0.0, np.linspace(20, 1990, lines).astype(int)
    axes = np.arange(3)
    for line in at:
        s = 2j * np.pi * frequency[line]
        matrix = csc_array(stiffness + s * damper + s**2 * structure.mass)
        exact = np.diag(load @ splu(matrix).solve(load.T + 0j))
        near = np.abs(found[axes, axes, max(0, line - 100) : line + 100])
        away = np.abs(exact) > 0.1 * np.median(near, axis=1)
        error = np.abs(found[axes, axes, line] / exact - 1.0)[away]
        worst = max(worst, float(error.max(initial=0.0)))
    return {"lines_checked": lines, "largest_error": worst, "ms": 1e3 * spent}


def main() -> None:
    """Reduce, compare, print."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--scale", type=float, default=1.0)
    parser.add_argument("--points", type=int, default=10)
    parser.add_argument("--lines", type=int, default=6)
    parser.add_argument("--seed", type=int, default=11)
    parser.add_argument("--cache", type=Path)
    parser.add_argument("--append", type=Path)
    options = parser.parse_args()
    structure, build = timed(lambda: grinder(options.scale))
    load = pick(structure, *TOOL).toarray()
    report: dict[str, Any] = {
        "freedoms": structure.size,
        "assembly_s": build,
        "assembly_gb": memory(),
    }
    whole, spent = timed(
        lambda: reduce_machine(
            structure, BAND, box=BOX, modes=MODES, loads=load, cache=options.cache
        )
    )
    report |= {
        "reduction_s": spent,
        "reduction_gb": memory(),
        "coordinates": whole.model.size,
        "bodies": {body.name: body.size for body in whole.components},
    }
    print(json.dumps(report), file=sys.stderr, flush=True)
    if options.points:
        points = points_of(options.seed, options.points)
        report["modes"] = against_full(structure, whole, points)
    if options.lines:
        report["receptance"] = receptance_check(structure, whole, load, options.lines)
    print(json.dumps(report, indent=1))
    if options.append is not None:
        with options.append.open("a", encoding="utf-8") as file:
            file.write(json.dumps(report) + "\n")


if __name__ == "__main__":
    main()
