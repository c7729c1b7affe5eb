# SPDX-License-Identifier: MIT
"""The geometry file: where the measuring points sit, to draw shapes on.

A universal file (data sets 15, 82, 164, 2411, 2412), or TOML:

lines = [["1", "2"]]

[points]
"1" = [0.0, 0.0, 0.0]     # metres
"2" = [0.1, 0.0, 0.0]

[directions]              # of channels or points; as recorded, else +z
"a2" = "-x"
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.formats.universal_geometry import (
    holds_geometry,
    read_universal_geometry,
)
from jointbench.signal.modal.modal_model import ModalModel
from jointbench.station.files.toml_file import read_toml

_AXES = {"x": 0, "y": 1, "z": 2}
_NODE = re.compile(r"(?:.*:)?(?P<node>\w+?):?(?P<way>[+-]r?[xyzXYZ])?")
_ROTATION = re.compile(r"[+-]?r[xyz]")


class Geometry(BaseModel):
    """Points, lines between them, and the direction each sensor looks in.

    `unit` is that of the points, for the axes of the drawing.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    points: dict[str, tuple[float, float, float]] = Field(min_length=1)
    lines: tuple[tuple[str, str], ...] = ()
    directions: dict[str, str] = Field(default_factory=dict)
    unit: str = "m"


UNIVERSAL_SUFFIXES = (".uff", ".unv")


def read_geometry(path: Path) -> Geometry:
    """Read points and lines from a universal file, or from TOML.

    Raises:
        BadData: the file breaks a rule, or holds no node.
    """
    if path.suffix.lower() not in UNIVERSAL_SUFFIXES:
        return read_toml(path, Geometry)
    found = read_universal_geometry(path)
    unit = "m" if found.units_stated else "unit not stated"
    return Geometry(points=found.points, lines=found.lines, unit=unit)


def geometry_beside_frfs(path: Path) -> Geometry | None:
    """Return the geometry that a universal file of FRFs holds as well, or None."""
    if path.suffix.lower() not in UNIVERSAL_SUFFIXES or not holds_geometry(path):
        return None
    return read_geometry(path)


@dataclass(frozen=True, slots=True, eq=False)
class DrawnShapes:
    """Shapes as they are drawn.

    Attributes:
        names: of the points.
        place: at rest [m, or steps where no geometry was given], shape (n_points, 3).
        motion: of each mode, its largest 1, shape (n_modes, n_points, 3).
        lines: pairs of indices of points.
        measured: True if a geometry was given.
        unit: of the places, where a geometry was given.
    """

    names: tuple[str, ...]
    place: FloatArray
    motion: ComplexArray
    lines: tuple[tuple[int, int], ...]
    measured: bool
    unit: str = "m"

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "place", "motion")


def draw_shapes(
    model: ModalModel,
    geometry: Geometry | None,
    directions: Mapping[str, str] | None = None,
) -> DrawnShapes:
    """Draw the shapes of a model on points.

    Where the hammer roved (more inputs than outputs) the shape is that of the inputs,
    by reciprocity. Without a geometry the points stand in a row, in order.

    Args:
        model: the modes.
        geometry: None for the row.
        directions: of channels by name, as recorded; the geometry's come first.

    Returns:
        Points that nothing was measured at stand still.

    Raises:
        BadData: a measured point or a line's end that the geometry does not have, or a
            direction that is none.
    """
    values, channels, points = _measured(model)
    ways: dict[str, str] = {}
    if geometry is not None:
        points, ways = _nodes(points, channels, geometry)
    names = tuple(dict.fromkeys(points)) if geometry is None else tuple(geometry.points)
    given = ways | dict(directions or {}) | (geometry.directions if geometry else {})
    motion = np.zeros((values.shape[0], len(names), 3), complex)
    for column, (channel, point) in enumerate(zip(channels, points, strict=True)):
        text = given.get(channel) or given.get(point) or "+z"
        if _ROTATION.fullmatch(text.strip().lower()):
            continue  # a rotation moves no point
        axis, sign = _direction(text)
        motion[:, _index(names, point), axis] += sign * values[:, column]
    largest = np.max(np.abs(motion), axis=(1, 2), keepdims=True)
    if geometry is None:
        place = np.array([(float(i), 0.0, 0.0) for i in range(len(names))])
        lines = tuple((i, i + 1) for i in range(len(names) - 1))
    else:
        place = np.array(list(geometry.points.values()))
        lines = tuple(
            (_index(names, one), _index(names, other)) for one, other in geometry.lines
        )
    return DrawnShapes(
        names,
        place,
        np.asarray(motion / np.where(largest > 0.0, largest, 1.0), np.complex128),
        lines,
        geometry is not None,
        "" if geometry is None else geometry.unit,
    )


def _measured(
    model: ModalModel,
) -> tuple[ComplexArray, tuple[str, ...], tuple[str, ...]]:
    """Return shapes, channels and points of the side with more degrees of freedom."""
    if len(model.inputs) > len(model.outputs):
        return model.participation, model.inputs, model.inputs
    parts = [label.rpartition("@") for label in model.outputs]
    channels = tuple(channel or label for channel, _, label in parts)
    points = tuple(point or channel for channel, _, point in parts)
    return model.shapes, channels, points


def _nodes(
    points: Sequence[str], channels: Sequence[str], geometry: Geometry
) -> tuple[tuple[str, ...], dict[str, str]]:
    """Return points as the geometry names them, and directions by channel.

    Files of FRFs name degrees of freedom, ``"12+z"`` or ``"plate:12:+Z"``: node 12.
    """
    found, ways = [], {}
    for channel, point in zip(channels, points, strict=True):
        match = _NODE.fullmatch(point)
        if point in geometry.points or match is None:
            found.append(point)
            continue
        known = match["node"] in geometry.points
        found.append(match["node"] if known else point)
        if known and match["way"]:
            ways[channel] = match["way"].lower()
    return tuple(found), ways


def _index(names: Sequence[str], point: str) -> int:
    if point not in names:
        raise BadData(
            f"the geometry has no point {point!r}; write it under [points], "
            f"'\"{point}\" = [x, y, z]' in metres"
        )
    return names.index(point)


def _direction(text: str) -> tuple[int, float]:
    """Return axis and sign of ``"+x"``, ``"-z"`` or ``"y"``."""
    axis = text.strip().lower()
    sign = -1.0 if axis.startswith("-") else 1.0
    if axis.lstrip("+-") not in _AXES:
        raise BadData(f"direction {text!r} is none; write +x, -x, +y, -y, +z or -z")
    return _AXES[axis.lstrip("+-")], sign
