# SPDX-License-Identifier: MIT
"""Write docs/gap-outside.md from the runs of forced_answers.py.

Usage: python benchmarks/gap/outside_page.py RUNS.jsonl --engine 9a158095
           > docs/gap-outside.md
"""

import argparse
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from outcomes import NAMEABLE, share_text

Run = dict[str, Any]
FAMILIES = {
    "quintic_stiffness": "stiffness",
    "root_stiffness": "stiffness",
    "dead_zone_damping": "damping",
    "rattling_mass": "contact",
}
"""Family that is true of an effect; the others are of no family of laws."""
WORDS = ("wrong name", "ambiguous", "right family", "unknown", "none")
_INTRO = """# Effects outside every catalogue, through the whole engine

Made by `benchmarks/gap/forced_answers.py --kind outside` and `outside_page.py`. Each
campaign (eight hits of 512 samples, three levels, half of them with 0.1 to 0.2 %
scatter) hides one effect that the catalogue lacks, of 3 to 100 % of its largest
physical size. The margin is what separates it from the best rival of the catalogue,
refitted with the base. The catalogue is whole and so is the engine: single effects,
pairs, acceptance criteria, and the verdict under model error.

A wrong name is a verdict of `named`, or of `mostly` with a family that is not true of
the effect. Ambiguous: two or more effects of the catalogue explain the records, and the
verdict says that they cannot be distinguished; none of them is true. Right family:
`mostly` with a true one. None: nothing was found. A delay and a low pass of all
channels are rivals in the margins as well (a drift of the clock resembles them).
Scatter of the joint from hit to hit, which can imitate a drift of it, is not: those
margins are too large.
"""


def word_of(run: Run) -> str:
    """Return what a verdict on an effect outside the catalogue is worth."""
    found = run["found"]
    if found["verdict"] == "named":
        return "wrong name"
    if found["verdict"] == "mostly":
        family = FAMILIES.get(run["truth"].partition("@")[0], "")
        return "right family" if found["mostly"]["family"] == family else "wrong name"
    return str(found["verdict"])


def _row(label: str, runs: Sequence[Run]) -> str:
    words = [word_of(r) for r in runs]
    cells = [share_text(words.count("wrong name"), len(runs))]
    cells += [str(words.count(word)) for word in WORDS[1:]]
    margins = sorted(r["margin"] for r in runs)
    ends = f"{margins[0]:.3g} to {margins[-1]:.3g}" if margins else "-"
    return f"| {label} | {len(runs)} | {' | '.join(cells)} | {ends} |"


def page(every: Sequence[Run], engine: str) -> str:
    """Return the page."""
    runs = [r for r in every if r["kind"] == "outside"]
    seeds = [r["seed"] for r in runs]
    clear = [r for r in runs if r["margin"] >= NAMEABLE]
    faint = [r for r in runs if r["margin"] < NAMEABLE]
    lines = [
        _INTRO,
        f"Engine: {engine}, seeds {min(seeds)} to {max(seeds)}, drawn after its last "
        "change.",
        "",
        "| effect | n | wrong name | ambiguous | right family | unknown | none | "
        "margins |",
        "|---" * 8 + "|",
        _row(f"all of margin {NAMEABLE:g} or more", clear),
    ]
    names = sorted({r["truth"].partition("@")[0] for r in clear})
    for name in names:
        own = [r for r in clear if r["truth"].partition("@")[0] == name]
        lines.append(_row(name, own))
    lines += [
        _row(f"margin below {NAMEABLE:g}", faint),
        "",
        "## Every campaign",
        "",
        "| seed | effect | size | margin | nearest rival | verdict | names |",
        "|---" * 7 + "|",
    ]
    for r in runs:
        found = r["found"]
        names = [f"{e['name']}@{e['site']}" for e in found["effects"]]
        if found["verdict"] == "mostly":
            names = [f"family {found['mostly']['family']}"]
        lines.append(
            f"| {r['seed']} | {r['truth']} | {r['size']:.2f} | {r['margin']:.3g} | "
            f"{r['rival']} | {found['verdict']} | {', '.join(names)} |"
        )
    return "\n".join([*lines, ""])


def main() -> None:
    """Print the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("runs", type=Path)
    parser.add_argument("--engine", required=True, help="commit that was judged")
    arguments = parser.parse_args()
    text = arguments.runs.read_text(encoding="utf-8")
    print(page([json.loads(line) for line in text.splitlines()], arguments.engine))


if __name__ == "__main__":
    main()
