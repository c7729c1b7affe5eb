# SPDX-License-Identifier: MIT
"""Turn judged campaigns into a page: confusion, sites, parameters, gaps, confidence.

Usage: python benchmarks/gap/page.py RUNS.jsonl > docs/gap-confusion.md
"""

import argparse
import itertools
import json
import sys
from collections import Counter
from collections.abc import Callable, Sequence
from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np

NAMEABLE = 50.0
Z95 = 1.96
Run = dict[str, Any]
WORDS = (
    "right",
    "ambiguous, truth in it",
    "unknown",
    "none",
    "one of two",
    "ambiguous, wrong",
    "wrong name",
    "crash",
)


def told_by(run: Run) -> list[tuple[str, str]]:
    """Return names and sites of what was told."""
    return [(e["name"], e["site"]) for e in run["found"].get("effects", [])]


def word_of(run: Run) -> str:
    """Return what a verdict is worth: the exact names, or honest doubt."""
    verdict = run["found"]["verdict"]
    if verdict in {"crash", "unknown", "none"}:
        return str(verdict)
    truth, told = set(run["truth"]), {name for name, _ in told_by(run)}
    if verdict == "ambiguous":
        inside = bool(truth) and truth <= told and run["kind"] not in NOT_IN_CATALOGUE
        return "ambiguous, truth in it" if inside else "ambiguous, wrong"
    if run["kind"] in NOT_IN_CATALOGUE:
        return "wrong name"
    if run["kind"] == "pair" and told < truth:
        return "one of two"
    return "right" if told == truth else "wrong name"


NOT_IN_CATALOGUE = ("hidden", "outside")


def wilson(hits: int, count: int) -> tuple[float, float]:
    """Return the 95 % Wilson interval of a share [%]."""
    share = hits / count
    centre = share + Z95**2 / (2 * count)
    half = Z95 * sqrt(share * (1 - share) / count + Z95**2 / (4 * count**2))
    scale = 100 / (1 + Z95**2 / count)
    return scale * (centre - half), scale * (centre + half)


def share_text(hits: int, count: int) -> str:
    """Return a share with its interval, in words."""
    if count == 0:
        return "-"
    low, high = wilson(hits, count)
    return f"{100 * hits / count:.1f} % ({hits}/{count}; {low:.1f} to {high:.1f})"


def sets_of(runs: Sequence[Run]) -> dict[str, list[Run]]:
    """Split runs into the sets that have a bar of their own."""
    margins = [min(run["margins"], default=np.inf) for run in runs]
    kinds: dict[str, Callable[[Run, float], bool]] = {
        "nothing missing": lambda r, m: r["kind"] == "null",
        "one effect, margin >= 50": lambda r, m: (
            r["kind"] == "single" and m >= NAMEABLE
        ),
        "one effect, margin < 50": lambda r, m: r["kind"] == "single" and m < NAMEABLE,
        "two effects, margins >= 50": lambda r, m: (
            r["kind"] == "pair" and m >= NAMEABLE
        ),
        "two effects, a margin < 50": lambda r, m: r["kind"] == "pair" and m < NAMEABLE,
        "taken out, margin >= 50": lambda r, m: r["kind"] == "hidden" and m >= NAMEABLE,
        "taken out, margin < 50": lambda r, m: r["kind"] == "hidden" and m < NAMEABLE,
        "outside, margin >= 50": lambda r, m: r["kind"] == "outside" and m >= NAMEABLE,
        "outside, margin < 50": lambda r, m: r["kind"] == "outside" and m < NAMEABLE,
    }
    return {
        name: [r for r, m in zip(runs, margins, strict=True) if test(r, m)]
        for name, test in kinds.items()
    }


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
    """Return, effect by effect, what was told of a single hidden effect."""
    lines = ["| truth | n | told |", "|---|---|---|"]
    singles = [run for run in runs if run["kind"] == "single"]
    for name in sorted({run["truth"][0] for run in singles}):
        mine = [run for run in singles if run["truth"] == [name]]
        count = Counter(_answer(run) for run in mine)
        told = ", ".join(f"{answer} {n}" for answer, n in count.most_common())
        lines.append(f"| {name} | {len(mine)} | {told} |")
    return lines


def _answer(run: Run) -> str:
    if run["found"]["verdict"] == "named":
        return " + ".join(sorted({name for name, _ in told_by(run)}))
    return str(run["found"]["verdict"])


