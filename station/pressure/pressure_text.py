# SPDX-License-Identifier: MIT
"""A joint by its pressure on the terminal, as JSON and as a table of points."""

from typing import Any

import numpy as np

from jointbench.analysis.structures.pressure.joint_pressure import JointPressure
from jointbench.analysis.structures.pressure.pressure_totals import OPEN, QUANTITIES
from jointbench.station.joints.pattern_file import points_text
from jointbench.station.screen.value_text import engineering

COLUMNS = ("total", "by pressure", "95 % from", "to", "even pressure", "ratio")
_UNITS = ("N/m", "N/m", "N m/rad", "N m/rad", "N m/rad", "N s/m")
_CLOSED = 0.005
"""Share of open surface that is shown as none [-]."""
_FINE = 0.35
"""Element over the diameter of a head up to which the closed area is good to 2 % [-]:
docs/joint-pressure-numbers.md."""


def total_rows(found: JointPressure) -> list[tuple[str, ...]]:
    """Return a row for each total: value, interval, even assumption, ratio."""
    rows: list[tuple[str, ...]] = []
    for at, name in enumerate(QUANTITIES):
        if not found.totals[at] > 0:
            continue
        low, high = found.interval[at]
        rows.append(
            (
                f"{name.replace('_', ' ')} [{_UNITS[at]}]",
                f"{found.totals[at]:.4g}",
                f"{low:.3g}",
                f"{high:.3g}",
                f"{found.even[at]:.4g}",
                f"{found.totals[at] / found.even[at]:.3f}",
            )
        )
    return rows


def headline(found: JointPressure) -> str:
    """Return what presses, over which area, and how much of it is open."""
    largest = engineering(float(found.surface.pressure.max()), "Pa")
    part = f"{100 * found.opened:.1f} % of the surface is open"
    if found.opened < _CLOSED:
        part = "the whole surface is closed"
    return (
        f"{engineering(found.force, 'N')} on {1e6 * found.points.total:.4g} mm²: mean "
        f"{engineering(found.mean, 'Pa')}, largest {largest}; {part}"
    )


def pressure_lines(found: JointPressure) -> list[str]:
    """Return what the numbers mean, one line each."""
    lines = [headline(found), f"law: {found.law.source}"]
    if not found.totals[-1] > 0:
        lines.append("no damping: the law has no loss factor")
    parts = [
        f"{cause} {100 * float(value[0]):.2g} %"
        for cause, value in found.parts.items()
        if value[0] >= 0.5e-3
    ]
    if parts:
        lines.append("normal stiffness, standard deviation: " + ", ".join(parts))
    else:
        lines.append(
            "no interval: the model states no scatter of preloads, law or area"
        )
    if found.element_share > _FINE:
        lines.append(
            "coarse mesh: elements beside bolts are up to "
            f"{found.element_share:.2g} of a head; the open share needs a third, "
            "stiffness is less sensitive"
        )
    lines.append(
        f"open: below {100 * OPEN:g} % of the mean pressure; without friction; rocking "
        "and torsion about the centroid of the surface, rocking 1 about tangent 1; "
        "the bodies' own compliance is not in the totals"
    )
    return lines


def points_csv(found: JointPressure) -> str:
    """Return pressure, stiffness and damping at each point, with a head line."""
    pressure, law = found.surface.pressure, found.law
    pressed = pressure > 0
    parts = [
        np.where(pressed, one, 0.0)
        for one in (
            law.stiffness(pressure),
            law.other("tangential", pressure),
            law.other("damping", pressure),
        )
    ]
    table = np.column_stack(
        [found.points.place, found.points.area, pressure, found.surface.gap, *parts]
    )
    return points_text(table)


def pressure_json(found: JointPressure) -> dict[str, Any]:
    """Return a joint by its pressure as plain numbers and texts."""
    return {
        "force_N": found.force,
        "area_m2": found.points.total,
        "mean_pressure_Pa": found.mean,
        "largest_pressure_Pa": float(found.surface.pressure.max()),
        "open_share": found.opened,
        "element_over_head": found.element_share,
        "law": found.law.source,
        "totals": {
            name: {
                "value": float(found.totals[at]),
                "interval": found.interval[at].tolist(),
                "even_pressure": float(found.even[at]),
                "unit": _UNITS[at],
                "log_sd": {key: float(one[at]) for key, one in found.parts.items()},
            }
            for at, name in enumerate(QUANTITIES)
        },
        "centre_m": found.points.centre.tolist(),
        "points": int(found.points.area.size),
        "steps": found.surface.steps,
    }
