# SPDX-License-Identifier: MIT
"""Abaqus files without lines, surfaces and sets: solids are all that a body needs.

gmsh writes lines as T3D3 and surfaces as CPS6 beside the solids, and sets that name
them; meshio does not read these.
"""

from collections.abc import Iterable, Iterator
from pathlib import Path

_SETS = ("*ELSET", "*NSET")
_SOLID = "TYPE=C3D"


def copy_solids(path: Path, target: Path) -> None:
    """Copy nodes and solid elements of an Abaqus file.

    Args:
        path: of the file.
        target: to write; other keywords stay as they are.
    """
    with (
        path.open(encoding="utf-8", errors="replace") as source,
        target.open("w", encoding="utf-8") as copy,
    ):
        copy.writelines(_solids(source))


def _solids(lines: Iterable[str]) -> Iterator[str]:
    kept = True
    for line in lines:
        if line.startswith("**"):
            continue
        if line.startswith("*"):
            kept = _is_kept(line.upper().replace(" ", ""))
        if kept:
            yield line


def _is_kept(keyword: str) -> bool:
    name = keyword.partition(",")[0].strip()
    if name == "*ELEMENT":
        return _SOLID in keyword
    return name not in _SETS
