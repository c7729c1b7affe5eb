# SPDX-License-Identifier: MIT
"""Turn judged campaigns into a page: confusion, sites, parameters, gaps, confidence.

Usage: python benchmarks/gap/page.py RUNS.jsonl > docs/gap-confusion.md
"""

import argparse
import itertools
import json
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from estimates import (
    coverage,
    fisher,
    force_curves,
    prior_deviations,
    shrinkage,
    site_share,
)
from outcomes import (
    NAMEABLE,
    WORDS,
    Run,
    named_by,
    sets_of,
    share_text,
    wilson,
    word_of,
)


def confusion(sets: dict[str, list[Run]]) -> list[str]:
    """Return the table of outcomes."""
    lines = [
        "| set | n | " + " | ".join(WORDS) + " | median s | worst s |",
        "|---" * (len(WORDS) + 4) + "|",
    ]
    for name, mine in sets.items():
        if not mine:
            continue
        count = Counter(word_of(run) for run in mine)
        cells = [
            f"{count[w]} ({wilson(count[w], len(mine))[0]:.0f}"
            f" to {wilson(count[w], len(mine))[1]:.0f})"
            if count[w]
            else "0"
            for w in WORDS
        ]
        seconds = [run["seconds"] for run in mine]
        lines.append(
            f"| {name} | {len(mine)} | {' | '.join(cells)} | "
            f"{np.median(seconds):.1f} | {max(seconds):.1f} |"
        )
    return lines


def matrix(runs: Sequence[Run]) -> list[str]:
    """Return the verdicts for each single hidden effect."""
    lines = ["| truth | n | verdict |", "|---|---|---|"]
    singles = [run for run in runs if run["kind"] == "single"]
    for name in sorted({run["truth"][0] for run in singles}):
        mine = [run for run in singles if run["truth"] == [name]]
        count = Counter(_answer(run) for run in mine)
        stated = ", ".join(f"{answer} {n}" for answer, n in count.most_common())
        lines.append(f"| {name} | {len(mine)} | {stated} |")
    return lines


def _answer(run: Run) -> str:
    if run["found"]["verdict"] == "named":
        return " + ".join(sorted({name for name, _ in named_by(run)}))
    return str(run["found"]["verdict"])


def null_test(runs: Sequence[Run]) -> str:
    """Return how often the directed tests of a null exceed their limit."""
    tests = [
        r["found"]["null_test"]
        for r in runs
        if r["kind"] == "null" and "null_test" in r["found"]
    ]
    above = sum(t["largest"] > t["limit"] for t in tests)
    far = sum(t["largest"] > 1.3 * t["limit"] for t in tests)
    return (
        f"over the 99.5 % limit {share_text(above, len(tests))}, over 1.3 times the "
        f"limit, where the engine searches for an effect, {share_text(far, len(tests))}"
    )


def reliability(runs: Sequence[Run]) -> list[str]:
    """Return the share of right verdicts against stated confidence, in bins."""
    named = [r for r in runs if r["found"]["verdict"] == "named"]
    stated = [min(e["confidence"] for e in r["found"]["effects"]) for r in named]
    right = [word_of(r) == "right" for r in named]
    lines = ["| confidence | n | mean stated | right |", "|---|---|---|---|"]
    edges = (0.0, 0.5, 0.8, 0.9, 0.95, 0.99, 1.001)
    for low, high in itertools.pairwise(edges):
        mine = [k for k, c in enumerate(stated) if low <= c < high]
        if mine:
            mean = np.mean([stated[k] for k in mine])
            hits = sum(right[k] for k in mine)
            lines.append(
                f"| {low:g} to {min(high, 1.0):g} | {len(mine)} | {100 * mean:.1f} % | "
                f"{share_text(hits, len(mine))} |"
            )
    return lines


