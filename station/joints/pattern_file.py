# SPDX-License-Identifier: MIT
"""The table of points of a joint by its pressure: written, and read as a pattern."""

from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.structures.matrices.spring_pattern import SpringPattern

POINT_COLUMNS = (
    "tangent 1 [m]",
    "tangent 2 [m]",
    "area [m^2]",
    "pressure [Pa]",
    "gap [m]",
    "normal stiffness [N/m^3]",
    "tangential stiffness [N/m^3]",
    "normal damping [N s/m^3]",
)
_STIFFNESS = POINT_COLUMNS.index("normal stiffness [N/m^3]")


def points_text(columns: FloatArray) -> str:
    """Return points with a head line, one a line; shape (n, 8)."""
    rows = [",".join(f"{value:.6g}" for value in row) for row in columns]
    return "\n".join([",".join(POINT_COLUMNS), *rows]) + "\n"


def read_pattern(path: Path) -> SpringPattern:
    """Read how springs are spread over a joint.

    Raises:
        BadData: the file cannot be read, or is no table of points.
    """
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise BadData(f"pattern {path} cannot be read: {error}") from error
    if not lines or lines[0].split(",") != list(POINT_COLUMNS):
        raise BadData(
            f"pattern {path} is no table of points; write one with 'jointbench "
            "pressure MODEL --points FILE'"
        )
    try:
        table = np.array([[float(one) for one in row.split(",")] for row in lines[1:]])
        return SpringPattern(table[:, :2], table[:, _STIFFNESS])
    except (ValueError, IndexError, BadData) as error:
        raise BadData(f"pattern {path}: {error}") from error
