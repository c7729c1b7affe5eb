"""CPU time and memory of every reader of foreign bytes, on costly files.

    python benchmarks/files/bounds.py > docs/files-bounds.md

A reader may take 10 s of CPU and 500 MB plus four times the file, interpreter and
libraries included. Each file is read in a process of its own, which the system ends
at six times that time; what is not read must be refused in one line.
"""

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from costly_files import FILES
from foreign_readers import READERS

from jointbench.acquisition.basics.errors import JointbenchError

CPU = 10.0
"""[s]"""
MEMORY = 500 * 10**6
"""Beside four times the file [bytes]."""
HANG = 60
"""CPU time at which the system ends a reader [s]."""


def read_one(reader: str, path: Path) -> dict[str, object]:
    """Read a file here and return what became of it and what it took."""
    resource.setrlimit(resource.RLIMIT_CPU, (HANG, HANG))
    resource.setrlimit(resource.RLIMIT_AS, (12 * 2**30, 12 * 2**30))
    begun = time.process_time()
    try:
        READERS[reader](path)
        outcome = "read"
    except JointbenchError as error:
        lines = str(error).splitlines()
        outcome = "refused" if len(lines) == 1 else "many lines"
    except BaseException as error:  # noqa: BLE001 - what is sought
        outcome = f"{type(error).__name__}: {error}"[:80]
    # The peak of this process: getrusage counts that of its parent before the start.
    status = Path("/proc/self/status").read_text(encoding="ascii")
    used = int(status.partition("VmHWM:")[2].split()[0]) * 1024
    below = resource.getrusage(resource.RUSAGE_CHILDREN)
    return {
        "told": outcome,
        "cpu": time.process_time() - begun + below.ru_utime + below.ru_stime,
        "memory": used + below.ru_maxrss * 1024,
    }


def measure(reader: str, path: Path) -> dict[str, object]:
    """Read a file in a process of its own."""
    words = [sys.executable, __file__, "--read", reader, str(path)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    try:
        return dict(json.loads(done.stdout.splitlines()[-1]))
    except (IndexError, ValueError):
        return {
            "outcome": f"ended by signal {-done.returncode}",
            "cpu": HANG,
            "memory": 0,
        }


def is_kept(found: dict[str, object], size: int) -> bool:
    """Return whether a reader met the bounds."""
    return (
        found["outcome"] in {"read", "refused"}
        and float(str(found["cpu"])) <= CPU
        and float(str(found["memory"])) <= MEMORY + 4 * size
    )


def main() -> int:
    """Print a page of figures."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--read", nargs=2)
    parser.add_argument("--scale", type=float, default=1.0, help="Of the files' size.")
    parser.add_argument("--only", default="", help="Part of the name of a file.")
    options = parser.parse_args()
    if options.read:
        print(json.dumps(read_one(options.read[0], Path(options.read[1]))))
        return 0
    print("# CPU time and memory of every reader\n")
    print(f"Bounds: {CPU:g} s of CPU, and 500 MB + 4 x the file, interpreter and")
    print("libraries included. The files are made as costly as possible.\n")
    print("| reader | file | MB | CPU s | memory MB | allowed MB | |")
    print("|---|---|---|---|---|---|---|")
    broken = 0
    for one in FILES:
        if options.only not in f"{one.reader} {one.words}":
            continue
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / one.name
            one.make(path, options.scale)
            size = path.stat().st_size
            found = measure(one.reader, path)
        kept = is_kept(found, size)
        broken += not kept
        print(
            f"| {one.reader} | {one.words} | {size / 1e6:.3g} | "
            f"{float(str(found['cpu'])):.1f} | {float(str(found['memory'])) / 1e6:.0f} "
            f"| {(MEMORY + 4 * size) / 1e6:.0f} | {found['outcome']}"
            f"{'' if kept else ' **NOT KEPT**'} |",
            flush=True,
        )
    print(f"\n{broken} of these readings exceeded a bound.")
    return int(broken > 0)


if __name__ == "__main__":
    sys.exit(main())
