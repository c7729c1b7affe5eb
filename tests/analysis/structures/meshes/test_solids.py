"""Meshes, elements and their matrices."""

from collections.abc import Callable

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.structures.matrices.element_assembly import Material, assemble
from jointbench.analysis.structures.meshes.elements import ElementKind
from jointbench.analysis.structures.meshes.mesh import Mesh, box_mesh, outer_faces
from jointbench.analysis.structures.reduction.full_modes import lowest_modes


@pytest.mark.parametrize(
    ("kind", "cells", "case", "mesh"),
    [
        (ElementKind.HEX20, (10, 6, 2), "1", "hex_10x6x2"),
        (ElementKind.TET10, (10, 6, 1), "2", "kuhn_10x6x1"),
    ],
)
def test_a_free_plate_has_the_frequencies_of_an_independent_code(
    marble: Material,
    kind: ElementKind,
    cells: tuple[int, int, int],
    case: str,
    mesh: str,
    oracle: Callable[[str, str], list[float]],
) -> None:
    """Six rigid motions, then the oracle's frequencies to its last digit."""
    stiffness, mass = assemble(box_mesh((0.5, 0.3, 0.05), cells, kind=kind), marble)
    found = lowest_modes(stiffness, mass, 12)
    assert np.all(found.natural_frequency[:6] == 0.0)
    np.testing.assert_allclose(
        found.natural_frequency[6:], oracle(case, mesh)[:6], rtol=2e-8
    )


@pytest.mark.parametrize("kind", list(ElementKind))
def test_a_uniform_strain_stores_its_exact_energy(
    marble: Material, kind: ElementKind
) -> None:
    """Energy of a stretch without Poisson's ratio: E strain^2 V / 2."""
    mesh = box_mesh((0.2, 0.1, 0.3), (2, 1, 2), kind=kind)
    stiff, _ = assemble(mesh, Material(marble.youngs_modulus, 0.0, 2600.0))
    motion = np.zeros((mesh.nodes.shape[0], 3))
    motion[:, 0] = 1e-3 * mesh.nodes[:, 0]
    energy = 0.5 * motion.ravel() @ (stiff @ motion.ravel())
    assert energy == pytest.approx(0.5 * 55e9 * 1e-6 * 0.006, rel=1e-12)


def test_an_element_without_volume_is_refused_by_number(marble: Material) -> None:
    """The second of two elements is pressed flat."""
    mesh = box_mesh((0.2, 0.1, 0.1), (2, 1, 1))
    nodes = mesh.nodes.copy()
    nodes[nodes[:, 0] > 0.1, 0] = 0.1
    with pytest.raises(BadData, match=r"element 1: Jacobian"):
        assemble(Mesh(nodes, mesh.cells, mesh.kind), marble)


def test_midside_nodes_in_a_foreign_order_are_refused() -> None:
    """Nastran's order of the edges of a hexahedron is not that of VTK."""
    mesh = box_mesh((1.0, 1.0, 1.0), (1, 1, 1))
    order = [*range(12), *range(16, 20), *range(12, 16)]
    with pytest.raises(BadData, match="VTK order"):
        Mesh(mesh.nodes, mesh.cells[:, order], mesh.kind)


@pytest.mark.parametrize("kind", list(ElementKind))
def test_outer_faces_close_the_body(kind: ElementKind) -> None:
    """The area of the outer faces, with their normals, adds up to nothing."""
    mesh = box_mesh((0.2, 0.1, 0.3), (2, 2, 1), kind=kind)
    faces = outer_faces(mesh)
    corner = mesh.nodes[faces.nodes[:, :3]]
    double = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    assert np.abs(double.sum(axis=0)).max() < 1e-15
    assert np.all(np.einsum("fa,fa->f", double, faces.normal) > 0)
