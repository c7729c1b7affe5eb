# SPDX-License-Identifier: MIT
"""Direction, exponents and moments of maps with a lay and without one.

python -m benchmarks.surface.lay --count 20 --seed 9000 --log PATH fits maps drawn from
closed covariances by circulant embedding (tests/judges/lay_surfaces.py), appends each
result to a log and prints a table; it continues a log that has some.
"""

import argparse
import json
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointbench.acquisition.records.surfaces import Areal, all_valid
from jointbench.signal.band_limited.band_limited_fit import fit_band_limited
from jointbench.signal.band_limited.band_records import BandLimitedFit, Interval95

# Generators and second methods that the tests use as well.
sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "judges"))

from lay_surfaces import Embedded, rms_in_rings

SIDE, PITCH, HEIGHT = 256, 1e-6, 1e-6  # [-], [m], [m]
QUANTITIES = ("H along", "H across", "roll-off along", "roll-off across")
MOMENTS = ("height", "slope", "curvature")


@dataclass(frozen=True, slots=True)
class Cell:
    """Surfaces of one kind: e is 0 for one H, see the judge; lengths in samples."""

    hurst: float
    along: float
    across: float
    skew: float = 0.0
    blur: float = 0.0
    noise: float = 0.0
    side: int = SIDE

    @property
    def words(self) -> str:
        """Name of the cell."""
        ratio = self.along / self.across
        said = f"H {self.hurst:g}, roll-off {self.across:g}, ratio {ratio:g}"
        if self.skew:
            along, across = self.exponents
            said = f"H {along:.2g} and {across:.2g}, ratio {ratio:g}"
        if self.blur:
            said += f", blur {self.blur:g}"
        if self.noise:
            said += f", noise {self.noise:g}"
        return f"{said}, {self.side} x {self.side}"

    @property
    def exponents(self) -> tuple[float, float]:
        """H along the lay and across it."""
        return self.hurst / (1 + self.skew), self.hurst / (1 - self.skew)


CELLS = (
    Cell(0.7, 30, 30),
    Cell(0.4, 20, 20),
    Cell(0.7, 36, 24),
    Cell(0.4, 36, 24),
    Cell(0.6, 40, 20),
    Cell(0.9, 60, 20),
    Cell(0.5, 75, 15),
    Cell(0.8, 75, 15),
    Cell(0.6, 40, 20, skew=0.15),
    Cell(0.6, 60, 20, skew=-0.15),
    Cell(0.7, 60, 20, blur=1.2, noise=0.002),
    Cell(0.7, 20, 10, side=128),
)


def maps(cell: Cell, count: int, seed: int) -> Iterator[tuple[float, Areal]]:
    """Yield angles [rad] and maps of a cell, each with a lay of its own."""
    for k in range(seed, seed + count):
        rng = np.random.default_rng([k, CELLS.index(cell)])
        angle = rng.uniform(-np.pi / 2, np.pi / 2)
        drawn = Embedded(
            (cell.side, cell.side),
            hurst=cell.hurst,
            along=cell.along,
            across=cell.across,
            angle=angle,
            skew=cell.skew,
            blur=cell.blur,
        )
        heights, _ = drawn.draw(rng)
        heights = heights + cell.noise * rng.standard_normal(heights.shape)
        heights = HEIGHT * np.ascontiguousarray(heights)
        yield angle, Areal(cell.words, heights, (PITCH, PITCH), all_valid(heights))


def judged(cell: Cell, angle: float, areal: Areal) -> dict[str, object]:
    """Fit one map; return estimate, interval and truth of each quantity."""
    fit = fit_band_limited([areal])
    found: dict[str, object] = {
        "verdict": fit.verdict.value,
        "tolerance": fit.tolerance,
        "lay": fit.lay is not None,
    }
    pairs: list[tuple[str, Interval95 | None, float]] = []
    if fit.lay is not None:
        lay = fit.lay
        apart = (lay.angle.value - angle + np.pi / 2) % np.pi - np.pi / 2
        found["angle"] = [apart, lay.angle.low, lay.angle.high, lay.angle.value - apart]
        ends = (lay.hurst_along, lay.hurst_across)
        pairs += zip(QUANTITIES[:2], ends, cell.exponents, strict=True)
        far = (lay.roll_off_along, lay.roll_off_across)
        truth = (cell.along * PITCH, cell.across * PITCH)
        pairs += zip(QUANTITIES[2:], far, truth, strict=True)
    else:
        pairs.append(("H along", fit.hurst, cell.hurst))
        pairs.append(("roll-off along", fit.roll_off, cell.along * PITCH))
    pairs += _moments(cell, fit)
    for name, part, true in pairs:
        if part is not None:
            found[name] = [part.value, part.low, part.high, true]
    return found


