# SPDX-License-Identifier: MIT
"""A machine of four masses in a row: bed, column, headstock and spindle.

It is described by masses, springs and dampers alone; modes are not used to make it.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class MachineDesign:
    """Masses on springs and dampers; the first one of each leads to the ground.

    Attributes:
        masses: of bed, column, headstock and spindle [kg].
        stiffness: of the springs below each mass [N/m].
        damping: of the dampers beside them [N s/m]; not proportional to the springs.
    """

    masses: tuple[float, ...] = (420.0, 160.0, 70.0, 22.0)
    stiffness: tuple[float, ...] = (1.1e8, 7.0e7, 5.2e7, 4.4e7)
    damping: tuple[float, ...] = (4.0e3, 1.6e3, 7.0e2, 5.0e2)

    def matrices(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return masses, dampings and stiffnesses as matrices, shape (n, n)."""
        return (
            np.diag(self.masses),
            _chain(self.damping),
            _chain(self.stiffness),
        )


def _chain(below: tuple[float, ...]) -> FloatArray:
    """Return the matrix of elements between neighbours and the ground."""
    count = len(below)
    matrix = np.zeros((count, count))
    for n, value in enumerate(below):
        matrix[n, n] += value
        if n:
            matrix[n - 1, n - 1] += value
            matrix[n - 1, n] -= value
            matrix[n, n - 1] -= value
    return matrix
