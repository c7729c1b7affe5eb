# SPDX-License-Identifier: MIT
"""Frequencies of a free plate on finer and finer meshes, beside converged values.

python benchmarks/structures/converge.py [--finest 3] [--plot FILE.html]
"""

import argparse
import time
from pathlib import Path

import numpy as np
from cases import MARBLE, PLATE

from jointbench.analysis.structures.matrices.element_assembly import assemble
from jointbench.analysis.structures.meshes.elements import ElementKind
from jointbench.analysis.structures.meshes.mesh import box_mesh
from jointbench.analysis.structures.reduction.full_modes import lowest_modes
from jointbench.station.screen.figures import axis, figure
from jointbench.station.screen.page import write_report
from jointbench.station.screen.page_parts import Plot, Report, Section
from jointbench.station.screen.traces import PALETTE, line

# Legendre-Ritz, upper bounds within 1e-5 (design note on joint simulation, section 1).
CONVERGED = np.array([916.16, 923.22, 2006.9, 2379.2, 2462.8, 2986.6])
CELLS = {
    ElementKind.HEX20: ((5, 3, 1), (10, 6, 2), (20, 12, 2), (30, 18, 3), (40, 24, 4)),
    ElementKind.TET10: ((5, 3, 1), (10, 6, 1), (20, 12, 2), (30, 18, 3), (36, 22, 4)),
}


def main() -> None:
    """Solve every mesh, print a table, draw the errors."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--finest", type=int, default=5)
    parser.add_argument("--plot", type=Path)
    options = parser.parse_args()
    curves = []
    for number, (kind, all_cells) in enumerate(CELLS.items()):
        sizes, errors = [], []
        for cells in all_cells[: options.finest]:
            begin = time.process_time()
            stiffness, mass = assemble(box_mesh(PLATE, cells, kind=kind), MARBLE)
            found = lowest_modes(stiffness, mass, 12).natural_frequency[6:]
            error = found / CONVERGED - 1.0
            sizes.append(stiffness.shape[0])
            errors.append(np.abs(error).max())
            print(
                f"{kind} {cells} {sizes[-1]:7d} dof {np.round(found, 2).tolist()} Hz, "
                f"largest error {100 * errors[-1]:.4f} %, "
                f"{time.process_time() - begin:.1f} CPU s",
                flush=True,
            )
        curves.append(line(sizes, errors, kind.value, color=PALETTE[number]))
    if options.plot is not None:
        plot = figure(
            curves,
            axis("degrees of freedom", log=True),
            axis("largest relative error of six frequencies", log=True),
        )
        section = Section("plot", "Free plate", (Plot("p", "Convergence", plot),))
        write_report(
            Report("Convergence", "500 x 300 x 50 mm", "", False, (), (section,)),
            options.plot,
        )


if __name__ == "__main__":
    main()
