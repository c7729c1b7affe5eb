# SPDX-License-Identifier: MIT
"""What the benchmarks of this folder share: runs of the command, and their results."""

import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np

CODE = "from jointbench.station.main import run; run()"
VOLATILE = {"created", "seconds"}
RECIPE = """\
[windows]
force_width = "3 ms"
"""


def command(*arguments: str) -> list[str]:
    """Return the command line that runs jointbench in this environment."""
    return [sys.executable, "-c", CODE, *arguments]


def environment() -> dict[str, str]:
    """Return the environment of a run: one thread a process."""
    return os.environ | {"OMP_NUM_THREADS": "1"}


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    """Run jointbench to its end."""
    return subprocess.run(
        command(*arguments),
        env=environment(),
        capture_output=True,
        text=True,
        check=False,
    )


def write_recipe(folder: Path) -> Path:
    """Write the recipe of these benchmarks."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "bench.toml"
    path.write_text(RECIPE, encoding="utf-8")
    return path


def content_digest(path: Path) -> str:
    """Return the SHA-256 of all that a result file holds, timestamps apart."""
    digest = hashlib.sha256()

    def add(name: str, item: h5py.Group | h5py.Dataset) -> None:
        digest.update(name.encode())
        for key in sorted(item.attrs):
            if key not in VOLATILE and key not in {"DIMENSION_LIST", "REFERENCE_LIST"}:
                digest.update(f"{key}={item.attrs[key]!r}".encode())
        if isinstance(item, h5py.Dataset):
            digest.update(np.ascontiguousarray(item[...]).tobytes())

    with h5py.File(path, "r") as file:
        add("/", file)
        file.visititems(add)
    return digest.hexdigest()


def contents(folder: Path) -> dict[str, str]:
    """Return the digest of every result below a folder, by its name."""
    return {
        str(path.relative_to(folder)): content_digest(path)
        for path in sorted(folder.rglob("*.results.h5"))
    }


def ledger_lines(path: Path) -> list[dict[str, object]]:
    """Return the lines of a ledger that are whole."""
    lines = []
    for text in path.read_text(encoding="utf-8").splitlines():
        try:
            lines.append(json.loads(text))
        except ValueError:
            continue
    return lines


def load_words() -> str:
    """Report the other load of the machine."""
    load = os.getloadavg()
    return (
        f"{os.cpu_count()} cores; load averages when it ended "
        f"{load[0]:.1f}, {load[1]:.1f}, {load[2]:.1f} (1, 5, 15 min)"
    )
