# SPDX-License-Identifier: MIT
"""Puts the printed tables of the surface benchmarks into one page of the docs.

python -m benchmarks.surface.page --tables FOLDER reads there what each benchmark that
was run has printed, as NAME.md, and writes docs/surface-benchmark.md. Each heading says
what to type.
"""

import argparse
from pathlib import Path

PAGE = Path(__file__).parents[2] / "docs" / "surface-benchmark.md"
HEADINGS = {
    "clean": "Precision of D on clean exact profiles of 20,000 points: "
    "`python -m benchmarks.surface.precision --seeds 300`",
    "noise": "With noise of one step between neighbours: "
    "`python -m benchmarks.surface.precision --setting noise --seeds 60`",
    "both": "With a point spread of 4 samples and noise of 5 nm: "
    "`python -m benchmarks.surface.precision --setting both --seeds 60`",
    "psf": "With a point spread of 4 samples: "
    '`python -m benchmarks.surface.precision --setting "point spread" --seeds 60`',
    "stylus": "Traced by a tip of 2 um: "
    "`python -m benchmarks.surface.precision --setting stylus --seeds 40`",
    "little": "With noise of 0.3 steps: "
    '`python -m benchmarks.surface.precision --setting "little noise" --seeds 60`',
    "verdicts": "Verdicts: `python -m benchmarks.surface.verdicts --seeds 60`",
    "weierstrass": "Weierstrass-Mandelbrot profiles: "
    "`python -m benchmarks.surface.weierstrass --profiles 100`",
    "figure9": "The 2023 paper's Fig. 9: `python -m benchmarks.surface.figure_9`",
    "speed": "Time, memory and precision beside others: "
    "`python -m benchmarks.surface.speed`",
    "hostile": "Mutated files: `python -m benchmarks.surface.hostile --files 2000`",
}


def main() -> None:
    """Write the page of the tables that are there."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tables", type=Path, required=True)
    folder = parser.parse_args().tables
    parts = [
        "# Surfaces: what the benchmarks print\n",
        "Made by `python -m benchmarks.surface.page`; what it means stands in "
        "[surface.md](surface.md).\n",
    ]
    for name, heading in HEADINGS.items():
        table = folder / f"{name}.md"
        if table.is_file() and table.read_text(encoding="utf-8").count("\n") > 2:
            parts.append(f"## {heading}\n\n{table.read_text(encoding='utf-8')}")
    PAGE.write_text("\n".join(parts), encoding="utf-8")


if __name__ == "__main__":
    main()
