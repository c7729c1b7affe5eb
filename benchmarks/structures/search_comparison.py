# SPDX-License-Identifier: MIT
"""Compare a genetic algorithm on full solves with the station's search, same data.

python benchmarks/structures/search_comparison.py [--cells 16 10 2] [--members 50]
    [--generations 10]
"""

import argparse
import resource
import sys
import time
from pathlib import Path

import numpy as np
from cases import TRUTH, two_plates

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.lumped.measured_modes import MeasuredModes
from jointbench.analysis.structures.identification.multistart import find_optima
from jointbench.analysis.structures.identification.stiffness_problem import pose_problem
from jointbench.analysis.structures.identification.structure_evidence import (
    StructureEvidence,
)
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.full_modes import solve_full
from jointbench.analysis.structures.reduction.reduce import reduce_structure
from jointbench.analysis.structures.reduction.reduced_model import solve_reduced

# Generators and second methods that the tests use as well.
sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "judges"))

from genetic import (
    evolve_differentially,
    genetic_algorithm,
    squared_frequency_errors,
)

RIGID, ELASTIC = 6, 6
LOW, HIGH = np.full(3, np.log(1e6)), np.full(3, np.log(1e11))


def cpu() -> float:
    """Return CPU seconds of this process."""
    return time.process_time()


def main() -> None:
    """Run both and print what each cost and found."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--cells", type=int, nargs=3, default=(16, 10, 2))
    parser.add_argument("--members", type=int, default=50)
    parser.add_argument("--generations", type=int, default=10)
    options = parser.parse_args()
    structure = two_plates(options.cells)
    count = RIGID + ELASTIC
    target = solve_full(structure, TRUTH.stiffness, count).natural_frequency[RIGID:]
    print(f"{structure.size} degrees of freedom, {ELASTIC} frequencies as data")
    ours = search_station(structure, target)
    objective = squared_frequency_errors(
        lambda logs: solve_full(structure, np.exp(logs), count).natural_frequency[
            RIGID:
        ],
        target,
    )
    begin = cpu()
    full = genetic_algorithm(
        objective,
        LOW,
        HIGH,
        population=options.members,
        generations=options.generations,
    )
    spent = cpu() - begin
    print(
        f"genetic algorithm on full solves: {full.evaluations} evaluations, "
        f"{spent:.1f} CPU s, objective {full.fitness:.3g} Hz^2, largest error in ln k "
        f"{worst_log(full.best):.2g}"
    )
    print("best a generation:", np.round(full.best_of_generation, 3).tolist())
    print("mean a generation:", np.round(full.mean_of_generation, 1).tolist())
    print(
        f"ratio: {spent / ours[1]:.0f}x online, {spent / sum(ours):.1f}x with the "
        "offline part"
    )
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    print(f"peak memory {peak:.2f} GB")


def worst_log(logs: FloatArray) -> float:
    """Return the largest error of ln stiffness."""
    return float(np.abs(logs - np.log(TRUTH.stiffness)).max())


def search_station(structure: Structure, target: FloatArray) -> tuple[float, float]:
    """Reduce, search by least squares and two populations; return CPU seconds."""
    begin = cpu()
    model = reduce_structure(structure, modes=RIGID + ELASTIC)
    offline = cpu() - begin
    print(f"reduction to {model.size}: {offline:.2f} CPU s")
    measured = MeasuredModes(natural_frequency=target, frequency_sd=0.002 * target)
    rows = np.zeros((0, model.size))
    evidence = StructureEvidence("data", measured, None, rows, rows)
    begin = cpu()
    optimum = find_optima(pose_problem(model, [evidence]), starts=8, seed=0)[0]
    online = cpu() - begin

    def predict(logs: FloatArray) -> FloatArray:
        return solve_reduced(model, np.exp(logs)).natural_frequency[RIGID:]

    objective = squared_frequency_errors(predict, target)
    print(
        f"least squares, 8 starts: {online:.3f} CPU s, objective "
        f"{objective(optimum.unknowns):.3g} Hz^2, largest error in ln k "
        f"{worst_log(optimum.unknowns):.2g}"
    )
    for name, search in (
        ("genetic algorithm", genetic_algorithm),
        ("differential evolution", evolve_differentially),
    ):
        begin = cpu()
        found = search(objective, LOW, HIGH, population=50, generations=10)
        print(
            f"{name} on the reduced model: {found.evaluations} evaluations, "
            f"{cpu() - begin:.2f} CPU s, objective {found.fitness:.3g} Hz^2, largest "
            f"error in ln k {worst_log(found.best):.2g}"
        )
    return offline, online


if __name__ == "__main__":
    main()
