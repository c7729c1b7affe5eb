# SPDX-License-Identifier: MIT
"""Seven bodies and six joints reduced by interfaces, against full solves.

OMP_NUM_THREADS=1 python benchmarks/structures/machine_reduction.py --scale 1
    [--points 200] [--timed 0] [--lines 6] [--damped 0] [--seed 11] [--cache DIR]
    [--append FILE]

Prints one JSON object: sizes, CPU and wall seconds, memory, errors and bounds. With
--timed the modes are found at that many points without full solves, to be timed.
`machine_reduction_page.py` writes the page from a file of these.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from grinder import JOINTS, PRINTED_DAMPERS, TOOL, grinder, printed_values
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
# Of a full solve, relative to the largest receptance.
FULL_ROUNDING = 1e-9
PARAMETERS = 3 * len(JOINTS)
PLAUSIBLE = JointValues(
    np.tile([5e9, 2e9, 2e9], len(JOINTS)), np.tile([3e3, 1e3, 1e3], len(JOINTS))
)


def timed(action: Callable[[], Any]) -> tuple[Any, float]:
    """Return a result and its CPU seconds."""
    begin = time.process_time()
    found = action()
    return found, time.process_time() - begin


def repeated(action: Callable[[], Any], count: int = 9) -> dict[str, float]:
    """Return the least and the median CPU and wall time of repeats [ms]."""
    spent, passed = [], []
    action()
    for _ in range(count):
        wall, cpu = time.perf_counter(), time.process_time()
        action()
        spent.append(1e3 * (time.process_time() - cpu))
        passed.append(1e3 * (time.perf_counter() - wall))
    return {
        "cpu_least": min(spent),
        "cpu_median": float(np.median(spent)),
        "wall_least": min(passed),
        "wall_median": float(np.median(passed)),
    }


def commit() -> str:
    """Return the commit of the code, with a plus if files differ from it."""
    folder = Path(__file__).resolve().parent

    def git(*words: str) -> str:
        done = subprocess.run(
            ["git", "-C", str(folder), *words], capture_output=True, text=True
        )
        return done.stdout.strip()

    changed = git("status", "--porcelain", "--untracked-files=no")
    return git("rev-parse", "--short", "HEAD") + ("+" if changed else "")


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


def spent_on(whole: Assembled, points: list[np.ndarray]) -> list[dict[str, float]]:
    """Return the time of the modes at each point [ms], see `repeated`."""
    values = [JointValues(point, np.zeros(PARAMETERS)) for point in points]
    return [repeated(lambda v=one: whole.modes(v, MODES), 3) for one in values]


def times_of(spent: list[dict[str, float]]) -> dict[str, dict[str, float]]:
    """Return the median and the largest of the least times of points [ms]."""
    return {
        key: {
            "median": float(np.median([one[key] for one in spent])),
            "largest": max(one[key] for one in spent),
        }
        for key in ("cpu_least", "wall_least")
    }


def against_full(
    structure: Structure, whole: Assembled, points: list[np.ndarray]
) -> dict[str, Any]:
    """Compare frequencies at points of the box with full solves."""
    errors, bounds, broken, lowest = [], [], 0, []
    for point in points:
        values = JointValues(point, np.zeros(PARAMETERS))
        found, _ = whole.modes(values, MODES)
        bound = whole.bound(values, MODES) / found
        full = solve_full(structure, point, MODES).natural_frequency
        error = found / full - 1.0
        broken += int(np.any(error > bound + ROUNDING))
        errors.append(float(np.abs(error).max()))
        bounds.append(float(bound.max()))
        lowest.append(float(full[0]))
        print(f"error {errors[-1]:.1e}, {bounds[-1]:.1e}", file=sys.stderr, flush=True)
    return {
        "points": len(points),
        "largest_error": max(errors),
        "points_above_1e-4": sum(one > 1e-4 for one in errors),
        "errors": sorted(errors)[-5:],
        "median_bound": float(np.median(bounds)),
        "largest_bound": max(bounds),
        "bound_broken": broken,
        "modes_ms": times_of(spent_on(whole, points)),
        "lowest_hz": min(lowest),
    }


def damped_cases(count: int, seed: int) -> dict[str, JointValues]:
    """Return plausible, printed and random joint values with dampers."""
    random = np.random.default_rng(seed)
    dampers = [PRINTED_DAMPERS["guide" if j.name == "guide" else "bed"] for j in JOINTS]
    found = {
        "plausible": PLAUSIBLE,
        "printed": JointValues(printed_values(), np.array(dampers).ravel()),
    }
    low, high = np.log10(BOX)
    for at in range(count):
        found[f"random {at + 1}"] = JointValues(
            10.0 ** random.uniform(low, high, PARAMETERS),
            10.0 ** random.uniform(2.0, 6.0, PARAMETERS),
        )
    return found


def receptance_check(
    structure: Structure,
    whole: Assembled,
    load: np.ndarray,
    lines: int,
    values: JointValues,
) -> dict[str, Any]:
    """Compare the tool's receptance at some of 2,000 lines with the full mesh."""
    frequency = np.linspace(1.0, 600.0, 2000)
    side = (TOOL[0], LOADS)
    rows = whole.rows(side)
    found = whole.frf(values, frequency, rows, rows)
    spent = repeated(lambda: whole.frf(values, frequency, rows, rows))
    at = np.unique(np.append(np.linspace(20, 1990, lines).astype(int), 1999))
    bound = whole.frf_bound(values, frequency[at], side)
    stiffness = structure.with_joints(values.stiffness) + 1j * structure.loss
    damper = sum(c * g for c, g in zip(values.damping, structure.spread, strict=True))
    errors, bounds, broken = [], [], 0
    axes = np.arange(3)
    for number, line in enumerate(at):
        s = 2j * np.pi * frequency[line]
        matrix = csc_array(stiffness + s * damper + s**2 * structure.mass)
        exact = load @ splu(matrix).solve(load.T + 0j)
        error = np.abs(found[:, :, line] - exact)
        broken += int(np.any(error > bound[:, :, number] + FULL_ROUNDING * exact.max()))
        near = np.abs(found[axes, axes, max(0, line - 100) : line + 100])
        away = np.abs(np.diag(exact)) > 0.1 * np.median(near, axis=1)
        size = np.abs(np.diag(exact))[away]
        errors += (np.diag(error)[away] / size).tolist()
        bounds += (np.diag(bound[:, :, number])[away] / size).tolist()
    return {
        "lines_checked": at.size,
        "largest_error": max(errors),
        "bound_median": float(np.median(bounds)),
        "bound_largest": max(bounds),
        "bound_over_error_median": float(np.median(np.array(bounds) / errors)),
        "bound_broken": broken,
        "ms": spent,
    }


