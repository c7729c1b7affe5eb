# SPDX-License-Identifier: MIT
"""Standard deviation of D over the bound, from differences with the most likely D.

python -m benchmarks.surface.efficiency --dimension 1.7 --count 200 --seed N --log PATH

The ratio of a standard deviation of 200 profiles to the bound is uncertain by 5 %. An
efficient estimate of the same profiles removes most of that: any regular estimate is
the efficient one plus an independent error, whose variance adds to the bound's
(convolution theorem: Hajek, Z. Wahrsch. 14 (1970) 323). The efficient one here is
Whittle's likelihood of the height differences in its closed form, which takes nothing
from the program. A run that was stopped continues from its log.
"""

import argparse
import json
from pathlib import Path

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.special import zeta

from benchmarks.surface.precision import POINTS, SETTINGS, cramer_rao, measured
from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.signal.fractal.fractal_fit import fit_fractal
from jointbench.signal.surface.structure_function import structure_function


def most_likely(heights: FloatArray) -> float:
    """Return D of the greatest Whittle likelihood of the differences of neighbours.

    Source:
        Spectrum of fractional Gaussian noise with all aliases: Beran, Statistics for
        Long-Memory Processes (1994), 2.3 and 5.5.
    """
    steps = np.diff(heights)
    power = np.abs(np.fft.rfft(steps - steps.mean())[1:]) ** 2
    turns = np.arange(1, power.size + 1) / steps.size
    sine = np.log(4 * np.sin(np.pi * turns) ** 2)

    def loss(hurst: float) -> float:
        aliased = zeta(1 + 2 * hurst, turns) + zeta(1 + 2 * hurst, 1 - turns)
        log_shape = sine + np.log(aliased)
        level = np.log(np.mean(power * np.exp(-log_shape)))
        return float(level + np.mean(log_shape))

    found = minimize_scalar(
        loss, bounds=(0.02, 0.98), method="bounded", options={"xatol": 1e-6}
    )
    return 2 - float(found.x)


def judged(dimension: float, seed: int) -> list[float]:
    """Return seed, D of the fit and the most likely D of one clean profile."""
    profile = measured(dimension, SETTINGS["clean"], seed)
    fit = fit_fractal(structure_function(profile))
    value = np.nan if fit.scaling is None else fit.scaling.dimension
    return [seed, value, most_likely(profile.heights)]


def line(dimension: float, rows: list[list[float]]) -> str:
    """Return a row of the table."""
    fitted, likely = np.array(rows)[:, 1:].T - dimension
    bound = cramer_rao(dimension, POINTS)
    count = fitted.size
    apart = np.var(fitted - likely, ddof=1) / bound**2
    ratio = np.sqrt(1 + apart)
    spread = np.sum((fitted - likely - (fitted - likely).mean()) ** 4) / count
    error = np.sqrt(max(0.0, spread / bound**4 - apart**2) / count) / (2 * ratio)
    # Of the differences on the efficient estimate: 0 if they are independent of it.
    slope = np.cov(fitted - likely, likely)[0, 1] / np.var(likely, ddof=1)
    slope_error = np.sqrt(apart / count) * bound / np.std(likely, ddof=1)
    cells = (
        f"{dimension}",
        f"{count}",
        f"{fitted.mean():+.4f}",
        f"{np.std(likely, ddof=1) / bound:.3f}",
        f"{np.std(fitted, ddof=1) / bound:.3f} +- {ratio / np.sqrt(2 * count):.3f}",
        f"{slope:+.3f} +- {slope_error:.3f}",
        f"{ratio:.3f} ({ratio - 1.96 * error:.3f} to {ratio + 1.96 * error:.3f})",
    )
    return "| " + " | ".join(cells) + " |"


def main() -> None:
    """Fit what the log lacks and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--dimension", type=float, default=1.7)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--log", type=Path, required=True)
    asked = parser.parse_args()
    rows: list[list[float]] = []
    if asked.log.exists():
        rows = [json.loads(one) for one in asked.log.read_text().splitlines()]
    for k in range(len(rows), asked.count):
        rows.append(judged(asked.dimension, asked.seed + k))
        with asked.log.open("a") as file:
            file.write(json.dumps(rows[-1]) + "\n")
    print(
        "| D | profiles | bias | most likely D: sd over the bound | fit: sd over it | "
        "differences on the most likely | sd over the bound by differences |\n"
        + "|---" * 7
        + "|"
    )
    print(line(asked.dimension, rows))


if __name__ == "__main__":
    main()
