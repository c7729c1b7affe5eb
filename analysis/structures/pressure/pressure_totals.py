# SPDX-License-Identifier: MIT
"""Total stiffness and damping of a joint from those at its points."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.structures.meshes.elements import triangle_rule
from jointbench.analysis.structures.pressure.interface_law import InterfaceLaw

QUANTITIES = (
    "normal_stiffness",
    "tangential_stiffness",
    "rocking_1_stiffness",
    "rocking_2_stiffness",
    "torsion_stiffness",
    "normal_damping",
)
"""Totals in order: two in N/m, three in N m/rad, one in N s/m. Rocking 1 turns about
the first tangent. All about the centroid of the surface."""
OPEN = 0.01
"""A point is open below this share of the mean pressure over the surface [-]: laws that
decay towards 0 have no edge."""


@dataclass(frozen=True, slots=True, eq=False)
class SurfacePoints:
    """The points of a joint, by triangles in the order of `triangle_rule`.

    Attributes:
        place: along both tangents, global coordinates [m], shape (n, 2).
        area: of each [m^2], shape (n,).
    """

    place: FloatArray
    area: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "place", "area")

    @property
    def total(self) -> float:
        """Area of the surface without its holes [m^2]."""
        return float(self.area.sum())

    @property
    def centre(self) -> FloatArray:
        """Centroid [m], shape (2,)."""
        return np.asarray(self.area @ self.place / self.total)

    @property
    def corners(self) -> FloatArray:
        """Corners of the triangles [m], shape (n_triangles, 3, 2)."""
        rule = triangle_rule()[0]
        plane = np.column_stack([np.ones(rule.shape[0]), rule])
        unit = np.array([[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 1.0]])
        groups = self.place.reshape(-1, rule.shape[0], 2)
        return np.asarray(unit @ np.linalg.pinv(plane) @ groups)


def joint_totals(
    points: SurfacePoints, law: InterfaceLaw, pressure: FloatArray
) -> FloatArray:
    """Return `QUANTITIES` of a joint, shape (6,).

    Args:
        points: of the surface.
        law: per area.
        pressure: at the points [Pa], shape (n,).
    """
    pressed = pressure > 0
    normal = np.where(pressed, law.stiffness(pressure), 0.0) * points.area
    sliding = np.where(pressed, law.other("tangential", pressure), 0.0) * points.area
    damping = np.where(pressed, law.other("damping", pressure), 0.0) * points.area
    arm = (points.place - points.centre) ** 2
    return np.array(
        [
            normal.sum(),
            sliding.sum(),
            normal @ arm[:, 1],
            normal @ arm[:, 0],
            sliding @ arm.sum(axis=1),
            damping.sum(),
        ]
    )
