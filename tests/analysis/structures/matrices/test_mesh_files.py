"""Meshes and matrices of other programs."""

from pathlib import Path

import numpy as np
import pytest
from scipy import sparse
from scipy.io import hb_write, mmwrite

from jointbench.acquisition.basics.errors import FormatError
from jointbench.analysis.structures.matrices.element_assembly import Material, assemble
from jointbench.analysis.structures.matrices.mesh_files import (
    matrix_body,
    read_matrix,
    read_mesh,
)
from jointbench.analysis.structures.meshes.elements import ElementKind
from jointbench.analysis.structures.meshes.mesh import Mesh, box_mesh

MESHIO_TYPE = {ElementKind.HEX20: "hexahedron20", ElementKind.TET10: "tetra10"}


def write_mesh(path: Path, mesh: Mesh, scale: float) -> None:
    """Write a mesh with meshio, in the unit that `scale` makes of metres."""
    meshio = pytest.importorskip("meshio")
    cells = [(MESHIO_TYPE[mesh.kind], mesh.cells)]
    own_format = "gmsh" if path.suffix == ".msh" else None
    meshio.Mesh(mesh.nodes * scale, cells).write(path, file_format=own_format)


@pytest.mark.parametrize("kind", list(ElementKind))
@pytest.mark.parametrize("suffix", [".inp", ".msh", ".bdf"])
def test_a_mesh_file_has_the_mass_of_its_box(
    marble: Material, tmp_path: Path, kind: ElementKind, suffix: str
) -> None:
    """Millimetres in the file; density times volume out of the mass matrix."""
    path = tmp_path / f"box{suffix}"
    write_mesh(path, box_mesh((0.2, 0.1, 0.05), (2, 1, 1), kind=kind), 1e3)
    mesh = read_mesh(path, unit=1e-3)
    _, mass = assemble(mesh, marble)
    assert mass.sum() / 3 == pytest.approx(2600.0 * 0.001, rel=1e-6)


def test_a_mesh_of_linear_elements_is_refused(tmp_path: Path) -> None:
    """Its elements are named."""
    meshio = pytest.importorskip("meshio")
    nodes = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    path = tmp_path / "linear.inp"
    meshio.Mesh(nodes, [("tetra", np.array([[0, 1, 2, 3]]))]).write(path)
    with pytest.raises(FormatError, match="tetra"):
        read_mesh(path)


def test_one_triangle_of_a_matrix_stands_for_both(
    marble: Material, tmp_path: Path
) -> None:
    """Harwell-Boeing as HBMAT writes it, and Matrix Market, give the same body."""
    mesh = box_mesh((0.2, 0.1, 0.05), (1, 1, 1))
    stiffness, mass = assemble(mesh, marble)
    hb_write(str(tmp_path / "k.hb"), sparse.csc_array(sparse.tril(stiffness)))
    mmwrite(tmp_path / "m.mtx", mass, symmetry="symmetric", precision=17)
    body = matrix_body(
        "block", mesh, read_matrix(tmp_path / "k.hb"), read_matrix(tmp_path / "m.mtx")
    )
    assert abs(body.stiffness - stiffness).max() < 1e-6 * abs(stiffness).max()
    assert abs(body.mass - mass).max() < 1e-12 * abs(mass).max()


def test_a_text_is_no_matrix(tmp_path: Path) -> None:
    """The message names both formats."""
    path = tmp_path / "k.hb"
    path.write_text("not a matrix\n", encoding="utf-8")
    with pytest.raises(FormatError, match="Harwell-Boeing"):
        read_matrix(path)


def test_lines_surfaces_and_sets_of_gmsh_are_left_out(
    marble: Material, tmp_path: Path
) -> None:
    """Abaqus as gmsh writes it: T3D3 lines and CPS6 surfaces beside C3D10 solids."""
    pytest.importorskip("meshio")
    mesh = box_mesh((0.2, 0.1, 0.05), (1, 1, 1), kind=ElementKind.TET10)
    rows = [
        f"{n + 1}, {x:.12g}, {y:.12g}, {z:.12g}"
        for n, (x, y, z) in enumerate(mesh.nodes)
    ]
    solids = [
        ", ".join(map(str, [n + 9, *(cell + 1)])) for n, cell in enumerate(mesh.cells)
    ]
    text = [
        *("*Heading", " box.inp", "*NODE"),
        *rows,
        "******* E L E M E N T S *************",
        *("*ELEMENT, type=T3D3, ELSET=Line1", "1, 1, 2, 9"),
        *("*ELEMENT, type=CPS6, ELSET=Surface1", "2, 1, 2, 3, 9, 10, 11"),
        "*ELEMENT, type=C3D10, ELSET=Volume1",
        *solids,
        *("*ELSET,ELSET=Surface1", "2", "*NSET,NSET=Surface1", "1, 2, 3"),
    ]
    path = tmp_path / "box.inp"
    path.write_text("\n".join(text) + "\n", encoding="utf-8")
    _, mass = assemble(read_mesh(path), marble)
    assert mass.sum() / 3 == pytest.approx(2600.0 * 0.001, rel=1e-9)
