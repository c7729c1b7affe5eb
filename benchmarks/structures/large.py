# SPDX-License-Identifier: MIT
"""Ten elastic modes of a free plate of 200,000 degrees of freedom, solver by solver.

Each solver runs in a process of its own, so that its CPU time and its largest memory
are its own. CalculiX (`ccx`) is run on the same mesh where it is installed.

OMP_NUM_THREADS=1 python benchmarks/structures/large.py [--cells 56 34 8] [--page FILE]
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from cases import MARBLE, PLATE

from jointbench.analysis.structures.matrices.element_assembly import assemble
from jointbench.analysis.structures.meshes.mesh import Mesh, box_mesh
from jointbench.analysis.structures.reduction.full_modes import lowest_modes
from jointbench.analysis.structures.reduction.sparse_factor import Solver

RIGID, ELASTIC = 6, 10
CALCULIX = "calculix"
ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1"
)
INTRODUCTION = """# Two hundred thousand degrees of freedom

Made by `benchmarks/structures/large.py`: a free marble plate of 500 x 300 x 50 mm,
{cells} hex20 elements, {size} degrees of freedom; ten elastic modes (and six rigid
ones). One thread of a two-core machine, every solver in a process of its own; time is
CPU seconds of the whole process, assembly or reading included, memory its largest.

| solver | CPU s | memory [GB] | largest difference from the first, relative |
|---|---|---|---|
"""


def solve(cells: Sequence[int], solver: str) -> list[float]:
    """Return the elastic frequencies [Hz] with a solver of the station."""
    stiffness, mass = assemble(box_mesh(PLATE, cells), MARBLE)
    found = lowest_modes(stiffness, mass, RIGID + ELASTIC, Solver(solver))
    frequencies: list[float] = found.natural_frequency[RIGID:].tolist()
    return frequencies


def write_deck(mesh: Mesh, path: Path) -> None:
    """Write the plate as an input deck of CalculiX."""
    lines = ["*NODE, NSET=ALL"]
    lines += [
        f"{at + 1}, {x:.12g}, {y:.12g}, {z:.12g}"
        for at, (x, y, z) in enumerate(mesh.nodes)
    ]
    lines.append("*ELEMENT, TYPE=C3D20, ELSET=PLATE")
    for at, cell in enumerate(mesh.cells + 1):
        words = [str(at + 1), *map(str, cell)]
        # A line holds sixteen numbers at the most.
        lines += [", ".join(words[:11]) + ",", ", ".join(words[11:])]
    lines += [
        "*MATERIAL, NAME=MARBLE",
        "*ELASTIC",
        f"{MARBLE.youngs_modulus:g}, {MARBLE.poisson_ratio:g}",
        "*DENSITY",
        f"{MARBLE.density:g}",
        "*SOLID SECTION, ELSET=PLATE, MATERIAL=MARBLE",
        "*STEP",
        "*FREQUENCY",
        f"{RIGID + ELASTIC}",
        "*END STEP",
    ]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")


def read_frequencies(path: Path) -> list[float]:
    """Return the elastic frequencies [Hz] of a result file of CalculiX."""
    found = []
    for line in path.read_text(encoding="ascii").splitlines():
        words = line.split()
        if len(words) == 5 and words[0].isdigit():
            found.append(float(words[3]))
        if len(found) == RIGID + ELASTIC:
            break
    return found[RIGID:]


def measured(command: list[str], folder: Path) -> tuple[float, float]:
    """Run a command and return its CPU seconds and its largest memory [GB]."""
    environment = os.environ | ONE_THREAD
    with (folder / "log").open("wb") as log:
        child = subprocess.Popen(
            command, cwd=folder, env=environment, stdout=log, stderr=log
        )
        _, status, usage = os.wait4(child.pid, 0)
    if status:
        raise SystemExit((folder / "log").read_text(encoding="utf-8")[-2000:])
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1e6


def run(cells: Sequence[int], solver: str) -> tuple[list[float], float, float]:
    """Return frequencies, CPU seconds and memory of one solver."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if solver == CALCULIX:
            write_deck(box_mesh(PLATE, cells), folder / "plate.inp")
            cost = measured(["ccx", "plate"], folder)
            return read_frequencies(folder / "plate.dat"), *cost
        script = str(Path(__file__).resolve())
        words = [sys.executable, script, "--one", solver, "--cells", *map(str, cells)]
        cost = measured(words, folder)
        found = json.loads((folder / "log").read_text(encoding="utf-8").split("\n")[0])
        return found, *cost


def main() -> None:
    """Run every installed solver and tabulate the results."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--cells", type=int, nargs=3, default=(56, 34, 8))
    parser.add_argument("--one", choices=[str(s) for s in Solver])
    parser.add_argument("--solvers", nargs="*", default=["pardiso", CALCULIX])
    parser.add_argument("--page", type=Path)
    options = parser.parse_args()
    if options.one:
        print(json.dumps(solve(options.cells, options.one)))
        return
    size = 3 * box_mesh(PLATE, options.cells).nodes.shape[0]
    shape = " x ".join(map(str, options.cells))
    page = INTRODUCTION.format(cells=shape, size=f"{size:,}")
    first: list[float] = []
    for solver in options.solvers:
        if solver == CALCULIX and shutil.which("ccx") is None:
            page += f"| {solver} | not installed | | |\n"
            continue
        found, seconds, memory = run(options.cells, solver)
        first = first or found
        apart = np.abs(np.array(found) / np.array(first) - 1).max()
        page += f"| {solver} | {seconds:.0f} | {memory:.1f} | {apart:.1e} |\n"
        print(page, flush=True)
    page += "\nFrequencies of the first [Hz]: "
    page += ", ".join(f"{value:.4f}" for value in first) + ".\n"
    print(page)
    if options.page is not None:
        options.page.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
