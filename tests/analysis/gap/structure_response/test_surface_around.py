"""Mode shapes on the surface around a place, against the shapes themselves."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.structure_response.jointed_bodies import HitPoint
from jointbench.analysis.gap.structure_response.surface_around import surface_around
from jointbench.simulators.flexible.draw_flexible_bench import draw_bench
from jointbench.simulators.flexible.flexible_specimen import BodyPlace
from jointbench.simulators.flexible.physical_bodies import PhysicalBody
from jointbench.simulators.flexible.surface_nodes import (
    along_side,
    side_axes,
    surface_nodes,
)

OFFSETS = ((0.045, 0.0), (-0.03, 0.01), (0.012, -0.008))


def places(kind: str) -> list[tuple[PhysicalBody, BodyPlace, FloatArray]]:
    """Return each sensor and point of a bench with its body and the nodes of that."""
    bench = draw_bench(3, kind=kind)
    nodes = [surface_nodes(bench.specimen, k) for k in (0, 1)]
    every = (*bench.specimen.points, *bench.specimen.sensors)
    return [(bench.bodies[p.body], p, nodes[p.body]) for p in every]


@pytest.mark.parametrize("kind", ["plates", "lap-beam", "column"])
def test_shapes_beside_a_place_are_those_of_the_body(kind: str) -> None:
    """Up to 45 mm away on the body, within 1e-3 of the largest shape at the place.

    Modes above the band of the hits follow within 3e-3.
    """
    tried = 0
    for body, place, nodes in places(kind):
        found = surface_around(place.position, nodes, body.table_nodes(nodes))
        assert found is not None
        assert found.axes == side_axes(body.body, place)
        here = body.table_rows(place.position)
        for u, v in OFFSETS:
            moved = along_side(body.body, place, u, v)
            if body.body.holds(moved):
                tried += 1
                wanted = body.table_rows(moved) - here
                scale = np.abs(body.table_rows(moved)).max()
                apart = np.abs(found.change(u, v) - wanted).max(axis=0) / scale
                inside = body.table_frequency < 0.6 * body.table_frequency.max()
                assert apart.max() < 3e-3
                assert apart[inside].max() < 1e-3
    assert tried > 10


def test_a_moved_point_has_the_derivatives_there() -> None:
    """Its tilts and offsets are those of the place that is struck."""
    body, place, nodes = places("plates")[0]
    around = surface_around(place.position, nodes, body.table_nodes(nodes))
    assert around is not None
    normal = np.array(place.direction)
    across = np.linalg.svd(normal[None])[2][1:]

    def point(at: tuple[float, float, float]) -> HitPoint:
        gradient = np.einsum("ad,dcn->acn", across, body.table_gradient(at))
        return HitPoint(place.name, normal, across, body.table_rows(at), gradient)

    moved = point(place.position).beside(around, 0.02, -0.015)
    wanted = point(along_side(body.body, place, 0.02, -0.015))
    assert_allclose(moved.rows, wanted.rows, atol=1e-3 * np.abs(wanted.rows).max())
    slack = 5e-3 * np.abs(wanted.gradient).max()
    assert_allclose(moved.gradient, wanted.gradient, atol=slack)


def test_few_nodes_show_no_surface() -> None:
    """Neither does a place that is not stated."""
    nodes, rows = np.zeros((30, 3)), np.zeros((30, 3, 4))
    nodes[:, 0] = np.linspace(0, 0.1, 30)
    assert surface_around(None, nodes, rows) is None
    assert surface_around((0.0, 0.0, 0.0), nodes, rows) is None
    assert surface_around((0.0, 0.0, 0.0), nodes[:5], rows[:5]) is None
