# SPDX-License-Identifier: MIT
"""Put the printed tables of the surface benchmarks into one page of the docs.

python -m benchmarks.surface.page --tables FOLDER reads the output of each benchmark
from NAME.md and writes docs/surface-benchmark.md. Each heading gives the command.
"""

import argparse
from pathlib import Path

PAGE = Path(__file__).parents[2] / "docs" / "surface-benchmark.md"
PRECISION = "python -m benchmarks.surface.precision"
HEADINGS = {
    "clean": "Precision of D on clean exact profiles of 20,000 points: "
    f"`{PRECISION} --seeds N --first N --dimension D`",
    "efficiency": "D at 1.7 with less chance: "
    "`python -m benchmarks.surface.efficiency --count 200 --seed N --log PATH`",
    "noise": f"With noise of one step: `{PRECISION} --setting noise`",
    "little": f'With noise of 0.3 steps: `{PRECISION} --setting "little noise"`',
    "psf": f'With a point spread of 4 samples: `{PRECISION} --setting "point spread"`',
    "both": "With a point spread of 4 samples and noise of 5 nm: "
    f"`{PRECISION} --setting both`",
    "stylus": f"Traced by a tip of 2 um: `{PRECISION} --setting stylus`",
    "stylus-noise": "Traced by a tip of 2 um with noise of 2 nm: "
    f'`{PRECISION} --setting "stylus and noise"`',
    "verdicts": "Verdicts: `python -m benchmarks.surface.verdicts --seeds N`",
    "band-limited": "Band-limited surfaces drawn by Cholesky factors, 3,000 points: "
    "`python -m benchmarks.surface.band_limited --count N --seed N --log PATH`",
    "lay": "Maps with a lay: "
    "`python -m benchmarks.surface.lay --count 20 --seed N --log PATH`",
    "kinds": "Names of machined surfaces: "
    "`python -m benchmarks.surface.kinds --count N --seed N`",
    "filters": "Filters that the instrument states: "
    "`python -m benchmarks.surface.stated_filters --count 30 --seed N`",
    "roll-off": "Saturated and fractal profiles: "
    "`python -m benchmarks.surface.roll_off --count 20 --seed 7000`",
    "measured": "Band-limited fit of measured surfaces: "
    "`python -m benchmarks.surface.measured FOLDER --columns NAME=COLUMNS`",
    "weierstrass": "Weierstrass-Mandelbrot profiles: "
    "`python -m benchmarks.surface.weierstrass --profiles 100`",
    "figure9": "The 2023 paper's Fig. 9: `python -m benchmarks.surface.figure_9`",
    "speed": "Time, memory and precision compared with other programs: "
    "`python -m benchmarks.surface.speed`",
    "map-speed": "Time and memory of the fits of maps: "
    "`python -m benchmarks.surface.map_speed --sides 512 --seed N`",
    "hostile": "Mutated files: "
    "`python -m benchmarks.surface.hostile --files 2000 --seed N`",
}


def main() -> None:
    """Write the page from the available tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tables", type=Path, required=True)
    folder = parser.parse_args().tables
    parts = [
        "# Surfaces: results of the benchmarks\n",
        "Made by `python -m benchmarks.surface.page`; "
        "[surface.md](surface.md) discusses the results.\n",
    ]
    for name, heading in HEADINGS.items():
        table = folder / f"{name}.md"
        if table.is_file() and table.read_text(encoding="utf-8").count("\n") > 2:
            parts.append(f"## {heading}\n\n{table.read_text(encoding='utf-8')}")
    PAGE.write_text("\n".join(parts), encoding="utf-8")


if __name__ == "__main__":
    main()
