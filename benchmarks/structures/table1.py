# SPDX-License-Identifier: MIT
"""A stand-in for Table 1 of the 2023 paper: its joint under a column of our own.

The paper's geometry is unpublished. A marble block with 96 kg on top, standing on its
joint, has frequencies of the same size: its own numbers, not a reproduction.

python benchmarks/structures/table1.py [--report PAGE.html]

The page holds the table and the shapes, to turn around, offline.
"""

import argparse
from pathlib import Path

import numpy as np
from cases import MARBLE

from jointbench.analysis.structures.matrices.parts import (
    GROUND,
    FaceMass,
    Joint,
    Support,
    solid_body,
)
from jointbench.analysis.structures.matrices.structure import (
    Structure,
    build_structure,
)
from jointbench.analysis.structures.meshes.mesh import box_mesh
from jointbench.analysis.structures.reduction.full_modes import (
    StructureModes,
    solve_full,
)
from jointbench.station.report.structure_report import shape_figure
from jointbench.station.screen.page import write_report
from jointbench.station.screen.page_parts import DataTable, Plot, Report, Section

COLUMN, CELLS, ON_TOP = (0.694, 0.191, 0.415), (6, 2, 4), 96.0
HEADS = (
    "measured",
    "printed, joint",
    "computed, joint",
    "printed, glued",
    "computed, glued",
)
# Normal and two tangential stiffnesses of the paper [N/m].
JOINT = np.array([1.68e10, 2.46e7, 6.16e8])
MEASURED, PRINTED, PRINTED_GLUED = (
    (48.7, 166.5, 310.7),
    (48.8, 165.8, 313.6),
    (402.1, 842.5, 1068.9),
)


def shapes(structure: Structure, modes: StructureModes, word: str) -> Section:
    """Return the shapes of a structure as bodies to turn around."""
    items = []
    for at, frequency in enumerate(modes.natural_frequency):
        motion = np.zeros(3 * structure.nodes.shape[0])
        motion[structure.free] = modes.shapes[at]
        plot = shape_figure(structure, motion.reshape(-1, 3))
        title = f"{word}, mode {at + 1}: {frequency:.1f} Hz; drag to turn"
        items.append(Plot(f"{word}-{at}", title, plot, 420))
    return Section(word, word.capitalize(), tuple(items))


def main() -> None:
    """Print measured, printed and our own frequencies."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--report", type=Path)
    options = parser.parse_args()
    body = solid_body("column", box_mesh(COLUMN, CELLS), MARBLE)
    masses = [FaceMass("column", "z+", ON_TOP)]
    joint = Joint("bed", ("column", GROUND), face="z-")
    jointed = build_structure([body], [joint], masses=masses)
    held = build_structure(
        [body], [], supports=[Support("column", "z-")], masses=masses
    )
    with_joint = solve_full(jointed, JOINT, 3)
    glued = solve_full(held, np.zeros(0), 3)
    rows = tuple(
        tuple(f"{value:.1f}" for value in row)
        for row in zip(
            MEASURED,
            PRINTED,
            with_joint.natural_frequency,
            PRINTED_GLUED,
            glued.natural_frequency,
            strict=True,
        )
    )
    print("  ".join(HEADS))
    for row in rows:
        print(
            "  ".join(f"{cell:>{len(h)}}" for cell, h in zip(row, HEADS, strict=True))
        )
    if options.report is not None:
        table = DataTable("Natural frequencies [Hz]; geometry is ours.", HEADS, rows)
        sections = (
            Section("table", "Table 1, a stand-in", (table,)),
            shapes(jointed, with_joint, "jointed"),
            shapes(held, glued, "glued"),
        )
        title = "Table 1 of 2023, a stand-in"
        write_report(
            Report(title, str(__doc__).split(chr(10))[2], "", True, (), sections),
            options.report,
        )


if __name__ == "__main__":
    main()
