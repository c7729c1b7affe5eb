# SPDX-License-Identifier: MIT
"""Picture of a bolted structure with the sites that were named."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.gap.model.diagnosis_record import Diagnosis
from jointbench.station.files.json_file import read_json
from jointbench.station.report.gap_sentences import place
from jointbench.station.screen.figures import Figure, axis, figure
from jointbench.station.screen.page_parts import Plot, Report, Section
from jointbench.station.screen.traces import GREY, PALETTE, Trace, line, markers

Place = tuple[float, float, float]
NAMED_COLOR = PALETTE[1]
_HEIGHT = 460
_TILT = np.array([[1.0, -0.45, 0.0], [0.0, 0.35, 1.0]])
"""Oblique view: x to the right, z up, y backwards to the left."""
_EDGES = [(a, a | bit) for a in range(8) for bit in (1, 2, 4) if not a & bit]


class _PlacePart(BaseModel):
    """A part of the nominal parameters; the picture uses what is there."""

    model_config = ConfigDict(extra="ignore", frozen=True)


class _At(_PlacePart):
    position_mm: Place
    name: str = ""


class _Body(_PlacePart):
    size_mm: Place
    corner_mm: Place


class _PlacesFile(_PlacePart):
    bolts_mm: tuple[Place, ...] = ()
    feet_mm: tuple[Place, ...] = ()
    hammer_points: dict[str, _At] = Field(default_factory=dict)
    sensors: tuple[_At, ...] = ()
    bodies: dict[str, _Body] = Field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class StructurePlan:
    """Where bolts, feet, hammer points and sensors are.

    Attributes:
        names: of the places as sites, for example ``bolt:2`` or ``point:P1``.
        kinds: bolts, feet, hammer points or sensors, of each place.
        positions: [m], shape (n_places, 3).
        boxes: corners of each body [m], shape (n_bodies, 8, 3).
    """

    names: tuple[str, ...]
    kinds: tuple[str, ...]
    positions: FloatArray
    boxes: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "positions", "boxes")


def read_plan(nominal: Path) -> StructurePlan | None:
    """Return the places that nominal parameters state; None if they state none.

    Args:
        nominal: file of nominal parameters, read before without complaint.
    """
    found = read_json(nominal, _PlacesFile)
    rows: list[tuple[str, str, Place]] = []
    rows += [(f"bolt:{k}", "bolts", at) for k, at in enumerate(found.bolts_mm)]
    rows += [(f"foot:{k}", "feet", at) for k, at in enumerate(found.feet_mm)]
    for name, point in found.hammer_points.items():
        rows.append((f"point:{name}", "hammer points", point.position_mm))
    rows += [(f"channel:{s.name}", "sensors", s.position_mm) for s in found.sensors]
    if not rows:
        return None
    names, kinds, places = zip(*rows, strict=True)
    corners = [_corners(body) for body in found.bodies.values()]
    boxes = 1e-3 * np.array(corners).reshape(-1, 8, 3)
    return StructurePlan(names, kinds, 1e-3 * np.array(places), boxes)


def _corners(body: _Body) -> list[list[float]]:
    low, size = body.corner_mm, body.size_mm
    return [[low[d] + size[d] * ((k >> d) & 1) for d in range(3)] for k in range(8)]


def marked_places(plan: StructurePlan, sites: Sequence[str]) -> list[int]:
    """Return the places that sites mark.

    Args:
        plan: of the structure.
        sites: as named, for example ``bolt:2``, ``bolts:all``, ``point:top bolt 1``.
    """
    found = []
    for site in sites:
        kind, _, name = site.partition(":")
        name = name.removesuffix(" normal")
        every = kind in ("bolts", "joint")
        wanted = {site, f"{kind}:{name}"}
        if kind == "point":
            *_, number = name.split(" ")
            wanted |= {f"channel:{name}"}
            wanted |= {f"bolt:{number}"} if " bolt " in name else set()
            wanted |= {f"foot:{number}"} if name.startswith("foot ") else set()
        for k, one in enumerate(plan.names):
            if one in wanted or (every and one.startswith("bolt:")):
                found.append(k)
    return sorted(set(found))


def with_structure(
    report: Report, plan: StructurePlan | None, found: Diagnosis
) -> Report:
    """Return a report with the picture of the structure before its other sections.

    Args:
        report: about the gap.
        plan: of the structure, or None: the report as it is.
        found: verdict with its effects.
    """
    if plan is None:
        return report
    return replace(report, sections=(structure_section(plan, found), *report.sections))


def structure_section(plan: StructurePlan, found: Diagnosis) -> Section:
    """Return the picture of the structure with the named sites marked.

    Args:
        plan: of the structure.
        found: verdict with its effects.
    """
    sites = [effect.site for effect in found.effects]
    caption = "The structure in oblique view (x to the right, z up)."
    if sites:
        named = ", ".join(
            f"{e.name.replace('_', ' ')} {place(e.site)}" for e in found.effects
        )
        caption += f" Marked: {named}."
    picture = Plot("plan", caption, structure_figure(plan, sites), _HEIGHT)
    return Section("structure", "Structure", (picture,))


def structure_figure(plan: StructurePlan, sites: Sequence[str]) -> Figure:
    """Return the picture.

    Args:
        plan: of the structure.
        sites: to be marked.
    """
    traces: list[Trace] = []
    for box in plan.boxes:
        for one, other in _EDGES:
            x, y = 1e3 * _TILT @ box[[one, other]].T
            traces.append(line(x, y, "bodies", color=GREY, width=1, legend=False))
    flat = 1e3 * plan.positions @ _TILT.T
    symbols = ("circle", "square", "triangle-down", "diamond")
    kinds = tuple(dict.fromkeys(plan.kinds))
    for kind, symbol, color in zip(kinds, symbols, PALETTE[2:], strict=False):
        own = [k for k, one in enumerate(plan.kinds) if one == kind]
        traces.append(
            markers(flat[own, 0], flat[own, 1], kind, color=color, symbol=symbol)
        )
    marked = marked_places(plan, sites)
    if marked:
        x, y = flat[marked].T
        traces.append(
            markers(x, y, "named", color=NAMED_COLOR, symbol="circle-open", size=20)
        )
    equal = axis("z and depth [mm]", scaleanchor="x")
    return figure(traces, axis("x and depth [mm]"), equal)