def right_singles(runs: Sequence[Run]) -> list[Run]:
    """Return the singles that were named right."""
    return [r for r in runs if r["kind"] == "single" and word_of(r) == "right"]


def site_share(runs: Sequence[Run]) -> str:
    """Return how often the site of a right name is right."""
    mine = [r for r in runs if r["kind"] in {"single", "pair"}]
    mine = [r for r in mine if word_of(r) == "right"]
    hits = sum(
        dict(told_by(r)) == dict(zip(r["truth"], r["sites"], strict=True)) for r in mine
    )
    return share_text(hits, len(mine))


FRICTION = ("jenkins", "iwan", "bouc_wen")


def coverage(runs: Sequence[Run]) -> list[str]:
    """Return, effect by effect, how often 2 sd hold the true parameters."""
    inside: dict[str, list[bool]] = {}
    for run in right_singles(runs):
        effect = run["found"]["effects"][0]
        if effect["name"] in FRICTION:
            continue
        for name, estimate in effect["parameters"].items():
            truth = run["parameters"][0].get(name)
            if truth is None or not np.isfinite(estimate["sd"]):
                continue
            off = abs(estimate["value"] - truth) / max(estimate["sd"], 1e-300)
            inside.setdefault(run["truth"][0], []).append(off <= 2.0)
    every = [x for row in inside.values() for x in row]
    lines = ["| effect | within 2 sd |", "|---|---|"]
    lines += [
        f"| {name} | {share_text(sum(row), len(row))} |"
        for name, row in sorted(inside.items())
    ]
    return [*lines, f"| all | {share_text(sum(every), len(every))} |"]


def force_curves(runs: Sequence[Run]) -> str:
    """Return how well the curves of hysteretic laws come out, where they were named.

    What a law takes off the elastic force on first loading, up to the largest motion
    of the joint, against the truth; the largest difference over the largest value.
    """
    errors = [
        error_of(run)
        for run in right_singles(runs)
        if run["found"]["effects"][0]["name"] in FRICTION
    ]
    if not errors:
        return "none was named"
    inside = sum(e <= 0.1 for e in errors)
    return (
        f"median error {100 * np.median(errors):.1f} %; within 10 %: "
        f"{share_text(inside, len(errors))}"
    )


def error_of(run: Run) -> float:
    """Return the error of one force curve [-]."""
    from jointbench.simulators.campaign_design import draw_design
    from jointbench.simulators.effect_draws import specimen_scales

    effect = run["found"]["effects"][0]
    told = {name: one["value"] for name, one in effect["parameters"].items()}
    travel = specimen_scales(draw_design(run["seed"])).elongation
    r = np.linspace(0.0, travel, 200)
    truth = softening(effect["name"], run["parameters"][0], r)
    error = np.abs(softening(effect["name"], told, r) - truth).max()
    return float(error / np.abs(truth).max())


def softening(name: str, p: dict[str, float], r: np.ndarray) -> np.ndarray:
    """Return elastic force less that of a hysteretic law on first loading [N]."""
    from jointbench.analysis.gap.slider_march import slider_tables

    if name == "iwan":
        edges = np.linspace(0, 1, int(p.get("sliders", 14)) + 1)
        power = p["chi"] + 2
        shares = np.diff(edges**power)
        centres = np.diff(edges ** (power + 1)) / shares * power / (power + 1)
        weights, slips = p["kt"] * shares, p["phimax"] * centres
    elif name == "jenkins":
        weights, slips = np.array([p["kt"]]), np.array([p["Fs"] / p["kt"]])
    else:
        yielding = p["zy"] / (p["b"] + p["g"]) ** (1 / p["n"])
        weights, slips = np.array([p["k"]]), np.array([yielding])
    tables, tops = slider_tables(1.0, 0.0, p.get("sharpness", p.get("n", 1.0)))
    grid = np.arange(tables.shape[1]) / tops[0]
    x = r[:, None] / slips
    force = np.interp(x, grid, tables[0], right=1.0) * slips
    return np.asarray(np.sum(weights * (r[:, None] - force), axis=1))


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
        f"limit, where the engine looks further, {share_text(far, len(tests))}"
    )


