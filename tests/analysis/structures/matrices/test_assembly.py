"""Assembly: element matrices added into the compressed matrix."""

from dataclasses import replace

import numpy as np
import pytest

from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.structures.matrices.element_assembly import Material, assemble
from jointbench.analysis.structures.meshes.elements import ElementKind
from jointbench.analysis.structures.meshes.mesh import Mesh, box_mesh


def distorted(kind: ElementKind) -> Mesh:
    """Return a mesh whose elements differ, with one node that none of them has."""
    mesh = box_mesh((0.3, 0.2, 0.1), (2, 2, 1), kind=kind)
    nodes = mesh.nodes + 0.01 * np.sin(9.0 * mesh.nodes[:, [1, 2, 0]])
    return Mesh(np.concatenate([nodes, [[9.0, 9.0, 9.0]]]), mesh.cells, kind)


@pytest.mark.parametrize("kind", list(ElementKind))
def test_the_whole_matrix_is_the_sum_of_its_elements(
    marble: Material, kind: ElementKind
) -> None:
    """Each element assembled alone, on the same nodes; the free node stays empty."""
    mesh = distorted(kind)
    stiffness, mass = assemble(mesh, marble)
    parts = [assemble(replace(mesh, cells=cell[None]), marble) for cell in mesh.cells]
    for whole, own in ((stiffness, 0), (mass, 1)):
        apart = abs(whole - sum(part[own] for part in parts[1:]) - parts[0][own]).max()
        assert apart <= 1e-14 * abs(whole).max()
        assert whole.has_canonical_format
        assert not whole[-3:].nnz


def test_an_inverted_element_is_named(marble: Material) -> None:
    """One line with its number and the rule."""
    mesh = box_mesh((0.3, 0.2, 0.1), (2, 1, 1))
    cells = mesh.cells.copy()
    cells[1] = cells[1][
        [4, 5, 6, 7, 0, 1, 2, 3, *range(12, 16), *range(8, 12), 16, 17, 18, 19]
    ]
    with pytest.raises(BadData, match="element 1: Jacobian"):
        assemble(replace(mesh, cells=cells), marble)
