# SPDX-License-Identifier: MIT
"""Pressures over a surface that opens where nothing presses it."""

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.analysis.structures.pressure.interface_compliance import (
    InterfaceCompliance,
)
from jointbench.analysis.structures.pressure.interface_law import InterfaceLaw

TOLERANCE = 1e-6
"""Change of the forces in a step over their sum at which the search ends [-]."""
MOST_STEPS = 80
"""Steps after which it is given up [-]; 8 to 25 are usual."""
_SHRINK = 0.1
_GROW = 10.0


@dataclass(frozen=True, slots=True, eq=False)
class PressedSurface:
    """Pressures at the points of a joint.

    Attributes:
        pressure: 0 where the surfaces are apart [Pa], shape (n_points,).
        gap: between the surfaces where they are apart, else 0 [m], same shape.
        steps: of the search [-].
    """

    pressure: FloatArray
    gap: FloatArray
    steps: int

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "pressure", "gap")


def press(
    bodies: InterfaceCompliance,
    law: InterfaceLaw,
    area: FloatArray,
    loads: FloatArray,
    form: FloatArray,
    *,
    start: FloatArray | None = None,
) -> PressedSurface:
    """Solve the contact of two bodies with an interface between them.

    Without friction or adhesion: pressures are not below 0, and the approach of the
    surfaces is that of the law at the local pressure.

    Args:
        bodies: compliance of both at the surface.
        law: of the interface, per area.
        area: of each point [m^2], shape (n_points,); 0 within holes.
        loads: size of each load of `bodies`, shape (n_loads,).
        form: gap before anything presses [m], shape (n_points,).
        start: pressures to start from [Pa], shape (n_points,).

    Raises:
        BadData: nothing holds the surfaces together, or the search does not end.

    Source:
        Newton's method on p_i >= 0, w_i = approach(p_i), as Hueeber and Wohlmuth,
        Comput. Methods Appl. Mech. Eng. 194 (2005) 3147, with the law linearised at the
        pressure: there it is bent least.
    """
    free = bodies.loaded @ loads
    pressure = _first(bodies, free, form) if start is None else start
    floor = law.pressure[0]
    for step in range(1, MOST_STEPS + 1):
        moved = _motion(bodies, law, area, free, form, pressure)
        found = _linearised(law, pressure, moved)
        low = np.where(pressure > floor, _SHRINK * pressure, 0.0)
        high = _GROW * np.maximum(pressure, floor)
        new = np.clip(found, low, high)
        total = float(area @ new)
        if not total > 0:
            break
        change = float(area @ np.abs(new - pressure))
        pressure = new
        if change <= TOLERANCE * total:
            apart = np.where(pressure > 0, 0.0, np.maximum(-moved, 0.0))
            return PressedSurface(pressure, apart, step)
    else:
        raise BadData(
            f"the pressures did not settle in {MOST_STEPS} steps: the parts tip over, "
            "or the law is too steep; check loads, supports and the law's numbers"
        )
    raise BadData(
        "nothing holds the surfaces together: the loads separate them; check bolts "
        "and the direction of gravity"
    )


def _first(
    bodies: InterfaceCompliance, free: FloatArray, form: FloatArray
) -> FloatArray:
    """Return the pressures of the even springs where they are pressed."""
    moved = bodies.shapes @ free - form
    return np.asarray(np.maximum(bodies.springs * moved, 0.0))


def _linearised(
    law: InterfaceLaw, pressure: FloatArray, moved: FloatArray
) -> FloatArray:
    slope = law.stiffness(pressure)
    return np.asarray(pressure + slope * (moved - law.approach(pressure)))


def _motion(
    bodies: InterfaceCompliance,
    law: InterfaceLaw,
    area: FloatArray,
    free: FloatArray,
    form: FloatArray,
    pressure: FloatArray,
) -> FloatArray:
    """Return the approach at the points with the law straight at the pressures [m]."""
    pressed = pressure > 0
    slope = np.where(pressed, law.stiffness(pressure), 0.0)
    offset = np.where(pressed, pressure - slope * (form + law.approach(pressure)), 0.0)
    turned = Sparse(bodies.shapes.T @ sparse.diags_array(area))
    even = Sparse(turned @ sparse.diags_array(bodies.springs - slope) @ bodies.shapes)
    matrix = np.eye(free.size) - (even.T @ bodies.compliance).T
    right = free - bodies.compliance @ (turned @ offset)
    nodes = np.linalg.solve(matrix, right)
    return np.asarray(bodies.shapes @ nodes - form)
