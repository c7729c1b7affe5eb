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


def weibull_sliders(slip: float, shape: float) -> tuple[FloatArray, FloatArray]:
    """Return slip displacements [m] and weights of sliders with spread strengths.

    The stiffness that slips below a displacement phi is 1 - exp(-(phi / scale)^shape)
    of the whole. Cells end at a constant ratio, so that soft hits, which slip the weak
    sliders alone, meet as many as hard ones; a slider sits at the mean slip
    displacement of its cell.

    Args:
        slip: mean slip displacement: limiting force over stiffness [m].
        shape: [-]; below 2 yielding begins with the smallest motion, far above 2 all
            slip at once.

    Source:
        Weibull 1951, J. Appl. Mech. 18, 293, for the strengths; Iwan 1966, J. Appl.
        Mech. 33, 893, for their sum.
    """
    from scipy.special import gamma, gammainc  # slow to import

    scale = slip / float(gamma(1.0 + 1.0 / shape))
    below, above = STRUCTURE.outer_sliders
    weakest = float(-np.log1p(-below)) ** (1.0 / shape) * scale
    first = max(weakest, STRUCTURE.least_slip * slip)
    last = float(-np.log(above)) ** (1.0 / shape) * scale
    edges = np.geomspace(first, last, STRUCTURE.sliders - 1)
    reached = np.concatenate([[0.0], (edges / scale) ** shape, [np.inf]])
    weights = -np.diff(np.exp(-reached))
    means = np.diff(gammainc(1.0 + 1.0 / shape, reached)) / weights
    return slip * means, weights
