# SPDX-License-Identifier: MIT
"""Nonlinear laws at the bolts, as forces beyond their linear springs."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.gap.structure_bench.structure_settings import STRUCTURE


@dataclass(frozen=True, slots=True, eq=False)
class PortLaws:
    """Laws at the ports, each a joint freedom of a bolt.

    Attributes:
        ports: joint freedoms with a law, shape (n_ports,).
        share: share of the linear stiffness of the port held by sliders [-].
        slips: displacement at which each slider slips [m], shape (n_sliders,).
        weights: share of each slider in them; they sum to 1, shape (n_sliders,).
    """

    ports: tuple[int, ...]
    share: float
    slips: FloatArray
    weights: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "slips", "weights")


def iwan_sliders(largest: float, power: float) -> tuple[FloatArray, FloatArray]:
    """Return slip displacements [m] and weights of sliders of one Iwan element.

    The stiffness below a slip displacement phi is (phi / largest)^power, as in the
    effect ``iwan`` of lumped joints. Cells are equally wide; a slider sits at the mean
    slip displacement of its cell.

    Args:
        largest: slip displacement [m].
        power: chi + 2 of Segalman's density [-], above 0.

    Source:
        Segalman 2005, J. Appl. Mech. 72, 752, eq. (14), stiffness ~ phi^(chi+1).
    """
    edges = np.linspace(0.0, 1.0, STRUCTURE.sliders + 1)
    weights = np.diff(edges**power)
    means = np.diff(edges ** (power + 1.0)) / weights * power / (power + 1.0)
    return largest * means, weights
