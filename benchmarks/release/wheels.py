# SPDX-License-Identifier: MIT
"""Ask the package index whether every dependency has a wheel on each system.

    python benchmarks/release/wheels.py --page docs/releases.md

Nothing is installed: for each system and version of Python, pip resolves what the
project needs and refuses sources. Each extra is resolved by itself, with the newest
version of Python. The page gets the tables between its marks; without `--page` they
are printed. Run it with a Python that has pip.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SYSTEMS = {
    "Linux x86-64": tuple(f"manylinux_2_{n}_x86_64" for n in (28, 27, 24, 17)),
    "Linux arm64": tuple(f"manylinux_2_{n}_aarch64" for n in (28, 27, 24, 17)),
    "macOS arm64": ("macosx_14_0_arm64", "macosx_12_0_arm64", "macosx_11_0_arm64"),
    "Windows x86-64": ("win_amd64",),
}
PYTHONS = ("3.11", "3.12", "3.13")
PRODUCT = (
    *("archive", "cluster", "tdms", "mesh", "meshes", "pardiso", "surfaces"),
    *("readers", "screen", "site", "xarray"),
)
"""Extras of the product; the others are for its developers."""
BEGIN, END = "<!-- wheels -->\n", "<!-- end of wheels -->\n"


def resolve(tags: tuple[str, ...], python: str, wanted: list[str]) -> tuple[int, str]:
    """Return the number of wheels on a system, and the error of pip."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.json"
        command = [sys.executable, "-m", "pip", "install", "--dry-run", "--quiet"]
        command += ["--ignore-installed", "--only-binary=:all:", "--target", folder]
        command += ["--report", str(report), "--python-version", python]
        command += [word for tag in tags for word in ("--platform", tag)]
        done = subprocess.run(
            [*command, *wanted], capture_output=True, text=True, check=False
        )
        if done.returncode:
            lines = [x for x in done.stderr.split("\n") if x.startswith("ERROR")]
            words = lines[-1].removeprefix("ERROR: ") if lines else "pip failed"
            return 0, "none that fit" if "ResolutionImpossible" in words else words
        found = json.loads(report.read_text())["install"]
    names = [one["download_info"]["url"].rsplit("/", 1)[-1] for one in found]
    assert all(name.endswith(".whl") for name in names)
    return len(names), ""


def tables() -> Iterator[tuple[str, bool]]:
    """Yield the lines of the tables, and whether a wheel is missing there."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    yield f"Asked on {datetime.now(UTC):%Y-%m-%d}; numbers of wheels.\n", False
    yield f"| system | {' | '.join(f'Python {one}' for one in PYTHONS)} |", False
    yield "|---" * (len(PYTHONS) + 1) + "|", False
    base = list(project["dependencies"])
    for system, tags in SYSTEMS.items():
        found = [resolve(tags, python, base) for python in PYTHONS]
        cells = " | ".join(words or str(count) for count, words in found)
        yield f"| {system} | {cells} |", any(words for _, words in found)
    yield f"\nExtras, with Python {PYTHONS[-1]}:\n", False
    yield f"| extra | {' | '.join(SYSTEMS)} |", False
    yield "|---" * (len(SYSTEMS) + 1) + "|", False
    for extra in PRODUCT:
        wanted = project["optional-dependencies"][extra]
        found = [resolve(tags, PYTHONS[-1], wanted) for tags in SYSTEMS.values()]
        cells = " | ".join(words or str(count) for count, words in found)
        yield f"| `{extra}` | {cells} |", False


def main() -> int:
    """Print or write the tables; return 1 where a system lacks a wheel."""
    given = argparse.ArgumentParser()
    given.add_argument("--page", type=Path, default=None)
    page = given.parse_args().page
    lines = list(tables())
    text = "".join(f"{line}\n" for line, _ in lines)
    if page is None:
        print(text)
    else:
        before, rest = page.read_text("utf-8").split(BEGIN)
        after = rest.split(END)[1]
        page.write_text(f"{before}{BEGIN}{text}{END}{after}", encoding="utf-8")
    return int(any(missing for _, missing in lines))


if __name__ == "__main__":
    sys.exit(main())
