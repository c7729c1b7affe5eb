"""The picture of a bolted structure marks the named sites."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from jointbench.station.gap.label_sides import clear_sides
from jointbench.station.gap.structure_plan import (
    NAMED_COLOR,
    StructurePlan,
    marked_places,
    read_plan,
    structure_figure,
)

NOMINAL = {
    "bolts_mm": [[60, 50, 50], [440, 50, 50]],
    "feet_mm": [[50, 50, 0]],
    "hammer_points": {"P1": {"position_mm": [90, 70, 100]}},
    "sensors": [{"name": f"A1{axis}", "position_mm": [30, 30, 100]} for axis in "xyz"],
    "bodies": {"top": {"size_mm": [500, 300, 50], "corner_mm": [0, 0, 50]}},
}


@pytest.fixture
def plan(tmp_path: Path) -> StructurePlan:
    """Return the plan of a file of nominal parameters."""
    path = tmp_path / "sheet.json"
    path.write_text(json.dumps(NOMINAL), encoding="utf-8")
    found = read_plan(path)
    assert found is not None
    return found


@pytest.mark.parametrize(
    ("site", "marked"),
    [
        ("bolt:1", ["bolt:1"]),
        ("bolts:all", ["bolt:0", "bolt:1"]),
        ("point:top bolt 0", ["bolt:0"]),
        ("point:foot 0", ["foot:0"]),
        ("point:P1 normal", ["point:P1"]),
        ("point:A1x", ["channel:A1x"]),
        ("channel:A1z", ["channel:A1z"]),
        ("body:top", []),
    ],
)
def test_a_site_marks_its_places(
    plan: StructurePlan, site: str, marked: list[str]
) -> None:
    """Bolts, feet, points and sensors are marked by the names of their sites."""
    assert [plan.names[k] for k in marked_places(plan, [site])] == marked


def test_the_picture_has_bodies_places_and_the_mark(plan: StructurePlan) -> None:
    """Twelve edges of the body, four kinds of places, and the named one."""
    picture: Any = structure_figure(plan, ["bolt:1"])
    names = [trace["name"] for trace in picture["data"]]
    assert names.count("bodies") == 12
    assert names[12:] == ["bolts", "feet", "hammer points", "sensors", "named"]


def test_places_are_named(plan: StructurePlan) -> None:
    """Every place has its name; the channels of a triaxial sensor share theirs."""
    picture: Any = structure_figure(plan, ["bolt:1"])
    names = [
        [text.strip() for text in trace["text"]]
        for trace in picture["data"]
        if "text" in trace
    ]
    assert names == [["bolt 0", "bolt 1"], ["foot 0"], ["P1"], ["A1"]]
    assert [one["text"] for one in picture["layout"]["annotations"]] == ["top"]


def test_names_of_places_beside_each_other_do_not_cover_each_other() -> None:
    """A sensor beside a foot: one name stands right, the other one elsewhere."""
    beside = np.array([[0.0, 12.0, 400.0], [0.0, 4.0, 0.0]])
    right = ["middle right"] * 3
    sides = clear_sides(beside, ["foot 1", "A5", "A6"], right, 1.0)
    assert sides == ["middle left", "middle right", "middle right"]


def test_a_named_body_has_thick_edges(plan: StructurePlan) -> None:
    """An effect on a body marks the edges of that body in the color of the name."""
    picture: Any = structure_figure(plan, ["body:top"])
    edges = [trace["line"] for trace in picture["data"] if trace["name"] == "bodies"]
    assert {(edge["color"], edge["width"]) for edge in edges} == {(NAMED_COLOR, 3.0)}


def test_nominal_parameters_without_places_have_no_picture(tmp_path: Path) -> None:
    """A file that states no place leads to no picture."""
    path = tmp_path / "sheet.json"
    path.write_text("{}", encoding="utf-8")
    assert read_plan(path) is None
