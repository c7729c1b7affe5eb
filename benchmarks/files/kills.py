# SPDX-License-Identifier: MIT
r"""Kill a run over an archive at random, call it again, compare with an unbroken one.

    python benchmarks/files/kills.py --sessions 2000 --poisoned 40 --kills 5 \
        > docs/reprocessing-kills.md

Kills are SIGKILL to the parent at random times; its workers see the line to it break
and leave. Results are compared by all they hold, timestamps apart.
"""

import argparse
import json
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from archive import POISONS, make_archive
from runs import command, contents, environment, ledger_lines, load_words, write_recipe


def arguments(archive: Path, recipe: Path, results: Path, jobs: int) -> list[str]:
    """Return the command line of a run."""
    return [
        *("reprocess", str(archive), "--recipe", str(recipe), "--jobs", str(jobs)),
        *("--results", str(results), "--stages-limit", "0"),
    ]


def timed(args: list[str]) -> tuple[float, int]:
    """Run to the end; return time and exit code."""
    begun = time.monotonic()
    done = subprocess.run(
        command(*args), env=environment(), capture_output=True, check=False
    )
    return time.monotonic() - begun, done.returncode


def killed(args: list[str], ledger: Path, stops: list[int], total: int) -> int:
    """Kill a run whenever its results have come to one of the counts."""
    kills = 0
    for stop in stops:
        process = subprocess.Popen(
            command(*args),
            env=environment(),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        while process.poll() is None and met(ledger) < stop:
            time.sleep(0.05)
        if process.poll() is None:
            process.send_signal(signal.SIGKILL)
            kills += 1
        process.wait()
        time.sleep(0.2)
    return kills


def met(ledger: Path) -> int:
    """Return how many files the ledger has a line for."""
    if not ledger.exists():
        return 0
    return len({str(line["file"]) for line in ledger_lines(ledger) if "file" in line})


def judge_quarantine(named: dict[str, str], ledger: Path) -> tuple[int, list[str]]:
    """Count the poisoned files that were refused for their true reason."""
    last = {str(x["file"]): x for x in ledger_lines(ledger) if x.get("kind") == "file"}
    wrong = []
    for path, kind in named.items():
        line = last.get(path, {})
        reason = str(line.get("reason", ""))
        if line.get("state") != "failed" or not any(
            word in reason for word in POISONS[kind][1]
        ):
            wrong.append(f"{kind}: {line.get('state')}: {reason}")
    failed = sum(line.get("state") == "failed" for line in last.values())
    if failed != len(named):
        wrong.append(f"{failed} files failed, {len(named)} were poisoned")
    return len(named) - len(wrong), wrong


def main() -> None:
    """Print a page of figures."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--sessions", type=int, default=2000)
    parser.add_argument("--poisoned", type=int, default=40)
    parser.add_argument("--kills", type=int, default=5)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--archive", type=Path, help="made before; else made again")
    options = parser.parse_args()
    draw = random.Random(options.seed)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        archive = (options.archive or folder / "archive").absolute()
        if options.archive is None:
            make_archive(archive, sessions=options.sessions, poisoned=options.poisoned)
        named = json.loads((archive / "poison.json").read_text(encoding="utf-8"))
        total = len(list(archive.rglob("visit-????.h5")))
        recipe = write_recipe(folder)
        whole, broken = folder / "whole", folder / "broken"
        seconds, code = timed(arguments(archive, recipe, whole, options.jobs))
        sys.stderr.write(f"unbroken: {seconds:.0f} s, exit code {code}\n")
        right, wrong = judge_quarantine(named, whole / "bench.ledger.jsonl")
        args = arguments(archive, recipe, broken, options.jobs)
        ledger = broken / "bench.ledger.jsonl"
        stops = sorted(draw.sample(range(1, total), options.kills))
        begun = time.monotonic()
        kills = killed(args, ledger, stops, total)
        rest, last_code = timed(args)
        together = time.monotonic() - begun
        first, second = contents(whole), contents(broken)
        same = sum(second.get(path) == digest for path, digest in first.items())
        lines = [x for x in ledger_lines(ledger) if x.get("kind") == "file"]
        done = Counter(str(x["file"]) for x in lines if x["state"] == "done")
        again, again_code = timed(args)
        left = list(broken.rglob("*.part"))
    print("# Reprocessing, killed and called again\n")
    print(f"{total} simulated sessions, {len(named)} of them poisoned in ten ways;")
    print(f"{options.jobs} workers; {load_words()}.\n")
    print(
        f"- unbroken run: {seconds:.0f} s, {total / seconds:.2f} files/s, exit {code}"
    )
    print(f"- poisoned files refused for their true reason: {right} of {len(named)}")
    for line in wrong:
        print(f"  - NOT: {line}")
    print(f"- kills (SIGKILL to the parent): {kills}, after {stops} files")
    print(f"- finished by calling again: exit {last_code}, {together:.0f} s in all,")
    print(f"  {rest:.0f} s of them after the last kill")
    print(f"- results equal to the unbroken run's: {same} of {len(first)}")
    print(f"- results that only one of the two has: {len(set(first) ^ set(second))}")
    print(f"- files done more than once: {sum(n > 1 for n in done.values())}")
    print(f"- half written files left: {len(left)}")
    print(f"- called once more with all done: {again:.1f} s, exit {again_code}")


if __name__ == "__main__":
    main()
