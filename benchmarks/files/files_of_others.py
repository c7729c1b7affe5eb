# SPDX-License-Identifier: MIT
"""Files of other programs: what jointbench reads of them, beside their own libraries.

    python benchmarks/files/files_of_others.py --pyuff FOLDER > docs/files-of-others.md

FOLDER holds the test files of pyuff (its repository, folder `data`). The other files
are made here: by pyuff, npTDMS, SDynPy, xarray and netCDF4, SciPy and h5py, and by the
documented layouts of Rattlesnake and Simcenter Testlab. Each is read by the library
that made it, and by jointbench; both results are compared value by value in SI units.
SDynPy is imported without its windows and meshes where these are not installed.
"""

import argparse
import io
import tempfile
from collections.abc import Callable
from contextlib import redirect_stdout
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import others_makers as makers
from others_makers import Made

from jointbench.acquisition.basics.errors import JointbenchError
from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
from jointbench.acquisition.formats.frfs.read_frfs import read_frfs
from jointbench.acquisition.formats.samples.sample_format import SampleOptions
from jointbench.acquisition.formats.universal_geometry import read_universal_geometry
from jointbench.acquisition.records.recordings import Recording
from jointbench.station.files.input_files import read_foreign
from jointbench.station.files.typed_values import parse_rate

ALLOWED = 2e-6
"""Relative to the peak: universal files print six digits of single precision."""


@dataclass(frozen=True, slots=True)
class Row:
    """One file: who made it, what it holds, and what became of it."""

    name: str
    writer: str
    holds: str
    outcome: str
    wrong: bool = False


def histories(made: Made) -> Row:
    """Compare time histories with those of the file's own library."""
    options = SampleOptions(made.columns, "1", made.full_scale, parse_rate(made.rate))
    try:
        read = read_foreign(made.path, options)
    except JointbenchError as error:
        return Row(*made.words, "refused: " + _reason(made, error), made.expected)
    found = [one for one in read if isinstance(one, Recording)]
    rows = [row for one in found for row in np.asarray(one.samples)]
    return _compared(made, rows, f"{len(found)} recordings" if len(found) > 1 else "")


def functions(made: Made) -> Row:
    """Compare FRFs with those of the file's own library."""
    try:
        read = read_frfs(made.path, FrfOptions(made.columns))
    except JointbenchError as error:
        return Row(*made.words, "refused: " + _reason(made, error), made.expected)
    if not read:
        return Row(*made.words, "not taken for FRFs", made.expected)
    return _compared(made, [one.response for one in read], "")


def geometry(made: Made) -> Row:
    """Compare nodes with those of the file's own library."""
    try:
        found = read_universal_geometry(made.path)
    except JointbenchError as error:
        return Row(*made.words, "refused: " + _reason(made, error), made.expected)
    places = [np.array(place) for place in found.points.values()]
    return _compared(made, places, f"{len(found.lines)} lines")


def _reason(made: Made, error: JointbenchError) -> str:
    return str(error).replace(str(made.path), made.path.name).replace("|", "/")


def _compared(made: Made, rows: list[np.ndarray], more: str) -> Row:
    if len(rows) != len(made.values):
        words = f"READ {len(rows)} functions, its library {len(made.values)}"
        return Row(*made.words, words, True)
    worst = 0.0
    for ours, theirs in zip(rows, made.values, strict=True):
        if ours.shape != theirs.shape:
            words = f"READ {ours.size} values, its library {theirs.size}"
            return Row(*made.words, words, True)
        scale = float(np.abs(theirs).max()) or 1.0
        worst = max(worst, float(np.abs(ours - theirs).max()) / scale)
    count = f"{len(rows)} of {len(made.values)}"
    words = f"read, {count}, largest difference {worst:.1g} of the peak"
    return Row(*made.words, words + (f"; {more}" if more else ""), worst > ALLOWED)


def main() -> None:
    """Print the page."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--pyuff", type=Path, required=True)
    options = parser.parse_args()
    kinds: dict[str, Callable[[Made], Row]] = {
        "histories": histories,
        "FRFs": functions,
        "nodes": geometry,
    }
    # pyuff prints some of what it reads.
    with tempfile.TemporaryDirectory() as folder, redirect_stdout(io.StringIO()):
        made = [*makers.pyuff_files(options.pyuff), *makers.all_made(Path(folder))]
        rows = [kinds[one.kind](one) for one in made]
    print(PAGE.format(files=len(rows)))
    print("| file | made by | holds | jointbench |")
    print("|---|---|---|---|")
    for row in rows:
        mark = "**NOT RIGHT** " if row.wrong else ""
        print(f"| `{row.name}` | {row.writer} | {row.holds} | {mark}{row.outcome} |")
    read = sum(row.outcome.startswith("read") for row in rows)
    wrong = sum(row.wrong for row in rows)
    refused = len(rows) - read
    print(f"\n{read} files read, {refused} refused, {wrong} read otherwise or refused")
    print("although they should be read.")


PAGE = """# Files of other programs

Generated by benchmarks/files/files_of_others.py; its docstring describes the files.
{files} files: each is read by the library that made it and by jointbench, and all
values are compared in SI units (limit 2e-6 of the peak: universal files print six
digits of single precision). A file without units is given the options that its
refusal names. How to import such files: [files.md](files.md).
"""


if __name__ == "__main__":
    main()
