# SPDX-License-Identifier: MIT
"""Which names machined surfaces get, and that fractal ones get none.

python -m benchmarks.surface.kinds --count 20 --seed 9000 prints a table.
"""

import argparse
import sys
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np

from jointbench.acquisition.records.surfaces import Areal, Profile, Surface, all_valid
from jointbench.signal.band_limited.band_limited_fit import fit_band_limited
from jointbench.signal.band_limited.band_records import RollOffVerdict
from jointbench.signal.band_limited.surface_kinds import surface_kinds
from jointbench.simulators.rough_surfaces.rough_surface import rough_profile

# Generators and second methods that the tests use as well.
sys.path.insert(0, str(Path(__file__).parents[2] / "tests" / "judges"))

import machined_surfaces
from lay_surfaces import Embedded

POINTS, SIDE, PITCH, HEIGHT = 16_000, 200, 1e-6, 1e-7


def _profile(heights: np.ndarray) -> Profile:
    return Profile("p", HEIGHT * heights, PITCH, all_valid(heights))


def _line(name: str) -> Callable[[int], Surface]:
    maker = getattr(machined_surfaces, name)
    return lambda seed: _profile(maker(POINTS, seed))


def _honed(seed: int) -> Surface:
    heights, _ = machined_surfaces.honed(SIDE, seed)
    return Areal("h", HEIGHT * heights, (PITCH, PITCH), all_valid(heights))


def _one_lay(seed: int) -> Surface:
    rng = np.random.default_rng([seed, 10])
    across = float(rng.uniform(10, 25))
    made = Embedded(
        (SIDE, SIDE),
        hurst=float(rng.uniform(0.4, 0.9)),
        along=across * float(rng.uniform(1.5, 5)),
        across=across,
        angle=float(rng.uniform(-np.pi / 2, np.pi / 2)),
    )
    heights = HEIGHT * np.ascontiguousarray(made.draw(rng)[0])
    return Areal("l", heights, (PITCH, PITCH), all_valid(heights))


def _fractal(seed: int) -> Surface:
    dimension = float(np.random.default_rng([seed, 9]).uniform(1.2, 1.8))
    return rough_profile(
        POINTS, spacing=PITCH, dimension=dimension, roughness=1e-10, seed=seed
    )


def _saturated(seed: int) -> Surface:
    length = float(np.random.default_rng([seed, 8]).uniform(50, 400))
    return _profile(machined_surfaces.exponential(POINTS, length, seed))


KINDS: dict[str, tuple[Callable[[int], Surface], str]] = {
    "turned": (_line("turned"), "marks"),
    "milled": (_line("milled"), "marks"),
    "honed": (_honed, "two directions"),
    "one lay, ratio 1.5 to 5": (_one_lay, "none"),
    "plateau over valleys": (_line("plateau"), "two processes"),
    "bifractal": (_line("bifractal"), "bend"),
    "saturated": (_saturated, "none"),
    "fractal": (_fractal, "none"),
}


def names(surface: Surface) -> tuple[str, bool]:
    """Return the names of a surface, and whether it is called fractal."""
    fit = fit_band_limited([surface])
    kinds = surface_kinds(surface, fit)
    found = {
        "marks": kinds.marks is not None,
        "two directions": bool(kinds.directions),
        "two processes": kinds.two_processes,
        "bend": kinds.bend is not None,
    }
    words = ", ".join(name for name, there in found.items() if there) or "none"
    # With a name, neither fit says "fractal over all lags".
    fractal = fit.verdict in {RollOffVerdict.FRACTAL, RollOffVerdict.UNDECIDED}
    return words, fractal and words == "none"


def main() -> None:
    """Fit and count."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", default="", help="kinds that begin so")
    asked = parser.parse_args()
    last = "fractal, or too short to decide, without a name"
    print(f"| surface | right name | names | right | {last} |")
    print("|---|---|---|---|---|")
    for kind, (make, right) in KINDS.items():
        if not kind.startswith(asked.only):
            continue
        seeds = range(asked.seed, asked.seed + asked.count)
        found = [names(make(seed)) for seed in seeds]
        counts = Counter(words for words, _ in found)
        said = ", ".join(f"{words} {count}" for words, count in counts.items())
        hits = sum(right in words for words, _ in found)
        whole = sum(one for _, one in found)
        print(
            f"| {kind} | {right} | {said} | {hits} of {asked.count} | {whole} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
