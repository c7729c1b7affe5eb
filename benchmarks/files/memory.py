# SPDX-License-Identifier: MIT
"""Memory of one process over many files.

    python benchmarks/files/memory.py --files 2000 > docs/reprocessing-memory.md

Small sessions (two hits of a second at 2048 Hz), each with noise of its own.
"""

import argparse
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from fuzz import recording
from runs import load_words

from jointbench.acquisition.records.session import new_session
from jointbench.acquisition.session_file.store import write_session
from jointbench.station.archive.process_file import State, Task, process_task
from jointbench.station.schemas.recipe import Recipe

WARM = 200
"""Files after which all is loaded that will be."""


def resident() -> float:
    """Return the memory of this process [MB]."""
    for line in Path("/proc/self/status").read_text(encoding="ascii").splitlines():
        if line.startswith("VmRSS"):
            return int(line.split()[1]) / 1024
    return float("nan")


def main() -> None:
    """Print a page of figures."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--files", type=int, default=2000)
    options = parser.parse_args()
    base, sizes, states = recording(), [], []
    with tempfile.TemporaryDirectory() as name:
        path, result = Path(name) / "s.h5", Path(name) / "s.results.h5"
        for number in range(options.files):
            rng = np.random.default_rng(number)
            noise = rng.normal(0.0, 1e-3, base.samples.shape)
            own = replace(base, samples=base.samples + noise)
            session = new_session(source="", simulated=True, recordings=[own])
            write_session(session, path, overwrite=True)
            states.append(process_task(Task(path, result), Recipe(name="m")).state)
            sizes.append(resident())
    late = np.array(sizes[WARM:])
    count = np.arange(late.size)
    slope = np.polyfit(count, late, 1)[0] if late.size > 1 else float("nan")
    print("# Memory of a worker\n")
    print(f"{options.files} files in one process without restart; {load_words()}.\n")
    print(f"- files done: {sum(state is State.DONE for state in states)}")
    places = [0, WARM, len(sizes) // 2, len(sizes) - 1]
    shown = ", ".join(f"{sizes[i]:.0f} MB after {i + 1}" for i in places)
    print(f"- resident: {shown}")
    print(f"- after the first {WARM}: {1e3 * slope:+.1f} kB per file (straight line),")
    print(f"  largest {late.max():.0f} MB, smallest {late.min():.0f} MB")
    print("- `reprocess` nevertheless replaces a worker after 500 files")


if __name__ == "__main__":
    main()
