# SPDX-License-Identifier: MIT
"""``jointbench export-joint``: a measured joint for finite element programs."""

from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.station.joint_files.export_text import (
    FILE_COLUMNS,
    file_rows,
    files_title,
    remarks,
)
from jointbench.station.joint_files.exported_joint import (
    ExportedJoint,
    ExportRequest,
    exported_joint,
)
from jointbench.station.joints.state_values import read_identified
from jointbench.station.screen.terminal import console, table


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
        Whether the files hold the joint.

    Raises:
        UsageError: the request cannot be met.
    """
    done = exported_joint(model, read_identified(identified), folder, request)
    _show(done)
    return done.faithful


def parse_programs(words: str) -> tuple[str, ...]:
    """Return the programs in ``"table,ansys"``."""
    return tuple(one.strip() for one in words.split(","))


def parse_pieces(words: str) -> tuple[int, int]:
    """Return the numbers of pieces in ``"4,3"``.

    Raises:
        UsageError: these are no two numbers.
    """
    parts = words.split(",")
    if len(parts) != 2 or not all(one.strip().isdigit() and int(one) for one in parts):
        raise UsageError(
            f"--pieces is {words!r}; write the numbers along the two tangents, as 4,3"
        )
    return int(parts[0]), int(parts[1])


def _show(done: ExportedJoint) -> None:
    screen = console()
    files = file_rows(done)
    title = files_title(done)
    screen.print(table(title, FILE_COLUMNS, files, words=frozenset({0, 1})))
    heads, rows = done.frequency_columns, done.frequency_rows
    screen.print(table("Frequencies", heads, rows, words=frozenset()))
    for line in remarks(done):
        screen.print(line, markup=False)
