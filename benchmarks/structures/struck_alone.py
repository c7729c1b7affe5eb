# SPDX-License-Identifier: MIT
"""A beam on a block from the separate simulated hits of each, over many seeds.

Each seed draws the sizes of both bodies, the stiffness between them and the noise of
the hits; the truth is the eigenvalues of both meshes joined.

python benchmarks/structures/struck_alone.py [--count 20] [--seed 0]
    [--append /tmp/struck.jsonl] [--page docs/machine-measured-bodies.md]

Seeds that are in the file are not computed again.
"""

import argparse
import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import scipy.linalg
from scipy.stats import binomtest

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.structures.matrices.element_assembly import Material
from jointbench.analysis.structures.matrices.parts import MeshedBody, solid_body
from jointbench.analysis.structures.matrices.structure import build_structure, pick
from jointbench.analysis.structures.measured.coupled_measurements import coupled_modes
from jointbench.analysis.structures.measured.frf_coupling import FrfLink
from jointbench.analysis.structures.meshes.mesh import box_mesh
from tests.judges.struck_bodies import Hammering, dense_modes, struck

BAND = (60.0, 1190.0)
MODES, DRAWS, WIDE, BAR = 3, 40, 1.96, 5e-3
STEEL = Material(200e9, 0.3, 7850.0)
MARBLE = Material(55e9, 0.25, 2600.0)
PAGE = """# Bodies that were struck alone, coupled

Made by `benchmarks/structures/struck_alone.py`: a free steel beam and a free marble block
are struck point by point in simulation (five hits a point, noise at {decibel:g} dB, all
dense modes of their own meshes), and joined in three points and three directions by
springs. Every seed draws the sizes of both (10 %), the springs (100 MN/m to 1 GN/m) and the
noise. The truth is the eigenvalues of both meshes with the springs. Intervals are 95 %.
Seeds {first} to {last}; none of them was used while the fit was developed (0 to 19 and 2001
to 2028 were).

| mode | seeds | largest error | median error | intervals that hold | Wilson, 95 % | median sd |
|---|---|---|---|---|---|---|
{rows}

Errors are relative; the bar is {bar} for each of the first three frequencies. Above it: {above}
of {count}. One seed takes {seconds:.1f} CPU s (median).
"""  # noqa: E501


def bodies(random: np.random.Generator) -> tuple[list[MeshedBody], list[Any]]:
    """Return beam and block, and the points of each."""
    length, width, thick = np.array([0.5, 0.12, 0.02]) * random.uniform(0.9, 1.1, 3)
    size = np.array([0.4, 0.3, 0.12]) * random.uniform(0.9, 1.1, 3)
    top = float(size[2])
    side = 0.5 * float(size[1] - width)
    low, high, middle = side + 0.02, side + float(width) - 0.02, 0.5 * float(size[1])
    feet = [(0.05, low, top), (0.05, high, top), (0.3, middle, top)]
    tip = (float(length), side, top + float(thick))
    mesh = box_mesh((length, width, thick), (7, 2, 1), origin=(0.0, side, top))
    beam = solid_body("beam", mesh, STEEL)
    block = solid_body("block", box_mesh(tuple(size.tolist()), (4, 3, 1)), MARBLE)
    return [beam, block], [(feet, tip), (feet, None)]


def one_seed(seed: int) -> dict[str, Any]:
    """Measure, couple and compare one pair of bodies."""
    begin = time.process_time()
    random = np.random.default_rng(seed)
    pair, points = bodies(random)
    spring = float(10.0 ** random.uniform(8.0, 9.0))
    rows, matrices, blocks = [], [], []
    for body, (feet, tip) in zip(pair, points, strict=True):
        whole = build_structure([body], [])
        own = [pick(whole, body.name, one).toarray() for one in feet]
        if tip is not None:
            own.append(pick(whole, body.name, tip).toarray()[2:])
        rows.append(np.concatenate(own))
        matrices.append((body.stiffness.toarray(), body.mass.toarray()))
        modes = dense_modes(*matrices[-1])
        blocks.append(struck(body.name, modes, rows[-1], Hammering(), random))
    truth = joined(matrices, rows, spring)

    links = [FrfLink(("beam", at), ("block", at), spring) for at in range(9)]
    modes = coupled_modes(blocks, links, BAND, draws=DRAWS)
    found = np.concatenate([modes.frequency, np.full(MODES, np.nan)])[:MODES]
    sd = np.concatenate([modes.frequency_sd, np.full(MODES, np.nan)])[:MODES]
    return {
        "seed": seed,
        "spring": spring,
        "truth": truth.tolist(),
        "found": found.tolist(),
        "sd": sd.tolist(),
        "modes": modes.frequency.tolist(),
        "remarks": list(modes.remarks),
        "seconds": time.process_time() - begin,
    }


def joined(matrices: list[Any], rows: list[FloatArray], spring: float) -> FloatArray:
    """Return the first elastic frequencies of both meshes with the springs [Hz]."""
    stiffness, mass = (
        scipy.linalg.block_diag(*(one[k] for one in matrices)) for k in (0, 1)
    )
    tie = np.concatenate([rows[0][:9], -rows[1]], axis=1)
    value = scipy.linalg.eigh(
        stiffness + spring * tie.T @ tie,
        mass,
        eigvals_only=True,
        subset_by_index=(6, 5 + MODES),
    )
    return np.asarray(np.sqrt(value) / (2.0 * np.pi))


def wilson(held: int, count: int) -> tuple[float, float]:
    """Return the 95 % interval of a share."""
    low, high = binomtest(held, count).proportion_ci(method="wilson")
    return float(low), float(high)


def page(done: list[dict[str, Any]]) -> str:
    """Return the page."""
    truth, found, sd = (
        np.array([one[k] for one in done]) for k in ("truth", "found", "sd")
    )
    error = np.abs(found / truth - 1.0)
    held = np.abs(found - truth) <= WIDE * sd
    cells = [(f"{at + 1}", np.s_[:, at]) for at in range(MODES)] + [("all", np.s_[:])]
    lines = []
    for name, own in cells:
        inside = held[own]
        low, high = wilson(int(inside.sum()), inside.size)
        lines.append(
            f"| {name} | {len(done)} | {100 * error[own].max():.3f} % | "
            f"{100 * np.median(error[own]):.3f} % | {inside.sum()} of {inside.size} | "
            f"{100 * low:.0f} to {100 * high:.0f} % | "
            f"{100 * np.median((sd / truth)[own]):.3f} % |"
        )
    return PAGE.format(
        rows="\n".join(lines),
        first=done[0]["seed"],
        last=done[-1]["seed"],
        decibel=Hammering().decibel,
        bar="0.5 %",
        above=int((error > BAR).sum()),
        count=error.size,
        seconds=float(np.median([one["seconds"] for one in done])),
    )


def main() -> None:
    """Run the seeds that are missing, and print or write the page."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--append", type=Path)
    parser.add_argument("--page", type=Path)
    options = parser.parse_args()
    done: dict[int, dict[str, Any]] = {}
    if options.append is not None and options.append.is_file():
        for line in options.append.read_text(encoding="utf-8").splitlines():
            done[json.loads(line)["seed"]] = json.loads(line)
    wanted = range(options.seed, options.seed + options.count)
    for seed in wanted:
        if seed in done:
            continue
        done[seed] = one_seed(seed)
        if options.append is not None:
            with options.append.open("a", encoding="utf-8") as file:
                file.write(json.dumps(done[seed]) + "\n")
    text = page([done[seed] for seed in wanted])
    print(text)
    if options.page is not None:
        options.page.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