def shrinkage(runs: Sequence[Run]) -> str:
    """Return how much held-out gaps of 3 and more shrink under right names."""
    shrinks = [
        run["found"]["shrink"]
        for run in right_singles(runs)
        if run["found"]["gap_before"] >= 3.0
    ]
    if not shrinks:
        return "no gap of 3 or more"
    return (
        f"median {100 * np.median(shrinks):.1f} %, smallest {100 * min(shrinks):.1f} % "
        f"(n = {len(shrinks)})"
    )


def pulls(runs: Sequence[Run]) -> str:
    """Return pulls of effects that only the priors see, where they were > 5 sigma."""
    rows = []
    for run in right_singles(runs):
        if run["truth"][0] not in {"added_mass", "gain_error"}:
            continue
        both = run["found"]["pulls"].values()
        before = max(abs(p["before"]) for p in both)
        after = max(abs(p["after"]) for p in both)
        if before > 5:
            rows.append((before, after))
    if not rows:
        return "none was pulled more than 5 sigma"
    below = sum(after < 2 for _, after in rows)
    return (
        f"median {np.median([b for b, _ in rows]):.1f} to "
        f"{np.median([a for _, a in rows]):.2f} sigma; below 2 after: "
        f"{share_text(below, len(rows))}"
    )


def reliability(runs: Sequence[Run]) -> list[str]:
    """Return confidence against how often it was right, in bins."""
    named = [r for r in runs if r["found"]["verdict"] == "named"]
    told = [min(e["confidence"] for e in r["found"]["effects"]) for r in named]
    right = [word_of(r) == "right" for r in named]
    lines = ["| confidence | n | mean told | right |", "|---|---|---|---|"]
    edges = (0.0, 0.5, 0.8, 0.9, 0.95, 0.99, 1.001)
    for low, high in itertools.pairwise(edges):
        mine = [k for k, c in enumerate(told) if low <= c < high]
        if mine:
            mean = np.mean([told[k] for k in mine])
            hits = sum(right[k] for k in mine)
            lines.append(
                f"| {low:g} to {min(high, 1.0):g} | {len(mine)} | {100 * mean:.1f} % | "
                f"{share_text(hits, len(mine))} |"
            )
    return lines


def trivial(sets: dict[str, list[Run]]) -> list[str]:
    """Score answerers that do not think, in the same words."""
    lines = [
        "| set | ours right | ours wrong | always unknown | always cubic: right, "
        "wrong | biggest shrink: right, wrong |",
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
    """Return the names of the explanation with the smallest misfit."""
    tried = [c for c in run["found"].get("candidates", []) if c["effects"] != ["none"]]
    if not tried:
        return set()
    best = min(tried, key=lambda c: c["chi2_per_dof"])
    return {label.split("@")[0] for label in best["effects"]}


def failures(runs: Sequence[Run]) -> list[str]:
    """List every wrong name, wrong ambiguity, crash and lost clear case."""
    lines = ["| campaign | truth | margins | told | reason |", "|---|---|---|---|---|"]
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
                f"{', '.join('@'.join(t) for t in told_by(run))} | "
                f"{run['found']['reason']} |"
            )
    return lines


def page(runs: list[Run], engine: str) -> str:
    """Return the whole page."""
    sets = sets_of(runs)
    parts = [
        ["# Gap engine on fresh simulated campaigns", ""],
        [
            "Made by `benchmarks/gap/campaigns.py`, `judge.py` and `page.py`. Counts, "
            "with 95 % Wilson intervals in %; time is CPU time of one core, on a "
            "machine that was busy with other work as well.",
            f"Engine: {engine}." if engine else "",
            "",
        ],
        [*confusion(sets), ""],
        [f"Null test where nothing is missing: {null_test(runs)}.", ""],
        [f"Site of right names: {site_share(runs)}.", ""],
        [f"Gap on held-out records, right names: {shrinkage(runs)}.", ""],
        [f"Pull where only the priors see the effect: {pulls(runs)}.", ""],
        ["## What was told of each effect", "", *matrix(runs), ""],
        ["## Parameters of right names", "", *coverage(runs), ""],
        [f"Force curves of hysteretic laws: {force_curves(runs)}.", ""],
        ["## Confidence", "", *reliability(runs), ""],
        ["## Beside answerers that do not think", "", *trivial(sets), ""],
        ["## What went wrong", "", *failures(runs), ""],
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
