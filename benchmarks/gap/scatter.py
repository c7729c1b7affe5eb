# SPDX-License-Identifier: MIT
"""Judge the gap engine on hits that scatter in ways it does not share.

Usage:
  python benchmarks/gap/scatter.py nulls RUNS.jsonl [--seed 140000] [--rounds 13]
  python benchmarks/gap/scatter.py singles RUNS.jsonl [--seed 141000] [--count 200]
  python benchmarks/gap/scatter.py page RUNS.jsonl

`nulls`: nothing is missing; each round judges one campaign of every cell (a way of
scatter at one size). `singles`: one effect with an expected margin of 50 or more over
that scatter; ways and sizes take turns. One JSON line per campaign; what is in the file
is not run again. `page` prints docs/gap-scatter.md.
"""

import argparse
import json
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from scattered_campaigns import SIZES, WAYS, Scatter, draw_scatter, scattered_null

from jointbench.analysis.gap.diagnosis.diagnose import diagnose
from jointbench.analysis.gap.intake.read_campaign import read_campaign
from jointbench.analysis.gap.model.diagnosis_record import diagnosis_json
from jointbench.simulators.campaigns.campaign_records import (
    SimulatedCampaign,
    make_campaign,
)
from jointbench.simulators.campaigns.write_campaign import write_campaign
from jointbench.simulators.hidden.effect_draws import CATALOGUE

Run = dict[str, Any]
CORRELATED = ("wander",)
KEPT = ("verdict", "effects", "reason", "noise", "scatter")


def null_cells(seed: int, rounds: int) -> Iterator[tuple[str, float, int]]:
    """Yield way, size and seed of each campaign without an effect."""
    for k in range(rounds):
        for i, way in enumerate(WAYS):
            for j, size in enumerate(SIZES):
                yield way, size, seed + 100 * k + 10 * i + j


def judged(campaign: SimulatedCampaign, facts: Run) -> Run:
    """Return the facts with the verdict of the engine and its CPU time."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "campaign.h5"
        write_campaign(campaign, path)
        measured = read_campaign(path)
    start = time.process_time()
    try:
        found = diagnosis_json(diagnose(measured))
    except Exception as error:  # noqa: BLE001 - a crash is an outcome to be counted
        found = {"verdict": "crash", "reason": f"{type(error).__name__}: {error}"}
    seconds = time.process_time() - start
    kept = {key: found[key] for key in KEPT if key in found}
    return facts | {"found": kept, "seconds": seconds, "noise": campaign.design.noise}


def judge_null(way: str, size: float, seed: int) -> Run:
    """Judge one campaign without an effect."""
    campaign, scatter = scattered_null(seed, way, size)
    facts: Run = {"kind": "null", "way": way, "size": size, "seed": seed}
    facts |= {"truth": [], "margins": [], "bad": list(scatter.bad)}
    return judged(campaign, facts)


def judge_single(way: str, size: float, seed: int) -> Run:
    """Judge one campaign with one effect over a scatter of its hits."""
    rng = np.random.default_rng([seed, 7])
    name = CATALOGUE[seed % len(CATALOGUE)]
    campaign = make_campaign(
        seed,
        effects=(name,),
        margin=(50.0, 1e4),
        hits=lambda count: drawn_hits(draw_scatter(way, size, count, rng)),
    )
    facts: Run = {"kind": "single", "way": way, "size": size, "seed": seed}
    facts |= {
        "truth": [name],
        "sites": [e.site for e in campaign.effects],
        "margins": [float(m.margin) for m in campaign.margins],
    }
    return judged(campaign, facts)


def drawn_hits(scatter: Scatter) -> Any:
    """Return a scatter of this benchmark for the simulator."""
    raise NotImplementedError(scatter)


def key_of(run: Run) -> tuple[str, str, float, int]:
    """Return what identifies a campaign."""
    return run["kind"], run["way"], run["size"], run["seed"]


def read_runs(path: Path) -> list[Run]:
    """Return the runs of a file; none if there is no file."""
    if not path.exists():
        return []
    return [json.loads(line) for line in path.read_text().splitlines()]


def main() -> None:
    """Run the benchmark, or print its page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=("nulls", "singles", "page"))
    parser.add_argument("runs", type=Path)
    parser.add_argument("--seed", type=int, default=140000)
    parser.add_argument("--rounds", type=int, default=13)
    parser.add_argument("--count", type=int, default=200)
    arguments = parser.parse_args()
    runs = read_runs(arguments.runs)
    done = {key_of(run) for run in runs}
    with arguments.runs.open("a", encoding="utf-8") as out:
        for way, size, seed in null_cells(arguments.seed, arguments.rounds):
            if ("null", way, size, seed) not in done:
                out.write(json.dumps(judge_null(way, size, seed)) + "\n")
                out.flush()


if __name__ == "__main__":
    main()
