# SPDX-License-Identifier: MIT
"""A stand-in for the 2025 paper's grinder: seven bodies, six joints, base fixed.

Every dimension is assumed: the paper gives none.
"""

import numpy as np

from jointbench.analysis.structures.matrices.element_assembly import Material
from jointbench.analysis.structures.matrices.parts import Joint, Support, solid_body
from jointbench.analysis.structures.matrices.structure import (
    Structure,
    build_structure,
)
from jointbench.analysis.structures.meshes.mesh import box_mesh

MARBLE = Material(55e9, 0.25, 2600.0, 0.002)
STEEL = Material(200e9, 0.3, 7850.0, 0.001)
# Size [m], lowest corner [m], material, cells at scale 1.
BODIES = {
    "bed": ((1.6, 1.0, 0.40), (0.0, 0.0, 0.0), MARBLE, (8, 5, 2)),
    "table": ((0.6, 0.5, 0.10), (0.8, 0.25, 0.40), STEEL, (6, 5, 1)),
    "column": ((0.4, 0.8, 1.00), (0.1, 0.1, 0.40), MARBLE, (2, 4, 5)),
    "crossbeam": ((0.9, 0.4, 0.30), (0.5, 0.3, 1.00), MARBLE, (5, 2, 2)),
    "carrier": ((0.12, 0.3, 0.40), (1.4, 0.35, 0.90), STEEL, (1, 3, 4)),
    "spindle": ((0.16, 0.16, 0.36), (1.52, 0.42, 0.92), STEEL, (2, 2, 4)),
    "wheel": ((0.20, 0.20, 0.04), (1.50, 0.40, 0.88), STEEL, (3, 3, 1)),
}
JOINTS = (
    Joint("bed", ("column", "bed")),
    Joint("guide", ("table", "bed")),
    Joint("beam", ("crossbeam", "column")),
    Joint("slide", ("carrier", "crossbeam")),
    Joint("clamp", ("spindle", "carrier")),
    Joint("flange", ("wheel", "spindle")),
)
TOOL = ("wheel", (1.60, 0.50, 0.88))
"""Body and place of the tool: the middle of the wheel's lower face."""


def grinder(scale: float = 1.0) -> Structure:
    """Return the machine; `scale` multiplies the number of cells along each axis."""
    bodies = [
        solid_body(
            name,
            box_mesh(
                size,
                tuple(max(1, round(scale * one)) for one in cells),
                origin=corner,
            ),
            material,
        )
        for name, (size, corner, material, cells) in BODIES.items()
    ]
    return build_structure(bodies, JOINTS, supports=[Support("bed", "z-")])


PRINTED = {
    "bed": (8.762e9, 9.887e6, 1.615e5),
    "guide": (5.003e5, 8.977e7, 5.197e5),
}
"""Stiffness [N/m] of normal and tangents that the paper prints for two joints."""

PRINTED_DAMPERS = {
    "bed": (6.873e5, 6.000e5, 2.957e5),
    "guide": (5.753e5, 2.861e5, 2.719e5),
}
"""Damping [N s/m] that the paper prints for these."""


def printed_values() -> np.ndarray:
    """Return the printed bed values at all joints but the guide."""
    return np.array(
        [PRINTED["guide" if j.name == "guide" else "bed"] for j in JOINTS]
    ).ravel()
