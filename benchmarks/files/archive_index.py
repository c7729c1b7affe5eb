# SPDX-License-Identifier: MIT
"""Table and trend of an archive of many results, from the index kept on writing.

    python benchmarks/files/archive_index.py --results 5000 > docs/reprocessing-index.md

Results are made from one processed example: each has its own session, date and
numbers in the index.
"""

import argparse
import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
from runs import load_words

import jointbench as jb
from jointbench.station.archive.results_index import INDEX_NAME, append_to_index

RUN = """
import contextlib, sys
from pathlib import Path
from jointbench.station.main import run
with contextlib.suppress(SystemExit):
    run()
waits = [p.read_text().split() for p in Path("/proc/self/task").glob("*/schedstat")]
print("WAITED", sum(int(wait[1]) for wait in waits) / 1e9, file=sys.stderr)
"""
"""The command, and how long its threads were ready and no processor was free [s]."""
FIRST = datetime(2015, 1, 5, tzinfo=UTC)
DRIFT = 1e-6
"""Relative change of every number in a day [-]."""


def make(folder: Path, count: int) -> None:
    """Make an archive with a folder a year and its index.

    The files are links to one result, which the command does not open: it opens only
    those that are not as the index states.
    """
    example = jb.example("archive", folder / "example")
    first = jb.process(example / "2025-01" / "20Nm.h5").stored
    rng = np.random.default_rng(1)
    for number in range(count):
        day = FIRST + timedelta(days=number)
        place = folder / "archive" / str(day.year)
        place.mkdir(parents=True, exist_ok=True)
        path = place / f"s{number}.default.results.h5"
        path.hardlink_to(first.path)
        values = tuple(
            replace(one, value=one.value * (1 + DRIFT * number) + sd * rng.normal())
            for one in first.quantities
            for sd in [0.0 if np.isnan(one.sd) else one.sd]
        )
        facts = {**first.facts, "recorded": day.isoformat(), "session": str(number)}
        own = replace(first, key=f"{number:064d}", facts=facts, quantities=values)
        append_to_index(path, own)


@dataclass(frozen=True, slots=True)
class Cost:
    """What the command took.

    Attributes:
        cpu: time on a processor [s].
        waited: time in which it was ready and no processor was free [s].
        wall: on the clock [s].
        memory: at its most [MB].
    """

    cpu: float
    waited: float
    wall: float
    memory: float


def table(folder: Path) -> Cost:
    """Return the cost of the command in a process of its own."""
    begun = time.perf_counter()
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    words = ["archive", str(folder / "archive"), "--out", str(folder / "all.csv")]
    command = [sys.executable, "-c", RUN, *words, "--trend", "day"]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    wall = time.perf_counter() - begun
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = (after.ru_utime + after.ru_stime) - (before.ru_utime + before.ru_stime)
    waited = float(done.stderr.split("WAITED")[1])
    return Cost(spent, waited, wall, after.ru_maxrss / 1024)


def main() -> None:
    """Print a page of figures."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--results", type=int, default=5000)
    count = parser.parse_args().results
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        make(folder, count)
        size = sum(p.stat().st_size for p in folder.rglob(INDEX_NAME)) / 1e6
        cost = table(folder)
    print("# Table and trend of an archive from its index\n")
    print(
        f"`jointbench archive FOLDER --out all.csv --trend day` on {count} made "
        f"results, made by `benchmarks/files/archive_index.py`; {load_words()}.\n"
    )
    print("| | seen | bar |\n|---|---|---|")
    print(f"| time on a processor | {cost.cpu:.1f} s | 20 s |")
    print(f"| time in which none was free | {cost.waited:.1f} s | |")
    left = cost.wall - cost.cpu - cost.waited
    print(f"| all else: files, waits between threads | {max(left, 0.0):.1f} s | |")
    print(f"| on the clock | {cost.wall:.1f} s | 20 s on a processor of its own |")
    print(f"| memory | {cost.memory:.0f} MB | 500 MB |")
    print(f"| size of the index | {size:.1f} MB | |")
    print(
        "\nThe command waits for no disk: it reads the index and the state of each "
        "file, and writes one table. The files are links to one result; it opens none."
    )


if __name__ == "__main__":
    main()
