# SPDX-License-Identifier: MIT
"""Six joint parameters from noisy FRFs of the whole mesh, many draws.

The FRFs come from the full matrices, line by line, with the sensors' masses on them:
nothing of the reduced model is in the data.

python benchmarks/structures/coverage.py [--draws 200] [--seed 1] [--cells 4 3 1]
    [--lines 61]
"""

import argparse
import time

import numpy as np
from cases import SENSOR_MASS, SENSORS, TRUTH, two_plates
from scipy import sparse
from scipy.sparse.linalg import splu

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.analysis.structures.identification.multistart import find_optima
from jointbench.analysis.structures.identification.stiffness_descent import descend
from jointbench.analysis.structures.identification.stiffness_problem import (
    pose_problem,
    residuals,
)
from jointbench.analysis.structures.identification.structure_evidence import (
    StructureEvidence,
)
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.mounted_sensors import (
    readout,
    sensor_rows,
)
from jointbench.analysis.structures.reduction.reduce import reduce_structure
from jointbench.signal.frf.frf import Frf, FrfKind

NOISE = 0.01
HITS = (0, 5)
# Well beyond the band, so that FRFs within it are right to far below their noise.
MODES = 30
BAND = (200.0, 2600.0)


def full_accelerance(
    structure: Structure, rows: FloatArray, frequency: FloatArray
) -> ComplexArray:
    """Solve the damped full mesh line by line, shape (n_outputs, n_inputs, n_lines)."""
    stiffness = structure.with_joints(TRUTH.stiffness)
    damping = sum(
        c * spread for c, spread in zip(TRUTH.damping, structure.spread, strict=True)
    )
    answer = []
    for omega in 2 * np.pi * frequency:
        dynamic = stiffness + 1j * omega * damping - omega**2 * structure.mass
        factor = splu(sparse.csc_array(dynamic), permc_spec="MMD_AT_PLUS_A")
        motion = factor.solve(rows[list(HITS)].T.astype(complex))
        answer.append(-(omega**2) * (rows @ motion))
    return np.moveaxis(np.array(answer), 0, 2)


def main() -> None:
    """Draw noise, identify, count how often the truth lies within two sigma."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--draws", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--cells", type=int, nargs=3, default=(4, 3, 1))
    parser.add_argument("--lines", type=int, default=61)
    options = parser.parse_args()
    frequency = np.linspace(*BAND, options.lines)
    structure = two_plates(options.cells, sensor_mass=SENSOR_MASS)
    rows = sensor_rows(structure, SENSORS)
    exact = full_accelerance(structure, rows, frequency)
    model = reduce_structure(structure, modes=MODES, tolerance=1e-5, loads=rows)
    outputs = readout(structure, model, SENSORS)
    sd = NOISE * np.sqrt((np.abs(exact) ** 2).mean(axis=2, keepdims=True))
    variance = np.broadcast_to(sd**2, exact.shape)
    truth = np.log(np.concatenate([TRUTH.stiffness, TRUTH.damping]))

    def evidence(response: ComplexArray) -> StructureEvidence:
        frf = Frf(
            frequency=frequency,
            response=response,
            kind=FrfKind.ACCELERANCE,
            variance=variance,
        )
        return StructureEvidence("draw", None, frf, outputs, outputs[list(HITS)])

    clean = pose_problem(model, [evidence(exact)])
    left, slopes = residuals(clean, truth)
    fisher = np.sqrt(np.diag(np.linalg.inv(slopes.T @ slopes)))
    print(f"{structure.size} degrees of freedom, reduced to {model.size}")
    print(f"model error at the truth, rms of noise: {np.sqrt(np.mean(left**2)):.2g}")
    random = np.random.default_rng(options.seed)
    start, begin = truth, time.process_time()
    ends, spreads = [], []
    for draw in range(options.draws):
        noise = random.standard_normal((2, *exact.shape)) / np.sqrt(2)
        problem = pose_problem(
            model, [evidence(exact + sd * (noise[0] + 1j * noise[1]))]
        )
        if draw == 0:
            best = find_optima(problem, starts=4, seed=0)[0]
            start = best.unknowns
        else:
            best = descend(problem, start)
        scale = max(1.0, best.chi2 / (best.slopes.shape[0] - problem.size))
        ends.append(best.unknowns - truth)
        spreads.append(np.sqrt(scale * np.diag(best.covariance())))
    report(np.array(ends), np.array(spreads), fisher, clean.names)
    print(f"{options.draws} draws, {time.process_time() - begin:.0f} CPU s")


def report(
    ends: FloatArray, spreads: FloatArray, fisher: FloatArray, names: tuple[str, ...]
) -> None:
    """Print coverage and standard deviations."""
    inside = np.abs(ends) <= 2 * spreads
    for at, name in enumerate(names):
        print(
            f"{name:32s} coverage {100 * inside[:, at].mean():5.1f} %  median sd "
            f"{100 * np.median(spreads[:, at]):.4f} %  Fisher {100 * fisher[at]:.4f} %"
            f"  scatter {100 * ends[:, at].std():.4f} %  bias "
            f"{100 * ends[:, at].mean():+.4f} %"
        )
    ratio = np.median(spreads, axis=0) / fisher
    print(
        f"all six: coverage {100 * inside.mean():.1f} %, median sd over Fisher bound "
        f"{ratio.min():.3f} to {ratio.max():.3f}"
    )


if __name__ == "__main__":
    main()
