# SPDX-License-Identifier: MIT
"""Memory and time of the assembly up to a million degrees of freedom.

Every case runs in a process of its own, so that its CPU time and its largest memory
are its own. No two elements are equal: the box is distorted. scikit-fem, where it is
installed, assembles the same mesh.

OMP_NUM_THREADS=1 python benchmarks/structures/assembly.py [--page FILE]
"""

import argparse
import json
import resource
import subprocess
import sys
import time
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from cases import MARBLE, PLATE

from jointbench.analysis.structures.matrices.element_assembly import Sparse, assemble
from jointbench.analysis.structures.meshes.elements import ElementKind
from jointbench.analysis.structures.meshes.mesh import Mesh, box_mesh

CASES = (
    ("jointbench", "hex20", (18, 14, 6)),
    ("jointbench", "hex20", (42, 36, 12)),
    ("scikit-fem", "hex20", (18, 14, 6)),
    ("jointbench", "hex20", (70, 62, 18)),
    ("jointbench", "tet10", (12, 10, 4)),
    ("scikit-fem", "tet10", (12, 10, 4)),
    ("jointbench", "tet10", (60, 52, 13)),
)
BAR = 8.0
"""Memory of a million degrees of freedom [GB]."""
INTRODUCTION = """# Memory and time of the assembly

Made by `benchmarks/structures/assembly.py`: stiffness and mass of a distorted plate, no
two elements alike. Every case runs in a separate process on one thread; time is CPU
seconds of the assembly alone, memory the peak of the process (0.2 GB of it are Python
and its libraries). The bar is {bar:g} GB for 1,000,000 degrees of freedom. The traces
differ in the sixth digit because the edges of scikit-fem's mesh are straight, while
midside nodes of the other follow the distortion.

| program | element | dof | nonzeros of K | CPU s | memory [GB] | trace of K [N/m] |
|---|---|---|---|---|---|---|
"""


def distorted(kind: ElementKind, cells: tuple[int, ...]) -> Mesh:
    """Return a plate whose elements differ."""
    mesh = box_mesh(PLATE, cells, kind=kind)
    wave = np.sin(mesh.nodes[:, [1, 2, 0]] * np.array([6.0, 9.0, 12.0]))
    return replace(mesh, nodes=mesh.nodes + 0.01 * wave * np.array([1.0, 1.0, 0.1]))


def by_scikit_fem(mesh: Mesh) -> tuple[Sparse, Sparse]:
    """Assemble with scikit-fem, elements and quadrature of the same order."""
    import skfem
    from skfem.models.elasticity import lame_parameters, linear_elasticity

    corners = 8 if mesh.kind is ElementKind.HEX20 else 4
    used, cells = np.unique(mesh.cells[:, :corners], return_inverse=True)
    cells = cells.reshape(-1, corners)
    if mesh.kind is ElementKind.HEX20:
        # Bottom, top of VTK to the order of scikit-fem.
        cells = cells[:, [0, 1, 3, 4, 2, 5, 7, 6]]
        shape, element = skfem.MeshHex, skfem.ElementHexS2()
    else:
        shape, element = skfem.MeshTet, skfem.ElementTetP2()
    own = shape(mesh.nodes[used].T.copy(), cells.T.copy())
    basis = skfem.Basis(own, skfem.ElementVector(element), intorder=5)
    law = lame_parameters(MARBLE.youngs_modulus, MARBLE.poisson_ratio)
    stiffness = linear_elasticity(*law).assemble(basis)

    @skfem.BilinearForm
    def inertia(u: np.ndarray, v: np.ndarray, _: object) -> np.ndarray:
        return MARBLE.density * sum(u[a] * v[a] for a in range(3))

    return Sparse(stiffness), Sparse(inertia.assemble(basis))


def run_case(program: str, kind: str, cells: tuple[int, ...]) -> dict[str, float]:
    """Assemble once in this process and return size, cost and the trace."""
    mesh = distorted(ElementKind(kind), cells)
    own = assemble if program == "jointbench" else None
    # Compilation, cached on disk after the first time, is not counted.
    assemble(box_mesh(PLATE, (1, 1, 1), kind=ElementKind(kind)), MARBLE)
    start = time.process_time()
    stiffness, _ = own(mesh, MARBLE) if own else by_scikit_fem(mesh)
    return {
        "size": stiffness.shape[0],
        "nonzeros": stiffness.nnz,
        "seconds": time.process_time() - start,
        "memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6,
        "trace": float(stiffness.diagonal().sum()),
    }


def main() -> None:
    """Run all cases, each in its own process."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--one", type=json.loads)
    parser.add_argument("--page", type=Path)
    options = parser.parse_args()
    if options.one:
        program, kind, cells = options.one
        print(json.dumps(run_case(program, kind, tuple(cells))))
        return
    page = INTRODUCTION.format(bar=BAR)
    for program, kind, cells in CASES:
        if program == "scikit-fem" and find_spec("skfem") is None:
            page += f"| {program} | {kind} | not installed | | | | |\n"
            continue
        words = [sys.executable, __file__, "--one", json.dumps((program, kind, cells))]
        done = subprocess.run(words, check=True, capture_output=True, text=True)
        one = json.loads(done.stdout)
        page += (
            f"| {program} | {kind} | {one['size']:,} | {one['nonzeros']:,} | "
            f"{one['seconds']:.1f} | {one['memory']:.2f} | {one['trace']:.9e} |\n"
        )
        print(page.splitlines()[-1], flush=True)
    if options.page is not None:
        options.page.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
