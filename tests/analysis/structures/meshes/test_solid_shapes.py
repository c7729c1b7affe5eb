"""Bodies of boxes and cylinders, meshed by gmsh."""

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.structures.matrices.contact_interface import (
    contact_points,
    face_plane,
)
from jointbench.analysis.structures.matrices.element_assembly import Material, assemble
from jointbench.analysis.structures.meshes.mesh import outer_faces
from jointbench.analysis.structures.meshes.solid_shapes import SolidShape, mesh_shapes

PLATE = SolidShape((0.0, 0.0, 0.0), (0.3, 0.2, 0.1))


def test_a_plate_with_a_rib_and_a_hole_has_their_mass_and_area(
    marble: Material,
) -> None:
    """Union of two boxes less a prism of twelve sides or more; one solid."""
    pytest.importorskip("gmsh")
    rib = SolidShape((0.1, 0.0, 0.1), (0.02, 0.2, 0.1))
    hole = SolidShape((0.2, 0.1, 0.0), (0.0, 0.0, 0.1), radius=0.03, cut=True)
    mesh = mesh_shapes([PLATE, rib, hole], 0.06)
    _, mass = assemble(mesh, marble)
    area = contact_points(mesh, None, face_plane(mesh, "z-")).area
    corners = np.unique(outer_faces(mesh).nodes)
    ring = np.linalg.norm(mesh.nodes[corners, :2] - [0.2, 0.1], axis=1) < 0.0301
    assert ring.sum() >= 24
    polygon = 0.5 * 12 * 0.03**2 * np.sin(2 * np.pi / 12)
    assert 0.06 - np.pi * 0.03**2 < area < 0.06 - polygon + 1e-9
    # The wall of the hole has facets: between the circle and the polygon.
    least = 0.1 * (0.06 - np.pi * 0.03**2) + 0.02 * 0.2 * 0.1
    most = 0.1 * (0.06 - polygon) + 0.02 * 0.2 * 0.1
    assert 2600.0 * least < mass.sum() / 3 < 2600.0 * most * (1 + 1e-9)


def test_shapes_apart_are_not_one_body() -> None:
    """The number of solids, and what to check."""
    pytest.importorskip("gmsh")
    with pytest.raises(BadData, match="2 solids"):
        mesh_shapes([PLATE, SolidShape((9.0, 0.0, 0.0), (0.1, 0.1, 0.1))], 0.2)


def test_a_box_needs_a_volume() -> None:
    """Before gmsh is called."""
    with pytest.raises(BadData, match="no volume"):
        SolidShape((0.0, 0.0, 0.0), (0.3, 0.0, 0.1))
