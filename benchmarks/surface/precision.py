# SPDX-License-Identifier: MIT
"""How precise D is on exact self-affine profiles, clean and through an instrument.

python -m benchmarks.surface.precision writes one line of a table for each setting.
"""

import argparse
from collections import Counter
from dataclasses import dataclass, replace

import numpy as np
import scipy.ndimage
from scipy.special import zeta

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.surfaces import Profile
from jointbench.signal.fractal.fractal_fit import fit_fractal
from jointbench.signal.fractal.verdict_records import SurfaceVerdict
from jointbench.signal.surface.structure_function import structure_function
from jointbench.simulators.rough_surfaces.profilometer import traced
from jointbench.simulators.rough_surfaces.rough_surface import rough_profile

POINTS = 20_000
SPACING = 1e-7  # [m]
STEP = 20e-9  # standard deviation of neighbouring heights' difference [m]


@dataclass(frozen=True, slots=True)
class Setting:
    """An instrument: blur [samples], noise [m], tip [m] and the models that are right.

    A stylus and a point spread count as one.
    """

    blur: float
    noise: float
    right: tuple[str, ...]
    tip: float = 0.0


HEAD = (
    "instrument",
    "D",
    "profiles",
    "bias",
    "sd",
    "Cramer-Rao",
    "sd over it",
    "stated sd",
    "2-sigma coverage",
    "right model",
    "without D",
    "fractal over all lags",
)
SPREAD, BOTH = (
    ("point spread", "stylus"),
    ("point spread and noise", "stylus and noise"),
)
SETTINGS = {
    "clean": Setting(0.0, 0.0, ("none",)),
    "noise": Setting(0.0, STEP, ("noise",)),
    "little noise": Setting(0.0, 0.3 * STEP, ("noise",)),
    "point spread": Setting(4.0, 0.0, SPREAD),
    "both": Setting(4.0, 5e-9, BOTH),
    "stylus": Setting(0.0, 0.0, (*SPREAD, *BOTH), tip=2e-6),
    "stylus and noise": Setting(0.0, 2e-9, (*SPREAD, *BOTH), tip=2e-6),
}


def cramer_rao(dimension: float, points: int) -> float:
    """Return the least standard deviation of D with the amplitude unknown.

    Whittle's information of the increments of fractional Brownian motion: the spread
    of d ln f / dH over the frequencies, f being their aliased spectrum.
    """

    def log_spectrum(hurst: float) -> FloatArray:
        turns = (np.arange(8000) + 0.5) / 16_000
        # All aliases at once: Hurwitz's zeta function.
        aliased = zeta(1 + 2 * hurst, turns) + zeta(1 + 2 * hurst, 1 - turns)
        aliased *= (2 * np.pi) ** (-1 - 2 * hurst)
        return np.asarray(np.log(4 * np.sin(np.pi * turns) ** 2 * aliased))

    hurst = 2 - dimension
    slope = (log_spectrum(hurst + 1e-4) - log_spectrum(hurst - 1e-4)) / 2e-4
    return float(np.sqrt(2 / (points * np.var(slope))))


def measured(
    dimension: float, setting: Setting, seed: int, points: int = POINTS
) -> Profile:
    """Return an exact profile as the instrument shows it."""
    profile = rough_profile(
        points, spacing=SPACING, dimension=dimension, roughness=1e-10, seed=seed
    )
    heights = profile.heights * STEP / np.std(np.diff(profile.heights))
    heights = traced(heights, (SPACING,), setting.tip)
    if setting.blur > 0:
        heights = scipy.ndimage.gaussian_filter1d(heights, setting.blur)
    noise = np.random.default_rng([seed, 77]).standard_normal(points)
    return replace(profile, heights=heights + setting.noise * noise)


def line(name: str, dimension: float, seeds: range, points: int) -> str:
    """Return one line of the table."""
    setting, found, models, whole = SETTINGS[name], [], Counter[str](), 0
    for seed in seeds:
        profile = measured(dimension, setting, seed, points)
        fit = fit_fractal(structure_function(profile))
        models[fit.instrument] += 1
        whole += fit.verdict is SurfaceVerdict.FRACTAL
        if fit.scaling is not None:
            found.append((fit.scaling.dimension, fit.scaling.dimension_sd))
    value, stated = np.array(found).T
    bound = cramer_rao(dimension, points) if name == "clean" else float("nan")
    cells = (
        name,
        f"{dimension}",
        f"{len(seeds)}",
        f"{value.mean() - dimension:+.4f}",
        f"{value.std(ddof=1):.5f}",
        f"{bound:.5f}" if name == "clean" else "-",
        f"{value.std(ddof=1) / bound:.3f}" if name == "clean" else "-",
        f"{stated.mean():.5f}",
        f"{100 * np.mean(np.abs(value - dimension) < 2 * stated):.1f} %",
        f"{100 * sum(models[name] for name in setting.right) / len(seeds):.1f} %",
        f"{len(seeds) - len(found)}",
        f"{100 * whole / len(seeds):.1f} %",
    )
    return "| " + " | ".join(cells) + " |"


def main() -> None:
    """Print the lines that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--setting", choices=list(SETTINGS), default="clean")
    parser.add_argument("--dimension", type=float, nargs="+", default=[1.3, 1.5, 1.7])
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--points", type=int, default=POINTS)
    asked = parser.parse_args()
    print("| " + " | ".join(HEAD) + " |\n" + "|---" * len(HEAD) + "|")
    for dimension in asked.dimension:
        seeds = range(asked.first, asked.first + asked.seeds)
        print(line(asked.setting, dimension, seeds, asked.points), flush=True)


if __name__ == "__main__":
    main()
