# SPDX-License-Identifier: MIT
"""Count verdicts of the surface bench on simulated surfaces, and write the page.

Usage: python benchmarks/gap/surface_score.py RUNS.jsonl [--count 240] [--first 50000]
           [--page docs/gap-surface-confusion.md]

One JSON line for each surface; seeds that are in the file are skipped, so that an
interrupted run can be continued. Effects take turns. A surface whose effect has an
expected margin below 50 is counted as made and not judged.
"""

import argparse
import json
import time
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from outcomes import NAMEABLE, share_text
from surface_maker import LINE_EFFECTS, MadeSurface, make_surface

from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.analysis.gap.law_diagnosis.surface_diagnosis import diagnose_surface
from jointbench.analysis.gap.law_diagnosis.surface_search import (
    fit_one_more,
    fit_surface,
)
from jointbench.analysis.gap.search.screening import screen
from jointbench.analysis.gap.search.selection_round import score
from jointbench.analysis.gap.surface_bench.predicted_structure import expected_rows
from jointbench.analysis.gap.surface_bench.surface_bench import make_surface_bench
from jointbench.analysis.gap.surface_bench.surface_rows import surface_rows

Run = dict[str, Any]
KINDS = ("", *LINE_EFFECTS)


@one_thread()
def margin(made: MadeSurface) -> float:
    """Return the expected margin of the truth over the best rival.

    The true effect is fitted; the rows are replaced by what that fit expects, and every
    other effect is fitted to them. The base alone is a rival. An effect that has the
    truth as a special case is none.
    """
    rows = surface_rows([made.surface])
    bench = make_surface_bench(rows)
    base = fit_surface(bench, (), np.zeros(2))
    tests = screen(bench, base, bench.candidates)
    truth = [c for c in bench.candidates if c.effect.name == made.truth]
    if not truth:
        return 0.0
    own = fit_one_more(bench, base, tests, truth[0])
    clean = replace(bench, rows=expected_rows(bench, own))
    base = fit_surface(clean, (), base.x)
    tests = screen(clean, base, bench.candidates)
    true = score(clean, fit_surface(clean, truth, own.x))
    found = base.cost - true
    for rival in tests.leaders(len(bench.candidates)):
        if rival is truth[0] or made.truth in rival.effect.generalises:
            continue
        found = min(found, score(clean, fit_one_more(clean, base, tests, rival)) - true)
        if found < NAMEABLE:
            break
    return float(found)


def run_one(seed: int) -> Run:
    """Return truth, margin and verdict of one seed."""
    made = make_surface(seed, KINDS[seed % len(KINDS)])
    run: Run = {"seed": seed, "truth": made.truth}
    if made.truth:
        run["margin"] = margin(made)
        if run["margin"] < NAMEABLE:
            return run
    start = time.process_time()
    done = diagnose_surface(made.surface)
    found = done.found
    run["found"] = {
        "verdict": found.verdict.value,
        "named": [
            sorted(label.split("@")[0] for label in one) for one in found.explanations
        ],
        "reason": found.reason,
        "gap": [found.gap_before.value, found.gap_after.value],
        "inside": done.after.share_inside,
        "seconds": time.process_time() - start,
    }
    return run


def word_of(run: Run) -> str:
    """Return the score of a verdict."""
    found, truth = run["found"], run["truth"]
    verdict, named = found["verdict"], found["named"]
    if not truth:
        return "right" if verdict == "none" else _wrong(verdict)
    if verdict in {"none", "unknown"}:
        return str(verdict)
    if verdict == "ambiguous":
        held = [truth] in named
        return "ambiguous, truth in it" if held else "ambiguous, wrong"
    if named and named[0] == [truth]:
        return "right"
    return "right and more" if truth in named[0] else "wrong name"


def _wrong(verdict: str) -> str:
    return "wrong name" if verdict in {"named", "mostly"} else verdict


