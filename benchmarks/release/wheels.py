# SPDX-License-Identifier: MIT
"""Ask the package index whether every dependency has a wheel on each system.

    python benchmarks/release/wheels.py

Nothing is installed: pip resolves the dependencies of the project for a system and
refuses sources.
"""

import json
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SYSTEMS = {
    "Linux x86-64": ("manylinux_2_28_x86_64", "manylinux_2_17_x86_64"),
    "macOS arm64": ("macosx_14_0_arm64", "macosx_11_0_arm64"),
    "Windows x86-64": ("win_amd64",),
}
PYTHON = "3.12"


def resolve(tags: tuple[str, ...], wanted: list[str]) -> tuple[list[str], str]:
    """Return the wheels of a system, or the error of pip."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.json"
        command = [sys.executable, "-m", "pip", "install", "--dry-run", "--quiet"]
        command += [
            "--ignore-installed",
            "--only-binary=:all:",
            "--report",
            str(report),
        ]
        command += ["--target", folder, "--python-version", PYTHON]
        command += [word for tag in tags for word in ("--platform", tag)]
        done = subprocess.run(
            [*command, *wanted], capture_output=True, text=True, check=False
        )
        if done.returncode:
            return [], done.stderr.strip().split("\n")[-1]
        found = json.loads(report.read_text())["install"]
    return [one["download_info"]["url"].rsplit("/", 1)[-1] for one in found], ""


def main() -> int:
    """Print a table; return 1 where a system lacks a wheel."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    print("| system | wheels | missing |\n|---|---|---|")
    failed = False
    for system, tags in SYSTEMS.items():
        found, words = resolve(tags, list(project["dependencies"]))
        failed = failed or not found
        print(f"| {system} | {len(found)} | {words or 'none'} |", flush=True)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
