# SPDX-License-Identifier: MIT
"""Nonlinear laws at the bolts, as forces beyond their linear springs."""

from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.analysis.gap.structure_response.structure_settings import STRUCTURE


class LawForm(IntEnum):
    """Kind of a law; the comment gives the force at a relative motion r."""

    FRICTION = 0  # share k (sum of weight times clipped stretch - r)
    STOP = 1  # k max(r - g, 0)
    CUBIC = 2  # k3 r^3
    QUADRATIC = 3  # k2 r^2
    SQUARE_DAMPING = 4  # c2 v |v|


@dataclass(frozen=True, slots=True, eq=False)
class PortLaws:
    """One law at some ports, each a joint freedom of a bolt.

    Attributes:
        ports: joint freedoms with the law, shape (n_ports,).
        size: share of the linear stiffness of the port that sliders hold [-], k [N/m],
            k3 [N/m^3], k2 [N/m^2] or c2 [N s^2/m^2], as the kind states.
        slips: displacement at which each slider slips [m], shape (n_sliders,).
        weights: share of each slider in them; they sum to 1, shape (n_sliders,).
        gradual: number of sliders that yield gradually, the last ones; the others
            yield at once.
        kind: of the law.
        gap: clearance of a stop [m].
        preload: power of the slip displacements in the bolt torque [-].
    """

    ports: tuple[int, ...]
    size: float
    slips: FloatArray = field(default_factory=lambda: np.zeros(0))
    weights: FloatArray = field(default_factory=lambda: np.zeros(0))
    kind: LawForm = LawForm.FRICTION
    gap: float = 0.0
    preload: float = 0.0
    gradual: int = 0

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "slips", "weights")

    @property
    def sharp(self) -> int:
        """Number of sliders that yield at once."""
        return self.slips.size - self.gradual


def law_ports(laws: tuple[PortLaws, ...]) -> tuple[int, ...]:
    """Return the joint freedoms of all laws, in their order."""
    return tuple(port for law in laws for port in law.ports)


def iwan_sliders(
    largest: float, power: float, onset: float = 0.0
) -> tuple[FloatArray, FloatArray]:
    """Return slip displacements [m] and weights of sliders of one Iwan element.

    The stiffness below a slip displacement phi is (phi / largest)^power, as in the
    effect ``iwan`` of lumped joints. All of it below the onset is one slider, so that
    smaller motions do not slip. Further cells end at a constant ratio: soft hits slip
    the weak sliders alone. A slider sits at the mean slip displacement of its cell.

    Args:
        largest: slip displacement [m].
        power: chi + 1 of Segalman's density [-], above 0; chi + 2 with the chi that
            `iwan` reports, which is one less.
        onset: end of the first cell over the largest slip displacement [-], below 1; 0
            for one over the number of sliders.

    Source:
        Segalman 2005, J. Appl. Mech. 72, 752, eq. (14), stiffness ~ phi^(chi+1).
    """
    count = STRUCTURE.sliders
    first = onset if onset > 0.0 else 1.0 / count
    edges = np.concatenate([[0.0], np.geomspace(first, 1.0, count)])
    weights = np.diff(edges**power)
    means = np.diff(edges ** (power + 1.0)) / weights * power / (power + 1.0)
    return largest * means, weights
