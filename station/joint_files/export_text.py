# SPDX-License-Identifier: MIT
"""What was written of a joint, in words."""

import numpy as np

from jointbench.station.joint_files.exported_joint import ExportedJoint

FILE_COLUMNS = ("file", "content", "read back")
"""Of `file_rows`."""


def files_title(done: ExportedJoint) -> str:
    """Return the joint and the number of its pieces."""
    return f"Joint {done.joint.name} in {len(done.joint.pieces)} pieces"


def file_rows(done: ExportedJoint) -> list[tuple[str, ...]]:
    """Return a row for each file: name, content, largest difference read back."""
    return [
        (
            one.path.name,
            one.content,
            "-" if one.difference is None else f"{one.difference:.0e}",
        )
        for one in done.files
    ]


def remarks(done: ExportedJoint) -> list[str]:
    """Return what the pieces change, and how CalculiX compares, a line each."""
    joint, apart = done.joint, done.apart
    worst = float(np.abs(joint.of_pieces / joint.frequencies - 1.0).max())
    said = [
        f"The pieces change the frequencies by up to {100 * worst:.2g} %; more pieces "
        "(--pieces) bring this down. The files by nodes hold the joint exactly."
    ]
    if apart is not None:
        said.append(
            f"CalculiX: largest difference {float(np.abs(apart).max()):.1e} (with its "
            "rule for the mass of tet10, where there are any)"
        )
    return said
