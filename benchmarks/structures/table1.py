# SPDX-License-Identifier: MIT
"""A stand-in for Table 1 of the 2023 paper: its joint under a column of our own.

The paper's geometry is unpublished. A marble block with 96 kg on top, standing on its
joint, has frequencies of the same size: its own numbers, not a reproduction.

python benchmarks/structures/table1.py
"""

import numpy as np
from cases import MARBLE

from jointbench.analysis.structures.full_modes import solve_full
from jointbench.analysis.structures.mesh import box_mesh
from jointbench.analysis.structures.parts import (
    GROUND,
    FaceMass,
    Joint,
    Support,
    solid_body,
)
from jointbench.analysis.structures.structure import (
    build_structure,
)

COLUMN, CELLS, ON_TOP = (0.694, 0.191, 0.415), (6, 2, 4), 96.0
# Normal and two tangential stiffnesses of the paper [N/m].
JOINT = np.array([1.68e10, 2.46e7, 6.16e8])
MEASURED, PRINTED, PRINTED_GLUED = (
    (48.7, 166.5, 310.7),
    (48.8, 165.8, 313.6),
    (402.1, 842.5, 1068.9),
)


def main() -> None:
    """Print measured, printed and our own frequencies."""
    body = solid_body("column", box_mesh(COLUMN, CELLS), MARBLE)
    masses = [FaceMass("column", "z+", ON_TOP)]
    joint = Joint("bed", ("column", GROUND), face="z-")
    jointed = build_structure([body], [joint], masses=masses)
    held = build_structure(
        [body], [], supports=[Support("column", "z-")], masses=masses
    )
    with_joint = solve_full(jointed, JOINT, 3).natural_frequency
    glued = solve_full(held, np.zeros(0), 3).natural_frequency
    print("mode  measured  printed, joint  ours, joint  printed, glued  ours, glued")
    for at in range(3):
        print(
            f"{at + 1:4d}  {MEASURED[at]:8.1f}  {PRINTED[at]:14.1f}  "
            f"{with_joint[at]:11.1f}  {PRINTED_GLUED[at]:14.1f}  {glued[at]:11.1f}"
        )


if __name__ == "__main__":
    main()
