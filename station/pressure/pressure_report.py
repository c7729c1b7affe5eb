# SPDX-License-Identifier: MIT
"""The report of a joint by its pressure: map with its open part, and totals."""

import numpy as np
from scipy.spatial import cKDTree

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.session import software_version
from jointbench.analysis.structures.pressure.joint_pressure import JointPressure
from jointbench.analysis.structures.pressure.pressure_totals import OPEN
from jointbench.station.pressure.pressure_text import (
    COLUMNS,
    headline,
    pressure_lines,
    total_rows,
)
from jointbench.station.screen.figures import axis, figure
from jointbench.station.screen.page_parts import (
    DataTable,
    Item,
    Plot,
    Report,
    Section,
    Text,
)
from jointbench.station.screen.traces import heatmap

_ACROSS = 100
"""Points of the longer side of the picture [-]."""


def pressure_report(found: JointPressure, name: str) -> Report:
    """Return the report of a joint by its pressure."""
    x, y, field = _map(found)
    shown = np.where(field < OPEN * found.mean, np.nan, field) / 1e6
    picture = Plot(
        "pressure",
        "Pressure over the joint, along its two tangents. Open parts are left blank.",
        figure(
            [heatmap(1e3 * x, 1e3 * y, shown, "MPa")],
            axis("tangent 1 [mm]"),
            axis("tangent 2 [mm]", scaleanchor="x"),
        ),
        height=560,
    )
    rows = DataTable("Totals of the joint", COLUMNS, tuple(total_rows(found)))
    items: list[Item] = [picture, rows, *map(Text, pressure_lines(found)[1:])]
    return Report(
        title=f"Joint by its pressure: {name}",
        lead=headline(found),
        software=f"{software_version()}: pressure",
        simulated=False,
        tiles=(),
        sections=(Section("pressure", "Pressure and stiffness", tuple(items)),),
    )


def _map(found: JointPressure) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return a grid over the surface with the pressure of the nearest point [Pa]."""
    place = found.points.place
    low, high = place.min(axis=0), place.max(axis=0)
    step = float((high - low).max()) / _ACROSS
    x, y = (np.arange(a + step / 2, b, step) for a, b in zip(low, high, strict=True))
    grid = np.stack(np.meshgrid(x, y), axis=-1)
    distance, nearest = cKDTree(place).query(grid)
    reach = np.sqrt(2) * step + 2 * np.sqrt(found.points.area.max())
    inside = (distance <= reach) & (found.points.area[nearest] > 0)
    return x, y, np.where(inside, found.surface.pressure[nearest], np.nan)
