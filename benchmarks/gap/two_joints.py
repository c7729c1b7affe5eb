# SPDX-License-Identifier: MIT
"""Two nonlinear joints at once: forward accuracy and diagnoses.

Usage: python benchmarks/gap/two_joints.py forward FORWARD.jsonl
       python benchmarks/gap/two_joints.py drawn DRAWN.jsonl [--count 40] [--seed 1]
       python benchmarks/gap/two_joints.py diagnose RUNS.jsonl [--count 40] [--seed 1]
       python benchmarks/gap/two_joints.py page FORWARD.jsonl DRAWN.jsonl RUNS.jsonl

`forward` compares every pair of laws, a linear one included, with solve_ivp; `drawn`
compares pairs drawn at random, whose seeds must be new to the engine; `diagnose` makes
campaigns with a law at each of two joints and diagnoses them. What is in a file already
is skipped. `page` prints docs/gap-two-joints.md.
"""

import argparse
import json
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from joint_pairs import (
    PAIRED,
    RUBBING,
    STEPS,
    draw_pair,
    fixed_names,
    fixed_pair,
)
from outcomes import wilson
from two_joints_maker import make_two_joints

BAR = 1e-4
WORDS = ("right", "ambiguous with both", "one of two", "unknown", "wrong", "crash")


Run = dict[str, Any]