def main() -> None:
    """Run the seeds that are missing, and write the page if asked."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("runs", type=Path)
    parser.add_argument("--count", type=int, default=0)
    parser.add_argument("--first", type=int, default=50_000)
    parser.add_argument("--page", type=Path)
    asked = parser.parse_args()
    lines = asked.runs.read_text().splitlines() if asked.runs.exists() else []
    runs = [json.loads(line) for line in lines]
    done = {run["seed"] for run in runs}
    with asked.runs.open("a", encoding="utf-8") as out:
        for seed in range(asked.first, asked.first + asked.count):
            if seed in done:
                continue
            runs.append(run_one(seed))
            out.write(json.dumps(runs[-1]) + "\n")
            out.flush()
    print("\n".join(tables(runs)))
    if asked.page:
        asked.page.write_text(page(runs), encoding="utf-8")


def tables(runs: list[Run]) -> list[str]:
    """Return the counts as Markdown."""
    judged = [r for r in runs if "found" in r]
    words = [word_of(r) for r in judged]
    total = Counter(words)
    n = len(judged)
    rows = [
        f"{n} surfaces judged of {len(runs)} made: right "
        f"{share_text(total['right'], n)}, wrong name "
        f"{share_text(total['wrong name'], n)}.",
        "",
        "| effect | made | judged | right | right and more | ambiguous, truth in it | "
        "unknown or none | wrong name or ambiguous, wrong |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for kind in KINDS:
        own = [w for r, w in zip(judged, words, strict=True) if r["truth"] == kind]
        made = sum(r["truth"] == kind for r in runs)
        count = Counter(own)
        open_ = count["unknown"] + (count["none"] if kind else count["ambiguous"])
        wrong = count["wrong name"] + count["ambiguous, wrong"]
        cells = [made, len(own), count["right"], count["right and more"]]
        cells += [count["ambiguous, truth in it"], open_, wrong]
        rows.append(f"| {kind or 'nothing'} | " + " | ".join(map(str, cells)) + " |")
    seconds = sorted(r["found"]["seconds"] for r in judged)
    shrunk = [
        1 - r["found"]["gap"][1] / r["found"]["gap"][0]
        for r, w in zip(judged, words, strict=True)
        if w == "right" and r["truth"] and r["found"]["gap"][0] > 0
    ]
    inside = [r["found"]["inside"] for r in judged]
    if judged:
        rows += [
            "",
            f"CPU time of a diagnosis: median {seconds[n // 2]:.1f} s, largest "
            f"{seconds[-1]:.1f} s. The gap on held-out waves falls by "
            f"{100 * float(np.median(shrunk)):.0f} % (median of the right names); "
            f"{100 * float(np.mean(inside)):.1f} % of the held-out bins are within "
            "their interval of 95 %.",
        ]
    return rows


def page(runs: list[Run]) -> str:
    """Return the page with the counts and the surfaces that are not right."""
    seeds = [r["seed"] for r in runs]
    others = [
        f"| {r['seed']} | {r['truth'] or 'nothing'} | {r.get('margin', 0):.0f} | "
        f"{word_of(r)} | "
        + (" or ".join("+".join(one) for one in r["found"]["named"]) or "-")
        + " |"
        for r in runs
        if "found" in r and word_of(r) != "right"
    ]
    return "\n".join(
        [
            "# How often the surface bench is right and wrong",
            "",
            "Made by `python benchmarks/gap/surface_score.py RUNS.jsonl --first "
            f"{min(seeds)} --count {len(seeds)} --page docs/gap-surface-confusion.md`.",
            "Lines of 3,000 to 7,000 points, H from 0.35 to 0.85, exact by their "
            "covariance or sums of relaxing steps; a ball rolls, a lens and a pixel "
            "average, a converter rounds, a nose leaves arcs, all on a grid four times "
            "as fine (`benchmarks/gap/surface_maker.py`). None of it is a spectrum of "
            "the estimator. An effect is judged if its expected margin over every "
            "rival that does not contain it is 50 or more.",
            "",
            *tables(runs),
            "",
            "Surfaces that are not right:",
            "",
            "| seed | truth | expected margin | score | named |",
            "|---|---|---|---|---|",
            *others,
            "",
        ]
    )


if __name__ == "__main__":
    main()
