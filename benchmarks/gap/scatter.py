# SPDX-License-Identifier: MIT
"""Judge the gap engine on hits that scatter in ways it does not share.

Usage:
  python benchmarks/gap/scatter.py nulls RUNS.jsonl [--seed S] [--rounds N] [--way WAY]
  python benchmarks/gap/scatter.py singles RUNS.jsonl [--seed S] [--count 200]
  python benchmarks/gap/scatter.py both RUNS.jsonl [--seed S] [--rounds N] [--count 200]
  python benchmarks/gap/scatter.py page RUNS.jsonl --engine COMMIT

`nulls`: nothing is missing; each round judges one campaign of every cell (a way of
scatter at one size). `singles`: one effect with an expected margin of 50 or more over
that scatter, its rivals refitted; ways and sizes take turns. `both`: two campaigns
without an effect, then one with, in turns. One JSON line per campaign; what is in the
file is not run again. `page` prints docs/gap-scatter.md.
"""

import argparse
import itertools
import json
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from outcomes import share_text, word_of
from scattered_campaigns import SIZES, WAYS, scattered_null
from scattered_singles import LEAST_MARGIN, scattered_single

from jointbench.analysis.gap.diagnosis.diagnose import diagnose
from jointbench.analysis.gap.intake.read_campaign import read_campaign
from jointbench.analysis.gap.model.diagnosis_record import diagnosis_json
from jointbench.simulators.campaigns.campaign_records import SimulatedCampaign
from jointbench.simulators.campaigns.write_campaign import write_campaign

Run = dict[str, Any]
CORRELATED = ("wander",)
KEPT = ("verdict", "effects", "reason", "noise", "scatter")


def null_cells(
    seed: int, rounds: int, only: str | None = None
) -> Iterator[tuple[str, float, int]]:
    """Yield way, size and seed of each campaign without an effect."""
    for k in range(rounds):
        for i, way in enumerate(WAYS):
            for j, size in enumerate(SIZES):
                if only in {None, way}:
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
    campaign, truth = scattered_single(seed, way, size)
    facts: Run = {"kind": "single", "way": way, "size": size, "seed": seed}
    facts |= {"truth": [truth.effect.name], "sites": [truth.effect.site]}
    facts |= {"margins": [truth.margin.margin], "rival": truth.margin.rival}
    if campaign is None:
        return facts | {"found": {"verdict": "not made"}, "seconds": 0.0}
    return judged(campaign, facts)


def single_cells(seed: int, count: int) -> Iterator[tuple[str, float, int]]:
    """Yield way, size and seed of each campaign with one effect, in turns."""
    cells = [(way, size) for size in SIZES for way in WAYS]
    for k in range(count):
        way, size = cells[k % len(cells)]
        yield way, size, seed + k


def key_of(run: Run) -> tuple[str, str, float, int]:
    """Return what identifies a campaign."""
    return run["kind"], run["way"], run["size"], run["seed"]


def read_runs(path: Path) -> list[Run]:
    """Return the runs of a file; none if there is no file."""
    if not path.exists():
        return []
    return [json.loads(line) for line in path.read_text().splitlines()]


def page(runs: Sequence[Run], engine: str) -> str:
    """Return docs/gap-scatter.md."""
    nulls = [r for r in runs if r["kind"] == "null"]
    singles = [r for r in runs if r["kind"] == "single"]
    apart = [r for r in nulls if r["way"] not in CORRELATED]
    correlated = [r for r in nulls if r["way"] in CORRELATED]
    lines = [
        "# Gap engine on hits that scatter",
        "",
        "Made by `benchmarks/gap/scatter.py`. The hits scatter in ways and sizes that "
        "the engine does not share (`benchmarks/gap/scattered_campaigns.py`); counts "
        "with 95 % Wilson intervals in %.",
        f"Engine: {engine}.",
        "",
        "## Nothing missing",
        "",
        "| way | " + " | ".join(f"{100 * s:g} %" for s in SIZES) + " |",
        "|---|" + "---|" * len(SIZES),
    ]
    for way in WAYS:
        cells = []
        for size in SIZES:
            own = [r for r in nulls if (r["way"], r["size"]) == (way, size)]
            cells.append(f"{len([r for r in own if is_none(r)])}/{len(own)}")
        lines.append(f"| {way} | " + " | ".join(cells) + " |")
    lines += [
        "",
        f"Hits that do not depend on each other: none {_share(apart, is_none)}, a name "
        f"{_share(apart, is_named)}. Correlated hits ({', '.join(CORRELATED)}): none "
        f"{_share(correlated, is_none)}, a name {_share(correlated, is_named)}.",
        "",
        "## One effect, margin of 50 or more over that scatter",
        "",
        "| size | right | wrong name | n |",
        "|---|---|---|---|",
    ]
    good = [r for r in singles if min(r["margins"]) >= LEAST_MARGIN]
    for size in SIZES:
        own = [r for r in good if r["size"] == size]
        words = [word_of(r) for r in own]
        right, wrong = words.count("right"), words.count("wrong name")
        lines.append(f"| {100 * size:g} % | {right} | {wrong} | {len(own)} |")
    words = [word_of(r) for r in good]
    missed = len(singles) - len(good)
    lines += [
        "",
        f"Right: {share_text(words.count('right'), len(words))}; wrong name: "
        f"{share_text(words.count('wrong name'), len(words))}. {missed} more were not "
        "made: their effect does not reach that margin at the largest physical size.",
        "",
        "## Time",
        "",
        f"Nothing missing: {_times(nulls)}. One effect: {_times(good)}. CPU time of "
        "one core of a machine that was also busy with other work.",
        "",
        "## Other verdicts",
        "",
        "| kind | truth | way | size | seed | margin, rival | verdict | reason |",
        "|---|---|---|---|---|---|---|---|",
        *(_other(r) for r in [*nulls, *good] if not _expected(r)),
        "",
        "A margin is the squared distance of the records from the nearest rival, "
        "fitted with the base, over the number of parameters of the effect. Pairs with "
        "a margin below 50 are not counted "
        "([record](decisions/0160-margins-with-refitted-rivals-and-force-noise.md)).",
    ]
    return "\n".join([*lines, ""])


