# SPDX-License-Identifier: MIT
"""Score the gap engine on fresh campaigns of the simulators' own physics.

Usage: python benchmarks/gap/fresh.py --kind single --count 50 --seed 1000 >> runs.jsonl
       python benchmarks/gap/fresh.py --table runs.jsonl > docs/gap-confusion.md

Kinds: null, single, pair, hidden (one effect, taken out of the catalogue), outside (an
effect that no catalogue has). Half of the campaigns carry 0.1 to 0.2 % scatter from
hit to hit. One JSON line a campaign; the table gives counts with Wilson intervals.
"""

import argparse
import json
import sys
import tempfile
import time
from collections.abc import Iterator
from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np

from jointbench.analysis.gap.campaign import read_campaign
from jointbench.analysis.gap.diagnose import diagnose
from jointbench.analysis.gap.records import Diagnosis
from jointbench.simulators.campaign import Campaign, make_campaign
from jointbench.simulators.campaign_file import write_campaign
from jointbench.simulators.effect_draws import CATALOGUE, OUTSIDE_CATALOGUE

NAMEABLE = 50.0
Z95 = 1.96


def draw_effects(kind: str, rng: np.random.Generator) -> tuple[str, ...]:
    """Draw the names of what is hidden."""
    if kind == "null":
        return ()
    names = OUTSIDE_CATALOGUE if kind == "outside" else CATALOGUE
    count = 2 if kind == "pair" else 1
    return tuple(rng.choice(names, size=count, replace=False).tolist())


def run_one(kind: str, seed: int) -> dict[str, Any]:
    """Make a campaign, diagnose it and return the outcome."""
    rng = np.random.default_rng([seed, 7])
    effects = draw_effects(kind, rng)
    scatter = float(rng.uniform(1e-3, 2e-3)) if rng.random() < 0.5 else 0.0
    low = NAMEABLE if kind == "pair" else 1.0
    campaign = make_campaign(
        seed, effects=effects, margin=(low, 1e4), hit_scatter=scatter
    )
    without = frozenset(effects) if kind == "hidden" else frozenset()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "campaign.h5"
        write_campaign(campaign, path)
        start = time.process_time()
        try:
            found: Diagnosis | None = diagnose(read_campaign(path), without=without)
            failure = ""
        except Exception as error:  # noqa: BLE001 - a crash is an outcome to be counted
            found, failure = None, f"{type(error).__name__}: {error}"
        took = time.process_time() - start
    return outcome(kind, seed, campaign, scatter, found, took) | {"failure": failure}


def outcome(
    kind: str,
    seed: int,
    campaign: Campaign,
    scatter: float,
    found: Diagnosis | None,
    took: float,
) -> dict[str, Any]:
    """Return one campaign's outcome as plain data."""
    truth = [effect.name for effect in campaign.effects]
    told = [] if found is None else [effect.name for effect in found.effects]
    verdict = "crash" if found is None else found.verdict.value
    return {
        "kind": kind,
        "seed": seed,
        "truth": truth,
        "margins": [float(m.margin) for m in campaign.margins],
        "scatter": scatter,
        "verdict": verdict,
        "told": told,
        "sites": [] if found is None else [effect.site for effect in found.effects],
        "word": word_of(kind, set(truth), verdict, set(told)),
        "gap": [] if found is None else [found.gap_before.value, found.gap_after.value],
        "seconds": took,
    }


def word_of(kind: str, truth: set[str], verdict: str, told: set[str]) -> str:
    """Return what a verdict is worth."""
    if verdict in {"crash", "unknown"}:
        right = verdict == "unknown" and kind in {"hidden", "outside"}
        return "right" if right else verdict
    if verdict == "none":
        return "right" if kind == "null" else "silent"
    if verdict == "ambiguous":
        return "ambiguous, truth in it" if truth and truth <= told else "ambiguous"
    if kind == "pair" and told < truth:
        return "one of two"
    return "right" if told == truth and kind in {"single", "pair"} else "wrong name"


def wilson(hits: int, count: int) -> tuple[float, float]:
    """Return the 95 % Wilson interval of a share [%]."""
    share = hits / count
    centre = share + Z95**2 / (2 * count)
    half = Z95 * sqrt(share * (1 - share) / count + Z95**2 / (4 * count**2))
    scale = 100 / (1 + Z95**2 / count)
    return scale * (centre - half), scale * (centre + half)


def rows_of(runs: list[dict[str, Any]]) -> Iterator[tuple[str, list[dict[str, Any]]]]:
    """Split runs by kind, singles by whether they can be named."""
    for kind in ("null", "single", "pair", "hidden", "outside"):
        mine = [run for run in runs if run["kind"] == kind]
        if kind == "single":
            strong = [run for run in mine if min(run["margins"]) >= NAMEABLE]
            weak = [run for run in mine if min(run["margins"]) < NAMEABLE]
            yield "single, margin >= 50", strong
            yield "single, margin < 50", weak
        else:
            yield kind, mine


def table(runs: list[dict[str, Any]]) -> str:
    """Return the page: counts by outcome, and every wrong name."""
    words = sorted({run["word"] for run in runs})
    lines = [
        "# Gap engine on fresh simulated campaigns",
        "Made by `benchmarks/gap/fresh.py`; shares in % with 95 % Wilson intervals.",
        "",
        "| set | n | " + " | ".join(words) + " | median s | worst s |",
        "|---|---|" + "---|" * (len(words) + 2),
    ]
    for name, mine in rows_of(runs):
        if mine:
            cells = [_share(mine, word) for word in words]
            seconds = [run["seconds"] for run in mine]
            lines.append(
                f"| {name} | {len(mine)} | {' | '.join(cells)} | "
                f"{np.median(seconds):.1f} | {max(seconds):.1f} |"
            )
    lines += [
        "",
        "## What went wrong",
        "",
        "| seed | truth | margin | told |",
        "|---|---|---|---|",
    ]
    lines += [
        f"| {run['seed']} | {', '.join(run['truth']) or 'none'} | "
        f"{', '.join(f'{m:.3g}' for m in run['margins'])} | "
        f"{run['word']}: {', '.join(run['told']) or run['failure'] or '-'} |"
        for run in runs
        if run["word"] in {"wrong name", "crash", "ambiguous"}
    ]
    return "\n".join(lines) + "\n"


def _share(runs: list[dict[str, Any]], word: str) -> str:
    hits = sum(run["word"] == word for run in runs)
    low, high = wilson(hits, len(runs))
    return f"{hits} ({low:.0f} to {high:.0f})"


def main() -> None:
    """Run campaigns, or print the table of earlier runs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kind", default="single")
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1000)
    parser.add_argument("--table", type=Path)
    arguments = parser.parse_args()
    if arguments.table:
        lines = arguments.table.read_text(encoding="utf-8").splitlines()
        sys.stdout.write(table([json.loads(line) for line in lines]))
        return
    for seed in range(arguments.seed, arguments.seed + arguments.count):
        print(json.dumps(run_one(arguments.kind, seed)), flush=True)


if __name__ == "__main__":
    main()
