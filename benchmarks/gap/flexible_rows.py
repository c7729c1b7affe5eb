# SPDX-License-Identifier: MIT
"""Fill all rows of the acceptance table of flexible bodies in turn.

Usage: python benchmarks/gap/flexible_rows.py FOLDER [--minutes 60] [--rows ROW ...]
    [--apart EFFECT ...]

Each campaign is made, examined by the command and appended to FOLDER/runs.jsonl; a
later call continues where the last one ended. Seeds whose effects are to be counted
apart are skipped, and so are seeds of which no draw stays finite. `flexible_page.py`
writes the page.
"""

import argparse
import itertools
import json
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from flexible_campaigns import hidden_names, make_one
from flexible_score import run_one

from jointbench.acquisition.basics.errors import UsageError

ROWS = {
    "null-exact": ("null", "exact", 481_210),
    "single-exact": ("single", "exact", 492_520),
    "null-life": ("null", "life", 503_200),
    "single-life": ("single", "life", 514_210),
    "hidden-exact": ("hidden", "exact", 495_210),
    "hidden-life": ("hidden", "life", 515_710),
    "pair-exact": ("pair", "exact", 496_210),
}
"""Kind of campaign, world and first seed of each row."""
TURNS = (
    *("null-exact", "single-exact", "single-exact", "null-life", "single-life"),
    *("hidden-exact", "single-exact", "null-exact", "single-life", "null-life"),
    *("pair-exact", "hidden-life"),
)
"""Order in which the rows grow."""
_FACTS = ("effects", "bad_hits", "physical", "kind", "where")
Json = dict[str, Any]


def counted(runs: Path) -> list[Json]:
    """Return the runs so far."""
    if not runs.exists():
        return []
    return [json.loads(line) for line in runs.read_text(encoding="utf-8").splitlines()]


def seeds(row: str, apart: frozenset[str]) -> Iterator[int]:
    """Yield the seeds of a row whose effects are not counted apart."""
    kind, _, first = ROWS[row]
    return (
        seed
        for seed in itertools.count(first)
        if apart.isdisjoint(hidden_names(kind, seed))
    )


def grow(folder: Path, turns: Sequence[str], apart: frozenset[str], end: float) -> None:
    """Examine one campaign after the other until a time.

    Args:
        folder: of campaigns and runs.
        turns: rows in the order in which they grow.
        apart: effects that are not counted here.
        end: time at which no further one begins, as `time.time` counts [s].
    """
    runs = folder / "runs.jsonl"
    done = {(run["row"], run["seed"]) for run in counted(runs)}
    following = {row: seeds(row, apart) for row in turns}
    while True:
        for row in turns:
            seed = next(s for s in following[row] if (row, s) not in done)
            if time.time() > end:
                return
            done.add((row, seed))
            try:
                run = _one(folder, row, seed)
            except UsageError as error:
                print(row, error, flush=True)
                continue
            with runs.open("a", encoding="utf-8") as out:
                out.write(json.dumps(run) + "\n")
            named = [e["name"] for e in run["found"]["effects"] or ()]
            print(row, run["seed"], run["names"], run["word"], named, flush=True)


def _one(folder: Path, row: str, seed: int) -> Json:
    """Make and examine one campaign; its hits are kept where the verdict is wrong."""
    kind, world, _ = ROWS[row]
    place = make_one(folder / row, seed, hidden_names(kind, seed), world)
    run = run_one(place, take_out=kind == "hidden")
    for effect in run["found"]["effects"] or ():
        effect.pop("evidence", None)
    truth = json.loads((place / "truth.json").read_text(encoding="utf-8"))
    if run["word"] == "right":
        (place / "hits.h5").unlink()
    return run | {
        "row": row,
        "seed": seed,
        "truth": {key: truth[key] for key in _FACTS},
    }


def main() -> None:
    """Grow the rows for some minutes."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--rows", nargs="*", choices=tuple(ROWS), default=())
    parser.add_argument("--apart", nargs="*", default=(), help="effects to skip")
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    end = time.time() + 60.0 * arguments.minutes
    turns = tuple(arguments.rows) or TURNS
    grow(arguments.folder, turns, frozenset(arguments.apart), end)


if __name__ == "__main__":
    main()
