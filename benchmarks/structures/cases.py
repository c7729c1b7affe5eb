# SPDX-License-Identifier: MIT
"""Structures that the benchmarks of joint simulation share."""

from collections.abc import Sequence

import numpy as np

from jointbench.analysis.structures.matrices.element_assembly import Material
from jointbench.analysis.structures.matrices.parts import (
    Joint,
    PointMass,
    solid_body,
)
from jointbench.analysis.structures.matrices.structure import (
    Structure,
    build_structure,
)
from jointbench.analysis.structures.meshes.mesh import box_mesh
from jointbench.analysis.structures.reduction.mounted_sensors import MountedSensor
from jointbench.analysis.structures.reduction.predict_modes import JointValues

MARBLE = Material(youngs_modulus=55e9, poisson_ratio=0.25, density=2600.0)
PLATE = (0.5, 0.3, 0.05)
TRUTH = JointValues(np.array([6e8, 9e7, 2e8]), np.array([4e3, 1.5e3, 2e3]))
SENSORS = (
    MountedSensor("a1", "lower", (0.0, 0.0, 0.0), (0, 0, 1)),
    MountedSensor("a2", "lower", (0.5, 0.3, 0.0), (1, 0, 0)),
    MountedSensor("a3", "upper", (0.05, 0.05, 0.1), (0, 0, 1)),
    MountedSensor("a4", "upper", (0.5, 0.05, 0.1), (0, 1, 0)),
    MountedSensor("a5", "upper", (0.5, 0.3, 0.1), (1, 0, 0)),
    MountedSensor("a6", "upper", (0.25, 0.3, 0.1), (0, 0, 1)),
)
SENSOR_MASS = 0.0105
"""Of a triaxial accelerometer [kg]."""


def two_plates(
    cells: Sequence[int] = (10, 6, 2), *, sensor_mass: float = 0.0
) -> Structure:
    """Return two marble plates on each other, with sensors of some mass [kg]."""
    upper = box_mesh(PLATE, cells, origin=(0.0, 0.0, PLATE[2]))
    bodies = [
        solid_body("lower", box_mesh(PLATE, cells), MARBLE),
        solid_body("upper", upper, MARBLE),
    ]
    masses = [PointMass(s.body, s.position, sensor_mass) for s in SENSORS]
    joint = Joint("joint", ("lower", "upper"))
    return build_structure(bodies, [joint], masses=masses)