def trivial(sets: dict[str, list[Run]]) -> list[str]:
    """Score trivial strategies in the same terms."""
    lines = [
        "| set | jointbench right | jointbench wrong | always unknown | always cubic: "
        "right, wrong | largest reduction: right, wrong |",
        "|---|---|---|---|---|---|",
    ]
    for name, mine in sets.items():
        n = len(mine)
        if not n:
            continue
        good = {"nothing missing": "none"}.get(name, "right")
        if name.startswith(("taken", "outside")):
            good = "unknown"
        ours = sum(word_of(r) == good for r in mine)
        wrong = sum(word_of(r) == "wrong name" for r in mine)
        cubic = sum(
            r["truth"] == ["cubic_stiffness"] and r["kind"] == "single" for r in mine
        )
        biggest = sum(_biggest(r) == set(r["truth"]) and good == "right" for r in mine)
        doubt = "right" if good == "unknown" else "never right"
        lines.append(
            f"| {name} | {100 * ours / n:.0f} % | {100 * wrong / n:.1f} % | {doubt} | "
            f"{100 * cubic / n:.0f} %, {100 - 100 * cubic / n:.0f} % | "
            f"{100 * biggest / n:.0f} %, {100 - 100 * biggest / n:.0f} % |"
        )
    return lines


def _biggest(run: Run) -> set[str]:
    """Return the names of the explanation with the smallest residual."""
    tried = [c for c in run["found"].get("candidates", []) if c["effects"] != ["none"]]
    if not tried:
        return set()
    best = min(tried, key=lambda c: c["chi2_per_dof"])
    return {label.split("@")[0] for label in best["effects"]}


def failures(runs: Sequence[Run]) -> list[str]:
    """List every wrong name, wrong ambiguity, crash and lost clear case."""
    lines = [
        "| campaign | truth | margins | verdict | reason |",
        "|---|---|---|---|---|",
    ]
    for run in runs:
        word = word_of(run)
        lost = (
            run["kind"] == "single"
            and min(run["margins"]) >= NAMEABLE
            and word in {"unknown", "none"}
        )
        falsely = run["kind"] == "null" and word != "none"
        if word in {"wrong name", "crash", "ambiguous, wrong"} or lost or falsely:
            truth = " + ".join(run["truth"]) or "none"
            lines.append(
                f"| {run['kind']} {run['seed']} | {truth} | "
                f"{', '.join(f'{m:.3g}' for m in run['margins'])} | {word}: "
                f"{', '.join('@'.join(t) for t in named_by(run))} | "
                f"{run['found']['reason']} |"
            )
    return lines


def page(runs: list[Run], engine: str) -> str:
    """Return the whole page."""
    sets = sets_of(runs)
    parts = [
        ["# Gap engine on fresh simulated campaigns", ""],
        [
            "Made by `benchmarks/gap/campaigns.py`, `judge.py` and `page.py`. Counts "
            "with 95 % Wilson intervals in %; time is CPU time of one core of a "
            "machine that was also busy with other work.",
            f"Engine: {engine}." if engine else "",
            "",
        ],
        [*confusion(sets), ""],
        [f"Null test where nothing is missing: {null_test(runs)}.", ""],
        [f"Site of right names: {site_share(runs)}.", ""],
        [f"Gap on held-out records, right names: {shrinkage(runs)}.", ""],
        [
            "Prior deviation where only the priors show the effect: "
            f"{prior_deviations(runs)}.",
            "",
        ],
        ["## Verdict for each hidden effect", "", *matrix(runs), ""],
        ["## Parameters of right names", "", *coverage(runs), ""],
        [f"Stated sd over the Fisher bound, one parameter: {fisher(runs)}.", ""],
        [f"Force curves of hysteretic laws: {force_curves(runs)}.", ""],
        ["## Confidence", "", *reliability(runs), ""],
        ["## Comparison with trivial strategies", "", *trivial(sets), ""],
        ["## Wrong and missed verdicts", "", *failures(runs), ""],
    ]
    return "\n".join(line for part in parts for line in part)


def main() -> None:
    """Print the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("runs", type=Path)
    parser.add_argument("--engine", default="", help="which state was judged")
    arguments = parser.parse_args()
    lines = arguments.runs.read_text(encoding="utf-8").splitlines()
    sys.stdout.write(page([json.loads(line) for line in lines], arguments.engine))


if __name__ == "__main__":
    main()