def main() -> None:
    """Reduce, compare, print."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--scale", type=float, default=1.0)
    parser.add_argument("--points", type=int, default=10)
    parser.add_argument("--timed", type=int, default=0)
    parser.add_argument("--lines", type=int, default=6)
    parser.add_argument("--damped", type=int, default=0)
    parser.add_argument("--seed", type=int, default=11)
    parser.add_argument("--cache", type=Path)
    parser.add_argument("--append", type=Path)
    options = parser.parse_args()
    structure, build = timed(lambda: grinder(options.scale))
    load = pick(structure, *TOOL).toarray()
    report: dict[str, Any] = {
        "commit": commit(),
        "load_average": os.getloadavg()[0],
        "seed": options.seed,
        "band_hz": BAND,
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
    if options.timed:
        points = points_of(options.seed + 1, options.timed)
        found = times_of(spent_on(whole, points))
        report["timed"] = {"points": options.timed, **found}
    print(json.dumps(report), file=sys.stderr, flush=True)
    if options.points:
        points = points_of(options.seed, options.points)
        report["modes"] = against_full(structure, whole, points)
    if options.lines:
        report["receptance"] = {
            name: receptance_check(structure, whole, load, options.lines, values)
            for name, values in damped_cases(options.damped, options.seed).items()
        }
    print(json.dumps(report, indent=1))
    if options.append is not None:
        with options.append.open("a", encoding="utf-8") as file:
            file.write(json.dumps(report) + "\n")


if __name__ == "__main__":
    main()
