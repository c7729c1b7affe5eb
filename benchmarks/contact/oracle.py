# SPDX-License-Identifier: MIT
"""Elastic rough contact by boundary elements: a table to judge the sum of contacts.

Needs the extra `oracle` (tamaas). Periodic self-affine maps, rigid against an elastic
half-space; beside each load the same summits as independent Hertz contacts, which is
rough contact without interaction.

    python benchmarks/contact/oracle.py        writes oracle.json beside itself
"""

import json
import math
from pathlib import Path

import numpy as np
import tamaas as tm
from scipy.ndimage import label, maximum_filter
from scipy.optimize import brentq

POINTS = 256
LONGEST, SHORTEST = 4, 16  # of the box; points per shortest wave
SEEDS = (1, 2, 3)
HURSTS = (0.5, 0.7, 0.8)
# Mean pressure over E* times rms slope.
LOADS = (0.005, 0.01, 0.02, 0.04, 0.08)
STEP = 0.02
TOLERANCE = 1e-7
OUT = Path(__file__).with_name("oracle.json")


def self_affine(hurst: float, seed: int) -> np.ndarray:
    """Return a periodic map on a unit square with rms slope 1, power q^(-2-2H)."""
    random = np.random.default_rng(seed)
    q = np.fft.fftfreq(POINTS, 1 / POINTS)
    size = np.hypot(*np.meshgrid(q, q, indexing="ij"))
    inside = (size >= LONGEST) & (size <= POINTS / SHORTEST)
    amplitude = np.where(inside, np.where(inside, size, 1.0) ** (-1 - hurst), 0.0)
    noise = np.fft.fft2(random.standard_normal((POINTS, POINTS)))
    heights = np.fft.ifft2(noise * amplitude).real
    return heights / rms_slope(heights)


def rms_slope(heights: np.ndarray) -> float:
    """Return the rms slope by Fourier derivative."""
    q = 2 * math.pi * np.fft.fftfreq(POINTS, 1 / POINTS)
    spectrum = np.fft.fft2(heights)
    x, y = (np.fft.ifft2(1j * k * spectrum).real for k in (q[:, None], q[None, :]))
    return float(np.sqrt((x**2 + y**2).mean()))


def solve(heights: np.ndarray, pressure: float) -> dict[str, float]:
    """Return mean gap, area and cluster stiffness at one mean pressure, E* = 1."""
    model = tm.Model(tm.model_type.basic_2d, [1.0, 1.0], [POINTS, POINTS])
    model.E, model.nu = 1.0, 0.0
    solver = tm.PolonskyKeerRey(model, heights, TOLERANCE)
    solver.solve(pressure)
    gap = model.displacement - heights
    clusters, count = label(model.traction > 0)
    areas = np.bincount(clusters.ravel())[1:] / POINTS**2
    return {
        "gap": float(gap.mean() - gap.min()),
        "area": float((model.traction > 0).mean()),
        "clusters": int(count),
        "sum_of_contacts": float((2 * np.sqrt(areas / math.pi)).sum()),
    }


def summits(heights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return heights and radii of all local maxima."""
    top = heights == maximum_filter(heights, size=3, mode="wrap")
    xx, yy = (
        np.roll(heights, 1, axis) + np.roll(heights, -1, axis) - 2 * heights
        for axis in (0, 1)
    )
    curvature = -0.5 * (xx + yy)[top] * POINTS**2
    keep = curvature > 0
    return heights[top][keep], 1 / curvature[keep]


def independent(heights: np.ndarray, pressure: float) -> dict[str, float]:
    """Return stiffness and area of the same summits, each as Hertz has it alone."""
    z, radius = summits(heights)

    def load(plane: float) -> float:
        return float((4 / 3 * np.sqrt(radius) * np.maximum(z - plane, 0) ** 1.5).sum())

    plane = brentq(lambda d: load(d) - pressure, z.min() - 5, z.max(), xtol=1e-14)
    depth = np.maximum(z - plane, 0)
    return {
        "stiffness": float((2 * np.sqrt(radius * depth)).sum()),
        "area": float((math.pi * radius * depth).sum()),
    }


def row(heights: np.ndarray, pressure: float) -> dict[str, float]:
    """Return one load: boundary elements, and independent summits at equal load."""
    low, high = (solve(heights, pressure * (1 + s)) for s in (-STEP, STEP))
    middle, alone = solve(heights, pressure), independent(heights, pressure)
    return {
        "pressure": pressure,
        "stiffness": 2 * STEP * pressure / (low["gap"] - high["gap"]),
        "area": middle["area"],
        "clusters": middle["clusters"],
        "sum_of_contacts": middle["sum_of_contacts"],
        "independent_stiffness": alone["stiffness"],
        "independent_area": alone["area"],
    }


def line_structure(heights: np.ndarray) -> dict[str, float]:
    """Return the structure function at a lag inside the scaling range."""
    lag = POINTS // 16
    both = [
        float(((np.roll(heights, lag, axis) - heights) ** 2).mean()) for axis in (0, 1)
    ]
    return {"lag": lag / POINTS, "structure": sum(both) / 2}


def main() -> None:
    """Solve all surfaces and freeze the table."""
    table = []
    for hurst in HURSTS:
        for seed in SEEDS:
            heights = self_affine(hurst, seed)
            table.append(
                {
                    "hurst": hurst,
                    "seed": seed,
                    "rms_height": float(heights.std()),
                    "shortest": SHORTEST / POINTS,
                    **line_structure(heights),
                    "loads": [row(heights, load) for load in LOADS],
                }
            )
            print(hurst, seed, table[-1]["loads"][2], flush=True)
    content = {"solver": f"tamaas {tm.__version__}", "points": POINTS, "rows": table}
    OUT.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