def is_none(run: Run) -> bool:
    """Return whether the verdict is none."""
    return bool(run["found"]["verdict"] == "none")


def is_named(run: Run) -> bool:
    """Return whether the verdict names an effect."""
    return run["found"]["verdict"] in {"named", "ambiguous"}


def _expected(run: Run) -> bool:
    return is_none(run) if run["kind"] == "null" else word_of(run) == "right"


def _share(runs: Sequence[Run], test: Callable[[Run], bool]) -> str:
    return share_text(len([r for r in runs if test(r)]), len(runs))


def _times(runs: Sequence[Run]) -> str:
    seconds = sorted(r["seconds"] for r in runs) or [0.0]
    return f"median {seconds[len(seconds) // 2]:.1f} s, worst {seconds[-1]:.1f} s"


def _other(run: Run) -> str:
    named = " or ".join(e["name"] for e in run["found"].get("effects", []))
    cells = (
        run["kind"],
        " ".join(run["truth"]) or "none",
        run["way"],
        f"{100 * run['size']:g} %",
        str(run["seed"]),
        f"{run['margins'][0]:.0f}, {run['rival']}" if run["margins"] else "",
        f"{run['found']['verdict']} {named}".strip(),
        run["found"]["reason"],
    )
    return f"| {' | '.join(cells)} |"


def main() -> None:
    """Run the benchmark, or print its page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=("nulls", "singles", "both", "page"))
    parser.add_argument("runs", type=Path)
    parser.add_argument("--seed", type=int, default=140000)
    parser.add_argument("--rounds", type=int, default=13)
    parser.add_argument("--way", choices=sorted(WAYS), help="nulls of this way alone")
    parser.add_argument("--engine", default="not stated", help="commit of the runs")
    parser.add_argument("--count", type=int, default=200)
    arguments = parser.parse_args()
    runs = read_runs(arguments.runs)
    if arguments.what == "page":
        sys.stdout.write(page(runs, arguments.engine))
        return
    done = {key_of(run) for run in runs}
    with arguments.runs.open("a", encoding="utf-8") as out:
        for kind, way, size, seed in cells_of(arguments):
            if (kind, way, size, seed) not in done:
                judge = judge_null if kind == "null" else judge_single
                out.write(json.dumps(judge(way, size, seed)) + "\n")
                out.flush()


def cells_of(arguments: argparse.Namespace) -> Iterator[tuple[str, str, float, int]]:
    """Yield kind, way, size and seed of each campaign that is asked for."""
    seed, what = arguments.seed, arguments.what
    nulls = null_cells(seed, arguments.rounds, arguments.way)
    # Seeds of nulls end before this one: 100 a round.
    singles = single_cells(seed + (100_000 if what == "both" else 0), arguments.count)
    left = [
        (("null", *cell) for cell in (nulls if what != "singles" else ())),
        (("single", *cell) for cell in (singles if what != "nulls" else ())),
    ]
    turns = itertools.cycle((left[0], left[0], left[1]))
    ended: set[int] = set()
    while len(ended) < len(left):
        one = next(turns)
        cell = next(one, None)
        if cell is None:
            ended.add(id(one))
        else:
            yield cell


if __name__ == "__main__":
    main()
