# SPDX-License-Identifier: MIT
"""Ask the package index whether every dependency has a wheel on each system.

    python benchmarks/release/wheels.py --page docs/releases.md

Nothing is installed: for each system and version of Python, pip resolves what the
project needs and refuses sources. Each extra is resolved by itself, with the newest
version of Python; so are the dependencies of some systems only. The page gets the
tables between its marks; without `--page` they are printed. Run it with a Python that
has pip and packaging.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from packaging.requirements import Requirement

ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True, slots=True)
class System:
    """A system that wheels are asked for.

    Attributes:
        tags: of its wheels, the newest first.
        platform: `sys_platform` of its Python.
        machine: `platform_machine` of its Python.
    """

    tags: tuple[str, ...]
    platform: str
    machine: str

    def needs(self, wanted: str) -> bool:
        """Return whether a dependency is one here; pip asks where it runs itself."""
        marker = Requirement(wanted).marker
        here = {"sys_platform": self.platform, "platform_machine": self.machine}
        return marker is None or marker.evaluate(here)


def _linux(machine: str) -> System:
    tags = tuple(f"manylinux_2_{n}_{machine}" for n in (28, 27, 24, 17))
    return System(tags, "linux", machine)


SYSTEMS = {
    "Linux x86-64": _linux("x86_64"),
    "Linux arm64": _linux("aarch64"),
    "macOS arm64": System(
        ("macosx_14_0_arm64", "macosx_12_0_arm64", "macosx_11_0_arm64"),
        *("darwin", "arm64"),
    ),
    "Windows x86-64": System(("win_amd64",), "win32", "AMD64"),
}
PYTHONS = ("3.11", "3.12", "3.13")
PRODUCT = (
    *("archive", "cluster", "tdms", "mesh", "meshes", "pardiso", "surfaces"),
    *("readers", "screen", "site", "xarray"),
)
"""Extras of the product; the others are for its developers."""
BEGIN, END = "<!-- wheels -->\n", "<!-- end of wheels -->\n"


def resolve(system: System, python: str, wanted: list[str]) -> tuple[int, str]:
    """Return the number of wheels on a system, and the error of pip."""
    wanted = [one.partition(";")[0] for one in wanted if system.needs(one)]
    if not wanted:
        return 0, "none needed"
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.json"
        command = [sys.executable, "-m", "pip", "install", "--dry-run", "--quiet"]
        command += ["--ignore-installed", "--only-binary=:all:", "--target", folder]
        command += ["--report", str(report), "--python-version", python]
        command += [word for tag in system.tags for word in ("--platform", tag)]
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
    for name, system in SYSTEMS.items():
        found = [resolve(system, python, base) for python in PYTHONS]
        cells = " | ".join(words or str(count) for count, words in found)
        yield f"| {name} | {cells} |", any(words for _, words in found)
    yield from _apart(base)
    yield f"\nExtras, with Python {PYTHONS[-1]}:\n", False
    yield f"| extra | {' | '.join(SYSTEMS)} |", False
    yield "|---" * (len(SYSTEMS) + 1) + "|", False
    for extra in PRODUCT:
        wanted = project["optional-dependencies"][extra]
        found = [resolve(one, PYTHONS[-1], wanted) for one in SYSTEMS.values()]
        cells = " | ".join(words or str(count) for count, words in found)
        yield f"| `{extra}` | {cells} |", False


def _apart(base: list[str]) -> Iterator[tuple[str, bool]]:
    """Yield the table of dependencies that not every system needs."""
    yield f"\nDependencies of some systems only, with Python {PYTHONS[-1]}:\n", False
    yield f"| dependency | {' | '.join(SYSTEMS)} |", False
    yield "|---" * (len(SYSTEMS) + 1) + "|", False
    for one in base:
        if Requirement(one).marker is not None:
            found = [resolve(system, PYTHONS[-1], [one]) for system in SYSTEMS.values()]
            cells = " | ".join(words or str(count) for count, words in found)
            yield f"| `{Requirement(one).name}` | {cells} |", False


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
