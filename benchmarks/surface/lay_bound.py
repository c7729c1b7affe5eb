# SPDX-License-Identifier: MIT
"""Least standard deviation of the direction of a lay, beside what the fit states.

python -m benchmarks.surface.lay_bound --log PATH prints, for each kind of map with a
lay, the bound of Cramer and Rao with all other parameters unknown, and from a log of
`benchmarks.surface.lay` the errors of the fit and the deviation that it states. The
bound is Whittle's information of every ordinate of the map, without a taper, by
derivatives of closed covariances: nothing in it is taken from the program.
"""

import argparse
import json
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.surface.lay import CELLS, Cell
from jointbench.acquisition.basics.arrays import FloatArray

from lay_surfaces import Embedded  # isort: skip  (found by `benchmarks.surface.lay`)

ANGLE = 0.5  # [rad]
STEPS = {"hurst": 1e-3, "along": 1e-2, "across": 1e-2, "angle": 1e-3, "skew": 1e-3}


def log_spectrum(cell: Cell, angle: float) -> FloatArray:
    """Return ln of the expected spectrum at each ordinate, aliases and noise in it."""
    made = Embedded(
        (cell.side // 2, cell.side // 2),
        hurst=cell.hurst,
        along=cell.along,
        across=cell.across,
        angle=angle,
        skew=cell.skew,
        blur=cell.blur,
    )
    density = made.root**2 * made.root.size
    return np.asarray(np.log(density + max(cell.noise, 1e-6) ** 2)).ravel()


def least_deviation(cell: Cell) -> float:
    """Return the least standard deviation of the direction [deg].

    Source:
        Information of a spectrum: Whittle, Biometrika 41 (1954) 434.
    """
    rates = [np.ones(cell.side**2)]
    for name, step in STEPS.items():
        ends = []
        for sign in (1, -1):
            if name == "angle":
                ends.append(log_spectrum(cell, ANGLE + sign * step))
                continue
            value = getattr(cell, name)
            moved = replace(cell, **{name: value + sign * step * _unit(name, value)})
            ends.append(log_spectrum(moved, ANGLE))
        rates.append((ends[0] - ends[1]) / (2 * step))
    table = np.array(rates)
    spread = np.linalg.inv(0.5 * table @ table.T)
    place = 1 + list(STEPS).index("angle")
    return float(np.degrees(np.sqrt(spread[place, place])))


def _unit(name: str, value: float) -> float:
    """Return 1, or the value itself for a length, which moves by a share."""
    return value if name in ("along", "across") else 1.0


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--log", type=Path, required=True)
    parser.add_argument("--cells", default="", help="numbers of cells, by commas")
    asked = parser.parse_args()
    rows = [json.loads(line) for line in asked.log.read_text().splitlines()]
    chosen = [int(k) for k in asked.cells.split(",") if k] or range(len(CELLS))
    print("| maps | n | least sd [deg] | errors, rms [deg] | stated sd, rms [deg] |")
    print("|---|---|---|---|---|")
    for cell in (CELLS[k] for k in chosen):
        own = [r["angle"] for r in rows if r["cell"] == cell.words and "angle" in r]
        if cell.along == cell.across or not own:
            continue
        off, low, high, _ = np.degrees(np.array(own)).T
        stated = (high - low) / (2 * 1.96)
        print(
            f"| {cell.words} | {off.size} | {least_deviation(cell):.2f} | "
            f"{np.sqrt(np.mean(off**2)):.2f} | {np.sqrt(np.mean(stated**2)):.2f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
