# SPDX-License-Identifier: MIT
"""The geometry file (TOML): where the measuring points sit, to draw shapes on.

lines = [["1", "2"]]

[points]
"1" = [0.0, 0.0, 0.0]     # metres
"2" = [0.1, 0.0, 0.0]

[directions]              # of channels or points; as recorded, else +z
"a2" = "-x"
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData
from jointbench.signal.modal.modal_model import ModalModel

_AXES = {"x": 0, "y": 1, "z": 2}


class Geometry(BaseModel):
    """Points [m], lines between them, and the direction each sensor looks in."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    points: dict[str, tuple[float, float, float]] = Field(min_length=1)
    lines: tuple[tuple[str, str], ...] = ()
    directions: dict[str, str] = Field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class DrawnShapes:
    """Shapes as they are drawn.

    Attributes:
        names: of the points.
        place: at rest [m, or steps where no geometry was given], shape (n_points, 3).
        motion: of each mode, its largest 1, shape (n_modes, n_points, 3).
        lines: pairs of indices of points.
        measured: True if a geometry was given.
    """

    names: tuple[str, ...]
    place: FloatArray
    motion: ComplexArray
    lines: tuple[tuple[int, int], ...]
    measured: bool

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
    names = tuple(dict.fromkeys(points)) if geometry is None else tuple(geometry.points)
    given = dict(directions or {}) | (geometry.directions if geometry else {})
    motion = np.zeros((values.shape[0], len(names), 3), complex)
    for column, (channel, point) in enumerate(zip(channels, points, strict=True)):
        axis, sign = _direction(given.get(channel) or given.get(point) or "+z")
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
