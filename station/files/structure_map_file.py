# SPDX-License-Identifier: MIT
"""The structure function of a surface at all lags, as a CSV file."""

from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.surfaces import Surface
from jointbench.signal.surface.structure_map import StructureMap, structure_map


def write_structure_map(surface: Surface, path: Path) -> None:
    """Write lags and S of a profile or a map, a row each.

    Args:
        surface: treated as for its fit.
        path: of the file; columns are the lag along the rows, for maps the lag along
            the columns [um], and S [um^2]; without rows for lags at which no pair was
            measured.

    Raises:
        SurfaceTooSmall: too few measured points.
    """
    found = structure_map(surface)
    rows = _rows(found)
    names = ["lag_x [um]", "lag_y [um]", "S [um^2]"]
    if len(found.spacing) == 1:
        names.pop(1)
    known = rows[np.isfinite(rows[:, -1])]
    np.savetxt(
        path, known, fmt="%.9g", delimiter=",", header=",".join(names), comments=""
    )


def _rows(found: StructureMap) -> FloatArray:
    """Return lags and values in micrometres, shape (n, 2) or (n, 3)."""
    value = 1e12 * found.value
    if value.ndim == 1:
        lag = 1e6 * found.spacing[0] * np.arange(value.size)
        return np.column_stack([lag, value])
    middle = (value.shape[1] - 1) // 2
    across = 1e6 * found.spacing[1] * (np.arange(value.shape[1]) - middle)
    down = 1e6 * found.spacing[0] * np.arange(value.shape[0])
    grid = np.meshgrid(across, down)
    return np.column_stack([*(part.ravel() for part in grid), value.ravel()])