def main() -> None:
    """Run a part."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=(*PARTS, "page"))
    parser.add_argument("paths", type=Path, nargs="+")
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    if arguments.what == "page":
        forward, drawn, runs = (_lines(path) for path in arguments.paths)
        sys.stdout.write(page(forward, drawn, runs))
        return
    path = arguments.paths[0]
    done = {run["key"] for run in _lines(path)}
    seeds = range(arguments.seed, arguments.seed + arguments.count)
    jobs = fixed_names() if arguments.what == "forward" else map(str, seeds)
    for key in jobs:
        if key not in done:
            run = PARTS[arguments.what](key)
            with path.open("a", encoding="utf-8") as out:
                out.write(json.dumps({"key": key} | run) + "\n")
            sys.stderr.write(f"{key} {run.get('word', '')}\n")


def forward_of(key: str) -> Run:
    """Return the largest differences from solve_ivp of a pair of the fixed set."""
    return fixed_pair(key).compared(checked=False)


def drawn_of(key: str) -> Run:
    """Return those of a pair drawn with a seed, and its laws."""
    pair = draw_pair(int(key))
    return {"laws": " ".join(pair.names)} | pair.compared(checked=True)


def _lines(path: Path) -> list[Run]:
    if not path.exists():
        return []
    return [json.loads(row) for row in path.read_text(encoding="utf-8").splitlines()]


def judge(key: str) -> Run:
    """Make a campaign and diagnose it."""
    from jointbench.analysis.gap.diagnosis.diagnose import diagnose
    from jointbench.analysis.gap.model.diagnosis_record import diagnosis_json

    made = make_two_joints(int(key))
    start = time.process_time()
    try:
        found = diagnosis_json(diagnose(made.campaign))
    except Exception as error:  # noqa: BLE001 - a crash is an outcome to be counted
        reason = f"{type(error).__name__}: {error}"
        found = {"verdict": "crash", "effects": [], "reason": reason}
    run = {
        "truth": made.truth,
        "parameters": [dict(e.parameters) for e in made.effects],
        "rho": made.rho,
        "seconds": time.process_time() - start,
        "found": found,
    }
    return run | {"word": word_of(run)}


def word_of(run: Run) -> str:
    """Return what a diagnosis is worth: one of `WORDS`."""
    truth, found = set(run["truth"]), run["found"]
    labels = {f"{e['name']}@{e['site']}" for e in found["effects"]}
    if found["verdict"] == "ambiguous":
        return "ambiguous with both" if truth <= labels else "wrong"
    if found["verdict"] == "crash":
        return "crash"
    if found["verdict"] != "named":
        return "unknown"
    if labels == truth:
        return "right"
    return "one of two" if labels < truth else "wrong"


PARTS: dict[str, Callable[[str], Run]] = {
    "forward": forward_of,
    "drawn": drawn_of,
    "diagnose": judge,
}


def page(forward: list[Run], drawn: list[Run], runs: list[Run]) -> str:
    """Return the page."""
    fixed = [run | {"laws": run["key"]} for run in forward]
    reference = max(run["reference"] for run in drawn)
    lines = [
        "# Two nonlinear joints at once",
        "",
        "Made by `benchmarks/gap/two_joints.py`. The specimen is ground, foot, base, "
        "joint, top; a law acts at the foot and another one at the joint.",
        "",
        "## Forward response",
        "",
        "Largest difference of an acceleration from `solve_ivp` (LSODA, tolerance "
        f"1e-9) over its peak. The bar is {BAR:g}, at the 8 steps a sample of the "
        "engine. Last row of each table: two single responses added up, for "
        "comparison.",
        "",
        f"{len(drawn)} pairs drawn at random, seeds {drawn[0]['key']} to "
        f"{drawn[-1]['key']}: specimen, laws and their sizes as for simulated "
        "campaigns, hits of 200 to 1000 N at either body. No setting of the time "
        "integration was chosen on them. "
        f"{sum(run['apart']['8'] <= BAR for run in drawn)} are within the bar. The "
        f"reference itself changes by {reference:.1e} at most with a tenth of the "
        "tolerance and twice the points.",
        "",
        *_forward_table(drawn),
        "",
        f"All {len(fixed)} pairs of {len(PAIRED)} laws of one size in one specimen, on "
        "which earlier settings were chosen:",
        "",
        *_forward_table(fixed),
        "",
        *_diagnosis_part(runs),
        "",
    ]
    return "\n".join(lines)


def _forward_table(pairs: list[Run]) -> list[str]:
    rubbing = [run for run in pairs if set(run["laws"].split()) & set(RUBBING)]
    others = [run for run in pairs if run not in rubbing]
    lines = [
        f"| steps a sample | without dry friction ({len(others)}): median | worst | "
        f"worst pair | with dry friction ({len(rubbing)}): median | worst | "
        "worst pair |",
        "|---" * 7 + "|",
    ]
    rows: dict[str, Callable[[Run], float]] = {
        str(n): lambda run, n=n: float(run["apart"][str(n)]) for n in STEPS
    }
    for label, of in (rows | {"added up": lambda run: float(run["serial"])}).items():
        cells = [label, *_cells(others, of), *_cells(rubbing, of)]
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def _cells(pairs: list[Run], of: Callable[[Run], float]) -> list[str]:
    if not pairs:
        return ["", "", ""]
    worst = max(pairs, key=of)
    middle = float(np.median([of(run) for run in pairs]))
    return [f"{middle:.1e}", f"{of(worst):.1e}", worst["laws"].replace(" ", " + ")]


def _diagnosis_part(runs: list[Run]) -> list[str]:
    count = len(runs)
    lines = [
        "## Diagnoses",
        "",
        f"{count} campaigns (eight hits of 47 ms) by the simulators' Runge-Kutta "
        "stepper, each with two laws drawn from eight; each law has a projected "
        "signal-to-noise ratio above 30 beside the other. Sites count: a right name at "
        "the other joint is wrong. Of nine larger campaigns (12 or 15 hits) before the "
        "last changes of the time integration eight were right, one was unknown.",
        "",
        "| outcome | n | 95 % interval |",
        "|---|---|---|",
    ]
    for word in WORDS:
        mine = sum(run["word"] == word for run in runs)
        low, high = wilson(mine, count)
        share = f"{mine} ({100 * mine / count:.0f} %)"
        lines.append(f"| {word} | {share} | {low:.0f} to {high:.0f} % |")
    seconds = [run["seconds"] for run in runs]
    lines += [
        "",
        f"Computing time: median {np.median(seconds):.0f} s, worst "
        f"{max(seconds):.0f} s of one core.",
        "",
        "| seed | foot | joint | rho | verdict | found |",
        "|---" * 6 + "|",
    ]
    for run in runs:
        found = run["found"]
        labels = ", ".join(f"{e['name']}@{e['site']}" for e in found["effects"])
        names = [label.partition("@")[0] for label in run["truth"]]
        rho = " / ".join(f"{value:.0f}" for value in run["rho"])
        lines.append(
            f"| {run['key']} | {names[0]} | {names[1]} | {rho} | {run['word']} | "
            f"{found['verdict']}: {labels} |"
        )
    return lines


if __name__ == "__main__":
    main()
