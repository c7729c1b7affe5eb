# SPDX-License-Identifier: MIT
"""Coverage of the band-limited fit on surfaces drawn by Cholesky factors.

python -m benchmarks.surface.band_limited --count 200 --seed 500 --log /tmp/band.jsonl
draws exact Matern profiles by the Cholesky factor of their covariance, in closed form
by Bessel functions: no Fourier transform and no spectrum, which are the estimator's
means. A run that was stopped continues from its log; the table is printed at the end.
"""

import argparse
import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.linalg import cholesky, toeplitz
from scipy.ndimage import gaussian_filter1d
from scipy.special import gamma, kv

from benchmarks.gap.outcomes import share_text
from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.surfaces import Profile
from jointbench.signal.band_limited.band_limited_fit import fit_band_limited
from jointbench.signal.band_limited.band_records import BandLimitedFit

POINTS, PITCH = 3000, 1e-6  # [-], [m]
HEIGHT = 1e-6  # rms [m]
QUANTITIES = ("H", "roll-off", "h rms", "slope rms", "curvature rms")
OPEN = "open roll-off"
"""Where the trace does not decide: scored with those that are named, for named ones
alone are the short ones."""


@dataclass(frozen=True, slots=True)
class Cell:
    """Surfaces of one kind: H, roll-off over the length, and the instrument."""

    hurst: float
    share: float
    blur: float = 0.0  # standard deviation [samples]
    noise: float = 1e-4  # over the rms of the heights [-]
    gaps: float = 0.0  # share of points

    @property
    def words(self) -> str:
        """Name of the cell."""
        extra = [
            f"{name} {value:g}"
            for name, value in (
                ("blur", self.blur),
                ("noise", self.noise),
                ("gaps", self.gaps),
            )
            if value > 1e-4
        ]
        return ", ".join([f"H {self.hurst:g}, roll-off {self.share:g} L", *extra])


CELLS = (
    Cell(0.3, 0.05),
    Cell(0.3, 0.2),
    Cell(0.5, 0.1),
    Cell(0.7, 0.02),
    Cell(0.7, 0.2),
    Cell(0.9, 0.05),
    Cell(0.9, 0.2),
    Cell(0.5, 0.05, blur=2.0, noise=1e-3),
    Cell(0.8, 0.1, blur=3.0, noise=1e-3),
    Cell(0.6, 0.1, noise=0.02),
    Cell(0.7, 0.1, blur=2.0, noise=0.01),
    Cell(0.6, 0.1, gaps=0.005),
)


def covariance(points: int, hurst: float, roll_off: float) -> FloatArray:
    """Return the Matern covariance at lags 0, 1, ... for a variance of 1."""
    lag = 2 * np.pi * np.arange(1, points) / roll_off
    value = 2 ** (1 - hurst) / gamma(hurst) * lag**hurst * kv(hurst, lag)
    return np.concatenate([[1.0], value])


def profiles(cell: Cell, count: int, seed: int) -> Iterator[Profile]:
    """Draw profiles of a cell, seed by seed."""
    margin = int(np.ceil(5 * cell.blur))
    whole = POINTS + 2 * margin
    first = covariance(whole, cell.hurst, cell.share * POINTS)
    root = cholesky(toeplitz(first) + 1e-11 * np.eye(whole), lower=True)
    for k in range(seed, seed + count):
        rng = np.random.default_rng(
            [k, round(100 * cell.hurst), round(1e3 * cell.share)]
        )
        heights = root @ rng.standard_normal(whole)
        if cell.blur:
            heights = gaussian_filter1d(heights, cell.blur, truncate=5.0)
        heights = HEIGHT * heights[margin : margin + POINTS]
        heights = heights + cell.noise * HEIGHT * rng.standard_normal(POINTS)
        valid = rng.uniform(size=POINTS) >= cell.gaps
        yield Profile(cell.words, np.where(valid, heights, 0.0), PITCH, valid)


def truths(cell: Cell, fit: BandLimitedFit) -> list[float]:
    """Return H, roll-off, height, slope and curvature within the stated wavelengths."""
    corner = 2 * np.pi / (cell.share * POINTS * PITCH)
    power = cell.hurst + 0.5
    # Density of the Matern covariance of variance 1.
    level = gamma(power) / (np.sqrt(np.pi) * gamma(cell.hurst) * corner)
    assert fit.moments is not None
    ends = 2 * np.pi / np.array([fit.moments.longest, fit.moments.shortest])
    edge = np.linspace(*ends, 50_001)
    q = 0.5 * (edge[1:] + edge[:-1])
    density = HEIGHT**2 * level * (1 + (q / corner) ** 2) ** -power
    step = q[1] - q[0]
    moments = [np.sqrt(2 * step * np.sum(density * q**k)) for k in (0, 2, 4)]
    return [cell.hurst, 2 * np.pi / corner, *map(float, moments)]


