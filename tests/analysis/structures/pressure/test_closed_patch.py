"""The closed part of a surface: its edge lies within elements, not between points."""

import numpy as np
import pytest

from jointbench.analysis.structures.meshes.elements import triangle_rule
from jointbench.analysis.structures.pressure.closed_patch import (
    open_share,
    share_above_zero,
)
from jointbench.analysis.structures.pressure.interface_law import PowerInterface
from jointbench.analysis.structures.pressure.pressed_surface import PressedSurface
from jointbench.analysis.structures.pressure.pressure_totals import (
    OPEN,
    SurfacePoints,
)

LAW = PowerInterface(1e13, 1e6, 0.5, 0.8, 0.0, 100.0, 0.0).law(np.geomspace(1, 1e9, 40))


def square(cells: int) -> SurfacePoints:
    """A unit square of cells, two triangles each."""
    rule, weight = triangle_rule()
    place, area = [], []
    step = 1.0 / cells
    for i in range(cells):
        for j in range(cells):
            low = np.array([i, j]) * step
            place += [low + step * rule, low + step * (1 - rule)]
            area += [weight * step**2] * 2
    return SurfacePoints(np.concatenate(place), np.concatenate(area))


def patch(points: SurfacePoints, radius: float) -> float:
    """Return the open share if the approach crosses the level on a circle."""
    reach = ((points.place - 0.5) ** 2).sum(axis=1)
    bump = 1e-6 * (radius**2 - reach)
    level = 0.0
    # The level is 1 % of the mean pressure, which depends on where it is.
    for _ in range(60):
        approach = bump + level
        pressure = np.interp(approach, LAW.approach(GRID), GRID, left=0.0) * (
            approach > 0
        )
        mean = float(points.area @ pressure) / points.total
        level = float(LAW.approach(np.array(OPEN * mean)))
    gap = np.where(pressure > 0, 0.0, np.maximum(-approach, 0.0))
    return open_share(points, LAW, PressedSurface(pressure, gap, 1))


GRID = np.concatenate([[0.0], np.geomspace(1e-3, 1e9, 4000)])


def test_a_plane_cuts_a_triangle_where_it_is_zero() -> None:
    """Nothing, everything, one corner of a quarter of the area, and the rest."""
    values = np.array(
        [[-1.0, -2.0, -1.0], [0.0, 1.0, 2.0], [1.0, -1.0, -1.0], [-1.0, 1.0, 1.0]]
    )
    np.testing.assert_allclose(share_above_zero(values), [0.0, 1.0, 0.25, 0.75])


@pytest.mark.parametrize("cells", [3, 5])
def test_the_area_of_a_disc_does_not_depend_on_the_cells(cells: int) -> None:
    """Three cells across the square find a disc of radius 0.3 to 0.5 %."""
    closed = 1 - patch(square(cells), 0.3)
    assert closed == pytest.approx(np.pi * 0.3**2, rel=5e-3)


def test_a_surface_pressed_evenly_is_closed() -> None:
    """No edge at all."""
    points = square(2)
    even = np.full(points.area.size, 1e6)
    assert open_share(points, LAW, PressedSurface(even, 0 * even, 1)) == pytest.approx(
        0.0, abs=1e-12
    )


def test_the_corners_of_the_triangles_follow_from_their_points() -> None:
    """The outermost corners are those of the square."""
    corners = square(3).corners.reshape(-1, 2)
    np.testing.assert_allclose(corners.min(axis=0), 0.0, atol=1e-12)
    np.testing.assert_allclose(corners.max(axis=0), 1.0, atol=1e-12)
