# SPDX-License-Identifier: MIT
"""Vendor files through two readers: disagreements on the screen and in JSON."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from rich.console import Console

from jointbench.acquisition.formats.heights.reader_comparison import (
    ReaderComparison,
    compare_readers,
)
from jointbench.acquisition.formats.heights.vendor_binaries import is_vendor_name


def shown_readers(
    files: Sequence[Path], asked: bool, screen: Console
) -> dict[Path, dict[str, object]]:
    """Compare the readers of vendor files, and print what they disagree in.

    It is printed before the files are read: a wrong scale may refuse a file.

    Args:
        files: given on the command line.
        asked: whether standard parameters are asked for.
        screen: to print on.

    Returns:
        For each vendor file the key ``readers`` of its JSON.
    """
    found: dict[Path, dict[str, object]] = {}
    for path in files:
        if asked and is_vendor_name(path) and path.is_file():
            one = compare_readers(path)
            for line in reader_lines(one):
                screen.print(f"  {path.name}: {line}", markup=False)
            found[path] = {"readers": asdict(one)}
    return found


def reader_lines(found: ReaderComparison) -> tuple[str, ...]:
    """Return what two readers make of a file."""
    if not found.compared:
        return (f"one reader only, nothing to compare: {found.reason}",)
    if not found.disagreements:
        return ("SurfaceTopography and surfalize agree in pitch, heights and gaps",)
    return tuple(f"the readers disagree: {one}" for one in found.disagreements)
