# SPDX-License-Identifier: MIT
"""Picture of a bolted structure with the sites that were named."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import takewhile
from pathlib import Path

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.gap.model.diagnosis_record import Diagnosis
from jointbench.station.drawing.palette import GUIDE, MEMBERS, MODEL
from jointbench.station.files.json_file import read_json
from jointbench.station.gap.label_sides import clear_sides
from jointbench.station.report.gap_sentences import place
from jointbench.station.screen.figures import Figure, axis, figure
from jointbench.station.screen.page_parts import Plot, Report, Section
from jointbench.station.screen.traces import Trace, line, markers

Place = tuple[float, float, float]
NAMED_COLOR = MODEL
"""As the bars of the model with the effect; the base model has the next color."""
_HEIGHT = 480
_TILT = np.array([[1.0, -0.45, 0.0], [0.0, 0.35, 1.0]])
"""Oblique view: x to the right, z up, y backwards to the left."""
_LOOK = {
    "bolts": ("circle", MEMBERS[0], "middle left"),
    "feet": ("square", MEMBERS[1], "middle right"),
    "hammer points": ("triangle-down", MEMBERS[2], "middle right"),
    "sensors": ("diamond", MEMBERS[3], "top center"),
}
"""Symbol, color and place of the name, of each kind of place."""
_PIXELS = np.array([900.0, 400.0])
"""Width and height of the picture in a window of common size."""
_ROOM = "   "
"""Keeps names clear of the ring around a named place."""
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
        bodies: names of the bodies.
        joints: bolts of each joint, where there are several.
    """

    names: tuple[str, ...]
    kinds: tuple[str, ...]
    positions: FloatArray
    boxes: FloatArray
    bodies: tuple[str, ...]
    joints: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

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
    return StructurePlan(
        names, kinds, 1e-3 * np.array(places), boxes, tuple(found.bodies)
    )


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
        joint = plan.joints.get(name, ()) if kind == "joint" else ()
        every = kind in ("bolts", "joint") and not joint
        wanted = {site, f"{kind}:{name}"}
        if kind == "point":
            _, _, bolt = name.partition(" bolt ")
            wanted |= {f"channel:{name}", f"bolt:{bolt}"}
            wanted |= {f"foot:{name.removeprefix('foot ')}"}
        for k, one in enumerate(plan.names):
            if one in wanted or one in joint or (every and one.startswith("bolt:")):
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
    caption = (
        "The structure in oblique view (x to the right, z up). Feet, and bolts without "
        "a name, count from 0, in the order of the nominal parameters."
    )
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
    traces = _edges(plan, sites)
    kinds = dict.fromkeys(plan.kinds)
    named_places = _named_places(plan)
    traces += [_places(named_places, kind) for kind in kinds]
    marked = marked_places(plan, sites)
    if marked:
        x, y = _flat(plan.positions[marked])
        named = markers(x, y, "named", color=NAMED_COLOR, symbol="circle-open")
        ring = {"color": NAMED_COLOR, "symbol": "circle-open", "size": 22}
        traces.append({**named, "marker": ring | {"line": {"width": 3}}})
    equal = axis("z and depth [mm]", scaleanchor="x")
    across = axis("x and depth [mm]")
    return figure(traces, across, equal, annotations=_body_names(plan))


def _flat(positions: FloatArray) -> FloatArray:
    """Return positions [m] in the oblique view [mm], shape (2, n_places)."""
    return np.asarray(1e3 * _TILT @ positions.T)


def _edges(plan: StructurePlan, sites: Sequence[str]) -> list[Trace]:
    """Return the edges of all bodies; a body that is named has thick ones."""
    traces = []
    for name, box in zip(plan.bodies, plan.boxes, strict=True):
        named = f"body:{name}" in sites
        color, width = (NAMED_COLOR, 3.0) if named else (GUIDE, 1.0)
        for edge in _EDGES:
            x, y = _flat(box[list(edge)])
            traces.append(line(x, y, "bodies", color=color, width=width, legend=False))
    return traces


@dataclass(frozen=True, slots=True)
class _Named:
    """A place in the picture [mm] with its name, and the side where that stands."""

    kind: str
    at: tuple[float, float]
    text: str
    side: str


def _named_places(plan: StructurePlan) -> list[_Named]:
    """Return all places, those of one kind and position as one."""
    shared: dict[tuple[str, Place], list[str]] = {}
    for name, kind, (x, y, z) in zip(
        plan.names, plan.kinds, plan.positions, strict=True
    ):
        shared.setdefault((kind, (x, y, z)), []).append(name)
    flat = _flat(np.array([at for _, at in shared]))
    texts = [_label(names) for names in shared.values()]
    preferred = [_LOOK[kind][2] for kind, _ in shared]
    corners = np.concatenate([flat, _flat(plan.boxes.reshape(-1, 3))], axis=1)
    pixel = float(np.max(np.ptp(corners, axis=1) / _PIXELS)) or 1.0
    sides = clear_sides(flat, texts, preferred, pixel)
    rows = zip(shared, flat.T.tolist(), texts, sides, strict=True)
    return [_Named(kind, (x, y), text, side) for (kind, _), (x, y), text, side in rows]


def _places(named: Sequence[_Named], kind: str) -> Trace:
    """Return all places of one kind with their names."""
    own = [one for one in named if one.kind == kind]
    symbol, color, _ = _LOOK[kind]
    x, y = np.array([one.at for one in own]).T
    return {
        **markers(x, y, kind, color=color, symbol=symbol, size=9),
        "mode": "markers+text",
        "text": [f"{_ROOM}{one.text}{_ROOM}" for one in own],
        "textposition": [one.side for one in own],
        "textfont": {"size": 11, "color": color},
        "cliponaxis": False,
    }


def _label(sites: Sequence[str]) -> str:
    """Return the name of a place, for example ``bolt 2``, or ``A1`` of A1x to A1z."""
    kinds, names = zip(*(site.split(":", 1) for site in sites), strict=True)
    if kinds[0] in ("bolt", "foot"):
        return f"{kinds[0]} {names[0]}"
    same = takewhile(lambda letters: len(set(letters)) == 1, zip(*names, strict=False))
    return "".join(one[0] for one in same).rstrip(" _-") or ", ".join(names)


def _body_names(plan: StructurePlan) -> list[dict[str, object]]:
    """Return the names of the bodies, each at the lower right of its front."""
    found: list[dict[str, object]] = []
    for name, box in zip(plan.bodies, plan.boxes, strict=True):
        (x,), (y,) = _flat(box[1:2]).round(1).tolist()
        place_of = {"x": x, "y": y, "xanchor": "right", "yanchor": "bottom"}
        font = {"size": 12, "color": GUIDE}
        found.append({"text": name, "showarrow": False, "font": font, **place_of})
    return found