def judged(cell: Cell, profile: Profile) -> dict[str, object]:
    """Fit one profile; return estimate, interval and truth of each quantity."""
    fit = fit_band_limited([profile])
    found: dict[str, object] = {"verdict": fit.verdict.value}
    if fit.hurst is None or fit.moments is None:
        return found
    moments = fit.moments
    true = truths(cell, fit)
    parts = (fit.hurst, fit.roll_off, moments.height, moments.slope, moments.curvature)
    for name, part, truth in zip(QUANTITIES, parts, true, strict=True):
        if part is not None:
            found[name] = [part.value, part.low, part.high, truth]
    if fit.roll_off is None and fit.roll_off_likeliest and fit.roll_off_beyond:
        # Not decided: the likeliest one, and the limit that it is beyond.
        found[OPEN] = [fit.roll_off_likeliest, fit.roll_off_beyond, np.inf, true[1]]
    return found


def table(rows: list[dict[str, object]], cells: list[Cell]) -> str:
    """Return the table of all cells, and the pooled coverage."""
    names = ["H", "roll-off, named or open", "named alone", *QUANTITIES[2:]]
    head = "".join(f" {name}: bias / sd, coverage |" for name in names)
    lines = [
        f"| surfaces | profiles | saturated | too short | no band |{head}",
        "|---" * (5 + len(names)) + "|",
    ]
    pooled: dict[str, list[bool]] = {name: [] for name in QUANTITIES}
    for cell in cells:
        own = [row for row in rows if row["cell"] == cell.words]
        verdicts = [str(row["verdict"]) for row in own]
        counts = [
            sum(word.startswith(start) for word in verdicts)
            for start in ("saturated", "fractal", "no self")
        ]
        texts = [
            _share(own, ("H",), pooled["H"]),
            _share(own, ("roll-off", OPEN), pooled["roll-off"]),
            _share(own, ("roll-off",), []),
            *(_share(own, (name,), pooled[name]) for name in QUANTITIES[2:]),
        ]
        lines.append(
            f"| {cell.words} | {len(own)} | {counts[0]} | {counts[1]} | {counts[2]} | "
            + " | ".join(texts)
            + " |"
        )
    pooled["all"] = [hit for hits in pooled.values() for hit in hits]
    parts = [f"{name} {share_text(sum(x), len(x))}" for name, x in pooled.items()]
    lines.append(f"\nPooled coverage: {', '.join(parts)}.")
    return "\n".join(lines)


def _share(
    rows: list[dict[str, object]], names: tuple[str, ...], pooled: list[bool]
) -> str:
    known = np.array([row[name] for row in rows for name in names if name in row])
    if known.shape[0] < 2:
        return "-"
    value, low, high, truth = known.T
    covered = ((low <= truth) & (truth <= high)).tolist()
    pooled += covered
    off = value - truth if names == ("H",) else np.log(value / truth)
    return f"{off.mean() / off.std(ddof=1):+.2f}, {100 * np.mean(covered):.1f} %"


def main() -> None:
    """Fit what the log lacks, then print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--cells", default="", help="numbers of cells, by commas")
    parser.add_argument("--log", type=Path, required=True)
    parser.add_argument("--table", action="store_true", help="of what there is")
    asked = parser.parse_args()
    chosen = [int(k) for k in asked.cells.split(",") if k] or range(len(CELLS))
    cells = [CELLS[k] for k in chosen]
    rows: list[dict[str, object]] = []
    if asked.log.exists():
        rows = [json.loads(line) for line in asked.log.read_text().splitlines()]
    # Cells take turns: a run that is stopped has as many profiles of each.
    drawn = {}
    for cell in cells:
        done = sum(row["cell"] == cell.words for row in rows)
        if done < asked.count:
            drawn[cell] = profiles(cell, asked.count - done, asked.seed + done)
    while drawn and not asked.table:
        for cell, left in list(drawn.items()):
            one = next(left, None)
            if one is None:
                del drawn[cell]
                continue
            rows.append({"cell": cell.words, **judged(cell, one)})
            with asked.log.open("a") as file:
                file.write(json.dumps(rows[-1]) + "\n")
    print(table(rows, cells))


if __name__ == "__main__":
    main()
