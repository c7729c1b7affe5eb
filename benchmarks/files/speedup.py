# SPDX-License-Identifier: MIT
"""Two workers beside one on the same archive, in turn, more than once.

    python benchmarks/files/speedup.py --archive FOLDER --files 200 --rounds 3

On a machine that does other work besides, the ratio of two runs is unreliable, so pairs
of runs alternate, and the load is reported.
"""

import argparse
import shutil
import statistics
import tempfile
from pathlib import Path

from kills import arguments, timed
from runs import load_words, write_recipe


def main() -> None:
    """Print a page of figures."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--archive", type=Path, required=True)
    parser.add_argument("--files", type=int, default=200)
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    seconds: dict[int, list[float]] = {1: [], 2: []}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        recipe = write_recipe(folder)
        some = sorted(options.archive.rglob("visit-????.h5"))[: options.files]
        (folder / "in").mkdir()
        for path in some:
            shutil.copy(path, folder / "in" / path.name)
        for number in range(options.rounds):
            for jobs in (1, 2):
                out = folder / f"out-{jobs}-{number}"
                taken, _ = timed(arguments(folder / "in", recipe, out, jobs))
                seconds[jobs].append(taken)
    ratios = [a / b for a, b in zip(seconds[1], seconds[2], strict=True)]
    print("# Two workers beside one\n")
    print(f"{len(some)} sessions, rounds in turn: {options.rounds}; {load_words()}.\n")
    for jobs in (1, 2):
        times = ", ".join(f"{t:.1f}" for t in seconds[jobs])
        print(f"- {jobs} worker(s): {times} s")
    shown = ", ".join(f"{ratio:.2f}" for ratio in ratios)
    print(f"- ratios: {shown}; median {statistics.median(ratios):.2f}")


if __name__ == "__main__":
    main()
