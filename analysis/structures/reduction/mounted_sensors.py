# SPDX-License-Identifier: MIT
"""Points and directions of mounted accelerometers and of hits."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.structures.matrices.structure import Structure, pick
from jointbench.analysis.structures.reduction.reduced_model import (
    ReducedModel,
    rows_of,
)


@dataclass(frozen=True, slots=True)
class MountedSensor:
    """A point and a direction: of an accelerometer, or of a hit.

    Attributes:
        name: of the channel or hit point.
        body: name of its body.
        position: [m].
        direction: along which it measures or strikes, of any length.
    """

    name: str
    body: str
    position: tuple[float, float, float]
    direction: tuple[float, float, float]


def sensor_rows(structure: Structure, sensors: Sequence[MountedSensor]) -> FloatArray:
    """Return the rows from the motion of the mesh to that of sensors.

    Args:
        structure: bodies and joints.
        sensors: points and directions.

    Returns:
        Shape (n_sensors, n_free) [-].

    Raises:
        BadData: a sensor is not on its body, or has no direction.
        UsageError: there is no such body.
    """
    rows = np.zeros((len(sensors), structure.size))
    for row, sensor in enumerate(sensors):
        direction = np.asarray(sensor.direction, float)
        length = float(np.linalg.norm(direction))
        if not length > 0:
            raise BadData(f"sensor {sensor.name!r} has no direction; write e.g. 0,0,1")
        motion = pick(structure, sensor.body, sensor.position)
        rows[row] = motion.T @ (direction / length)
    return rows


def readout(
    structure: Structure, model: ReducedModel, sensors: Sequence[MountedSensor]
) -> FloatArray:
    """Return the rows from reduced motion to that of sensors.

    Args:
        structure: of the reduced model.
        model: the reduced structure.
        sensors: points and directions.

    Returns:
        Shape (n_sensors, r) [-].
    """
    return rows_of(model, sensor_rows(structure, sensors))