def _moments(
    cell: Cell, fit: BandLimitedFit
) -> list[tuple[str, Interval95 | None, float]]:
    moments = fit.moments
    if moments is None:
        return []
    true = rms_in_rings(
        2 * np.pi / moments.longest,
        2 * np.pi / moments.shortest,
        hurst=cell.hurst,
        along=cell.along * PITCH,
        across=cell.across * PITCH,
        skew=cell.skew,
    )
    parts = (moments.height, moments.slope, moments.curvature)
    return [
        (name, part, HEIGHT * one)
        for name, part, one in zip(MOMENTS, parts, true, strict=True)
    ]


def table(rows: list[dict[str, object]], cells: list[Cell]) -> str:
    """Return the table of all cells, and the pooled coverage."""
    names = (*QUANTITIES, *MOMENTS)
    head = "".join(f" {name}: bias / sd, coverage |" for name in names)
    lines = [
        "| maps | n | lay | no band | angle within 2 deg, covered |" + head,
        "|---" * (5 + len(names)) + "|",
    ]
    pooled: list[bool] = []
    for cell in cells:
        own = [row for row in rows if row["cell"] == cell.words]
        bands = sum(str(row["verdict"]).startswith("no self") for row in own)
        texts = [_share(own, name, pooled) for name in names]
        lay = sum(bool(row["lay"]) for row in own)
        lines.append(
            f"| {cell.words} | {len(own)} | {lay} | {bands} | {_angles(own)} | "
            + " | ".join(texts)
            + " |"
        )
    lines.append(f"\nPooled coverage {100 * np.mean(pooled):.1f} % of {len(pooled)}.")
    return "\n".join(lines)


def _angles(rows: list[dict[str, object]]) -> str:
    known = np.array([row["angle"] for row in rows if "angle" in row])
    if not known.size:
        return "-"
    off, low, high, truth = known.T
    right = int(np.sum(np.abs(np.degrees(off)) <= 2))
    covered = 100 * np.mean((low <= truth) & (truth <= high))
    return f"{right} of {off.size}, {covered:.0f} %"


def _share(rows: list[dict[str, object]], name: str, pooled: list[bool]) -> str:
    known = np.array([row[name] for row in rows if name in row])
    if known.shape[0] < 2:
        return "-"
    value, low, high, truth = known.T
    covered = (low <= truth) & (truth <= high)
    pooled += covered.tolist()
    off = value - truth if name.startswith("H") else np.log(value / truth)
    return f"{off.mean() / off.std(ddof=1):+.2f}, {100 * covered.mean():.0f} %"


def main() -> None:
    """Fit what the log lacks, then print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--cells", default="", help="numbers of cells, by commas")
    parser.add_argument("--log", type=Path, required=True)
    asked = parser.parse_args()
    chosen = [int(k) for k in asked.cells.split(",") if k] or range(len(CELLS))
    cells = [CELLS[k] for k in chosen]
    rows: list[dict[str, object]] = []
    if asked.log.exists():
        rows = [json.loads(line) for line in asked.log.read_text().splitlines()]
    for cell in cells:
        done = sum(row["cell"] == cell.words for row in rows)
        left = max(0, asked.count - done)
        for angle, one in maps(cell, left, asked.seed + done):
            rows.append({"cell": cell.words, **judged(cell, angle, one)})
            with asked.log.open("a") as file:
                file.write(json.dumps(rows[-1]) + "\n")
    print(table(rows, cells))


if __name__ == "__main__":
    main()
