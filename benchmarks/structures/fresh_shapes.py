# SPDX-License-Identifier: MIT
"""Free bodies with holes and ribs, meshed by gmsh, in three programs.

The same tet10 mesh in jointbench, scikit-fem and CalculiX (`ccx`), where these are
installed: ten elastic modes.

python benchmarks/structures/fresh_shapes.py [--page docs/machine-shapes.md]
"""

import argparse
import shutil
import subprocess
import tempfile
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from assembly import by_scikit_fem
from cases import MARBLE
from scipy import sparse

from jointbench.analysis.structures.matrices.element_assembly import Sparse, assemble
from jointbench.analysis.structures.meshes.elements import shape_functions
from jointbench.analysis.structures.meshes.mesh import Mesh
from jointbench.analysis.structures.meshes.solid_shapes import SolidShape, mesh_shapes
from jointbench.analysis.structures.reduction.full_modes import lowest_modes

RIGID, ELASTIC = 6, 10
PLATE = SolidShape((0.0, 0.0, 0.0), (0.5, 0.3, 0.05))
SHAPES = {
    "plate with a rib and a hole": (
        PLATE,
        SolidShape((0.24, 0.0, 0.05), (0.02, 0.3, 0.06)),
        SolidShape((0.12, 0.15, 0.0), (0.0, 0.0, 0.05), radius=0.06, cut=True),
    ),
    "angle with two slanted holes": (
        PLATE,
        SolidShape((0.0, 0.0, 0.05), (0.06, 0.3, 0.25)),
        SolidShape((0.35, 0.08, -0.01), (0.03, 0.02, 0.08), radius=0.025, cut=True),
        SolidShape((-0.01, 0.2, 0.2), (0.09, -0.03, 0.02), radius=0.03, cut=True),
    ),
    "ring with a boss": (
        SolidShape((0.0, 0.0, 0.0), (0.0, 0.0, 0.06), radius=0.2),
        SolidShape((0.0, 0.0, 0.0), (0.0, 0.0, 0.06), radius=0.12, cut=True),
        SolidShape((0.13, -0.04, 0.06), (0.06, 0.08, 0.05)),
    ),
}
INTRODUCTION = """# Fresh shapes in three programs

Made by `benchmarks/structures/fresh_shapes.py`: free marble bodies with holes and ribs,
meshed by gmsh (tet10); the same mesh in each program. The difference is the largest of
ten elastic frequencies, relative to those of jointbench. CalculiX integrates the mass
of a tet10 with four points, which is not exact; the last column compares with the mass
of jointbench integrated the same way. CalculiX prints seven digits.

| body | elements | dof | first, last [Hz] | scikit-fem | CalculiX | its mass |
|---|---|---|---|---|---|---|
"""


def by_calculix(mesh: Mesh) -> list[float]:
    """Return the elastic frequencies of CalculiX [Hz]."""
    lines = ["*NODE, NSET=ALL"]
    lines += [
        f"{at + 1}, {x:.12g}, {y:.12g}, {z:.12g}"
        for at, (x, y, z) in enumerate(mesh.nodes)
    ]
    lines.append("*ELEMENT, TYPE=C3D10, ELSET=BODY")
    lines += [
        ", ".join(map(str, [at + 1, *(cell + 1)])) for at, cell in enumerate(mesh.cells)
    ]
    lines += ["*MATERIAL, NAME=MARBLE", "*ELASTIC"]
    lines.append(f"{MARBLE.youngs_modulus:g}, {MARBLE.poisson_ratio:g}")
    lines += ["*DENSITY", f"{MARBLE.density:g}"]
    lines += ["*SOLID SECTION, ELSET=BODY, MATERIAL=MARBLE", "*STEP", "*FREQUENCY"]
    lines += [f"{RIGID + ELASTIC}", "*END STEP", ""]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "body.inp").write_text("\n".join(lines), encoding="ascii")
        subprocess.run(["ccx", "body"], cwd=folder, check=True, capture_output=True)
        text = (folder / "body.dat").read_text(encoding="ascii")
    rows = [line.split() for line in text.splitlines()]
    found = [float(row[3]) for row in rows if len(row) == 5 and row[0].isdigit()]
    return found[RIGID : RIGID + ELASTIC]


def four_point_mass(mesh: Mesh) -> Sparse:
    """Return the mass with the rule of four points; edges are straight."""
    a, b = (5.0 + 3.0 * np.sqrt(5.0)) / 20.0, (5.0 - np.sqrt(5.0)) / 20.0
    points = np.full((4, 3), b)
    points[[1, 2, 3], [0, 1, 2]] = a
    value, _ = shape_functions(mesh.kind, points)
    corner = mesh.nodes[mesh.cells[:, :4]]
    volume = np.linalg.det(corner[:, 1:] - corner[:, :1]) / 6.0
    block = MARBLE.density * value.T @ value / 4.0
    wide = mesh.cells.shape[1]
    rows = np.repeat(mesh.cells, wide, axis=1).ravel()
    columns = np.tile(mesh.cells, (1, wide)).ravel()
    entries = (volume[:, None, None] * block).ravel()
    count = mesh.nodes.shape[0]
    scalar = sparse.coo_array((entries, (rows, columns)), shape=(count, count))
    return Sparse(sparse.kron(scalar.tocsr(), np.eye(3), format="csr"))


def difference(found: list[float], own: np.ndarray) -> str:
    """Return the largest relative difference as text."""
    return f"{np.abs(np.array(found) / own - 1).max():.1e}"


def row(name: str, element: float) -> str:
    """Return the row of one body."""
    mesh = mesh_shapes(SHAPES[name], element)
    count = RIGID + ELASTIC
    own = lowest_modes(*assemble(mesh, MARBLE), count).natural_frequency[RIGID:]
    other = calculix = rule = "not installed"
    if find_spec("skfem") is not None:
        matrices = by_scikit_fem(mesh)
        found = lowest_modes(*matrices, count).natural_frequency[RIGID:]
        other = difference(found.tolist(), own)
    if shutil.which("ccx") is not None:
        printed = by_calculix(mesh)
        calculix = difference(printed, own)
        same = lowest_modes(assemble(mesh, MARBLE)[0], four_point_mass(mesh), count)
        rule = difference(printed, same.natural_frequency[RIGID:])
    return (
        f"| {name} | {len(mesh.cells):,} | {3 * len(mesh.nodes):,} | {own[0]:.3f}, "
        f"{own[-1]:.3f} | {other} | {calculix} | {rule} |\n"
    )


def main() -> None:
    """Compare all bodies."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--element", type=float, default=0.04, help="largest edge [m]")
    parser.add_argument("--page", type=Path)
    options = parser.parse_args()
    page = INTRODUCTION
    for name in SHAPES:
        page += row(name, options.element)
        print(page.splitlines()[-1], flush=True)
    if options.page is not None:
        options.page.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
