# SPDX-License-Identifier: MIT
"""``jointbench export-joint``: a measured joint for finite element programs."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.station.files.output_paths import make_folder, write_text
from jointbench.station.joint_files.calculix_run import (
    calculix_frequencies,
    require_calculix,
)
from jointbench.station.joint_files.export_files import (
    PROGRAMS,
    WrittenFile,
    write_joint,
)
from jointbench.station.joint_files.export_run import (
    JointExport,
    calculix_deck,
    calculix_model,
    export_joint,
    export_source,
    frequencies_with_its_mass,
)
from jointbench.station.joint_files.joint_drawing import write_joint_page
from jointbench.station.joint_files.joint_law import read_law
from jointbench.station.screen.page_parts import DataTable
from jointbench.station.screen.terminal import console, table, working

LARGEST_DIFFERENCE = 1e-4
"""Of natural frequencies in CalculiX from ours, relative: the files are the joint."""


@dataclass(frozen=True, slots=True)
class ExportRequest:
    """What is to be exported.

    Attributes:
        joint: name; None where the model has one only.
        state: label; None where there is one only.
        programs: of `PROGRAMS`, with commas between; None is all.
        pieces: ``"4,3"``; None is one for each patch.
        law: JSON of ``gap`` with a direction; None is a linear joint.
        check: whether CalculiX computes the whole model.
    """

    joint: str | None = None
    state: str | None = None
    programs: str | None = None
    pieces: str | None = None
    law: str | None = None
    check: bool = False


def run_export_joint(
    model: Path, identified: Path, folder: Path, request: ExportRequest
) -> bool:
    """Write a joint, read it back, show how well it is represented.

    Args:
        model: structure model (TOML).
        identified: JSON of ``identify``.
        folder: that takes the files.
        request: what is to be exported.

    Returns:
        Whether the files hold the joint: read back, and in CalculiX if asked for.

    Raises:
        UsageError: the request cannot be met.
    """
    programs, counts = _programs(request.programs), _counts(request.pieces)
    law = None if request.law is None else read_law(request.law)
    if request.check:
        require_calculix()
    make_folder(folder)
    with working("meshing, solving"):
        source = export_source(model, identified, request.state)
        joint = export_joint(source, request.joint, counts)
    with working("writing"):
        files = list(write_joint(folder, joint, programs, law))
        if request.check or "calculix" in programs:
            whole = calculix_model(source)
            deck = calculix_deck(source, whole)
            path = folder / "calculix-model.inp"
            write_text(path, deck)
            files.append(WrittenFile(path, "the whole model, to be run", None))
    found, own = None, joint.frequencies
    if request.check:
        with working("running CalculiX"):
            own = frequencies_with_its_mass(source, whole)
            found = _elastic(calculix_frequencies(deck), own)
    apart = None if found is None else _apart(found, own)
    checks = _frequencies(joint, apart)
    write_joint_page(folder / f"{joint.name}.html", joint, files, checks)
    _show(joint, files, apart)
    read_back = max(one.difference or 0.0 for one in files)
    return read_back < LARGEST_DIFFERENCE and (
        apart is None or float(np.abs(apart).max()) < LARGEST_DIFFERENCE
    )


def _programs(words: str | None) -> tuple[str, ...]:
    if words is None:
        return PROGRAMS
    chosen = tuple(one.strip() for one in words.split(","))
    for one in chosen:
        if one not in PROGRAMS:
            raise UsageError(f"--to: no program {one!r}; choose of {list(PROGRAMS)}")
    return chosen


def _counts(words: str | None) -> tuple[int, int] | None:
    if words is None:
        return None
    parts = words.split(",")
    if len(parts) != 2 or not all(one.strip().isdigit() and int(one) for one in parts):
        raise UsageError(
            f"--pieces is {words!r}; write the numbers along the two tangents, as 4,3"
        )
    return int(parts[0]), int(parts[1])


def _elastic(found: FloatArray, own: FloatArray) -> FloatArray:
    """Return the elastic frequencies: those from half of our lowest on."""
    return np.asarray(found[found > 0.5 * own[0]][: own.size])


def _apart(found: FloatArray, own: FloatArray) -> FloatArray:
    """Return relative differences; infinite where a frequency is missing."""
    whole = np.full(own.size, np.inf)
    whole[: found.size] = found / own[: found.size] - 1.0
    return whole


def _rows(joint: JointExport, apart: FloatArray | None) -> list[tuple[str, ...]]:
    rows = []
    for at, own in enumerate(joint.frequencies):
        row = [f"{own:.6g}", f"{100 * (joint.of_pieces[at] / own - 1):+.3f} %"]
        if apart is not None:
            row.append(f"{apart[at]:+.1e}" if np.isfinite(apart[at]) else "missing")
        rows.append(tuple(row))
    return rows


_COLUMNS = ("identified model [Hz]", "with pieces", "CalculiX, node by node")


def _frequencies(joint: JointExport, apart: FloatArray | None) -> DataTable:
    rows = tuple(_rows(joint, apart))
    caption = (
        "Natural frequencies of the identified model; change with the pieces in place "
        "of the distributed springs; difference of CalculiX with the nodes of the mesh."
    )
    return DataTable(caption, _COLUMNS[: 2 + (apart is not None)], rows)


def _show(
    joint: JointExport, files: list[WrittenFile], apart: FloatArray | None
) -> None:
    screen = console()
    rows = [
        (
            one.path.name,
            one.content,
            "-" if one.difference is None else f"{one.difference:.0e}",
        )
        for one in files
    ]
    title = f"Joint {joint.name} in {len(joint.pieces)} pieces"
    files_heads = ("file", "content", "read back")
    screen.print(table(title, files_heads, rows, words=frozenset({0, 1})))
    heads = _COLUMNS[: 2 + (apart is not None)]
    screen.print(table("Frequencies", heads, _rows(joint, apart), words=frozenset()))
    worst = float(np.abs(joint.of_pieces / joint.frequencies - 1.0).max())
    screen.print(
        f"The pieces change the frequencies by up to {100 * worst:.2g} %; more pieces "
        "(--pieces) bring this down. The files by nodes hold the joint exactly.",
        markup=False,
    )
    if apart is not None:
        screen.print(
            f"CalculiX: largest difference {float(np.abs(apart).max()):.1e} (with its "
            "rule for the mass of tet10, where there are any)",
            markup=False,
        )
