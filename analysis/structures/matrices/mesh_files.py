# SPDX-License-Identifier: MIT
"""Read meshes (Abaqus, Nastran, gmsh) and matrices (Matrix Market, Ansys)."""

import importlib.util
from pathlib import Path

import numpy as np
from scipy import sparse
from scipy.io import hb_read, mmread

from jointbench.acquisition.basics.arrays import IntArray
from jointbench.acquisition.basics.errors import FormatError, UsageError
from jointbench.acquisition.file_access.memory_room import require_room
from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.analysis.structures.matrices.mesh_child import read_with_meshio
from jointbench.analysis.structures.matrices.parts import (
    MeshedBody,
)
from jointbench.analysis.structures.meshes.elements import ElementKind
from jointbench.analysis.structures.meshes.mesh import Mesh, merge_nodes

_KINDS = {"hexahedron20": ElementKind.HEX20, "tetra10": ElementKind.TET10}
_MOST_BYTES = 500_000_000
_HEAD_LINES = 100
# Largest asymmetry of a symmetric matrix, as a share of the largest value.
_ASYMMETRY = 1e-8


def read_mesh(path: Path, *, unit: float = 1.0) -> Mesh:
    """Read the quadratic solids of a mesh file.

    Args:
        path: Abaqus ``.inp``, Nastran ``.bdf``, gmsh ``.msh`` or another that meshio
            reads; tet10 or hex20 elements.
        unit: of its coordinates [m]; 1e-3 for millimetres.

    Returns:
        The mesh; shells, lines and unused nodes are left out.

    Raises:
        FormatError: the file cannot be read, or holds no or mixed quadratic solids.
        UsageError: meshio is not installed.
    """
    if importlib.util.find_spec("meshio") is None:
        raise UsageError(f"{path} needs meshio: pip install 'jointbench[meshes]'")
    _require_size(path)
    nodes, blocks = read_with_meshio(path)
    solids = [(kind, data) for kind, data in blocks if kind in _KINDS]
    kinds = {kind for kind, _ in solids}
    if len(kinds) != 1:
        types = sorted({kind for kind, _ in blocks})
        raise FormatError(
            f"{path}: elements are {types}; one kind of hexahedron20 or tetra10 is "
            "needed: mesh with quadratic solids"
        )
    cells = np.concatenate([data for _, data in solids])
    return merge_nodes(Mesh(nodes * unit, cells, _KINDS[kinds.pop()]))


def read_matrix(path: Path) -> Sparse:
    """Read a symmetric matrix.

    Args:
        path: Matrix Market ``.mtx``, or Harwell-Boeing as Ansys' HBMAT writes it.

    Returns:
        The full matrix, even if the file holds one triangle.

    Raises:
        FormatError: the file cannot be read, or the matrix is not symmetric.
    """
    _require_size(path)
    _require_sane_matrix(path)
    try:
        if path.suffix.lower() == ".mtx":
            whole = Sparse(sparse.csr_array(mmread(path)))
        else:
            whole = Sparse(sparse.csr_array(hb_read(str(path))))
    except (ValueError, TypeError, OSError, IndexError) as error:
        raise FormatError(
            f"{path}: neither Matrix Market nor Harwell-Boeing ({error})"
        ) from error
    if whole.shape[0] != whole.shape[1]:
        raise FormatError(f"{path}: shape {whole.shape}; a square matrix is needed")
    upper, lower = sparse.triu(whole, 1), sparse.tril(whole, -1)
    if (upper.nnz == 0) != (lower.nnz == 0):
        # Symmetric matrices are commonly stored as one triangle.
        whole = Sparse(whole + (upper + lower).T)
    if abs(whole - whole.T).max() > _ASYMMETRY * abs(whole).max():
        raise FormatError(f"{path}: the matrix is not symmetric; export K and M")
    return whole


def matrix_body(
    name: str,
    mesh: Mesh,
    stiffness: Sparse,
    mass: Sparse,
    *,
    order: IntArray | None = None,
    loss_factor: float = 0.0,
) -> MeshedBody:
    """Return a body with matrices of another program.

    Args:
        name: of the body.
        mesh: of the matrices: it gives the positions of joints and sensors.
        stiffness: K [N/m], shape (3 n_nodes, 3 n_nodes).
        mass: M [kg].
        order: row of the matrices for every degree of freedom x, y, z node by node,
            shape (3 n_nodes,); None if already in this order.
        loss_factor: of the material [-].

    Returns:
        The body.
    """
    if order is not None:
        stiffness, mass = stiffness[order][:, order], mass[order][:, order]
    return MeshedBody(name, mesh, Sparse(stiffness), Sparse(mass), loss_factor)


def _require_sane_matrix(path: Path) -> None:
    """Refuse a matrix whose header claims more than its file can hold.

    Raises:
        HostileFile: the header claims too many rows or values.
    """
    market = path.suffix.lower() == ".mtx"
    with path.open("rb") as file:
        head = [file.readline(1000) for _ in range(_HEAD_LINES)]
    lines = [line.split() for line in head if not line.startswith(b"%")]
    try:
        words = lines[0] if market else lines[2][1:]
        claimed = [int(word) for word in words[:4]]
    except (ValueError, IndexError):
        return  # the reader reports the damage
    full = market and b"array" in head[0].lower()
    rows = max(claimed[:2], default=0)
    values = rows * min(claimed[:2], default=0) if full else max(claimed, default=0)
    require_room(path, 40 * rows + 60 * values)


def _require_size(path: Path) -> None:
    if not path.is_file():
        raise FormatError(f"{path}: no such file; check the path")
    if path.stat().st_size > _MOST_BYTES:
        raise FormatError(f"{path}: larger than {_MOST_BYTES} bytes; thin the mesh")
