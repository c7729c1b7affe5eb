# SPDX-License-Identifier: MIT
"""Elastic contact of measured heights on a half-space, by conjugate gradients."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.contact.half_space.influence import Influence

TOLERANCE = 1e-6
"""Change of the pressures in a step over their sum at which the search ends [-]; ten
times less moves the mean gap by 1e-6 of itself."""
MOST_STEPS = 2000
"""Steps after which it is given up [-]; 100 to 400 are usual."""


@dataclass(frozen=True, slots=True, eq=False)
class ElasticContact:
    """Pressures and gap of heights pressed against a rigid plane.

    Attributes:
        pressure: at each point [Pa], shape (n_rows, n_columns).
        gap: at each point, 0 in contact [m], same shape.
        steps: of the search [-].
    """

    pressure: FloatArray
    gap: FloatArray
    steps: int

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "pressure", "gap")

    @property
    def mean_gap(self) -> float:
        """Mean of the gap [m]."""
        return float(self.gap.mean())

    @property
    def area_share(self) -> float:
        """Points in contact over all points [-]."""
        return float((self.pressure > 0).mean())


def solve_contact(
    heights: FloatArray,
    mean_pressure: float,
    influence: Influence,
    start: FloatArray | None = None,
) -> ElasticContact:
    """Press heights against a rigid plane, without friction or adhesion.

    Args:
        heights: outwards [m], shape (n_rows, n_columns); of two rough surfaces their
            sum.
        mean_pressure: load over the area of the map [Pa].
        influence: of a pressure on the displacements, with both bodies' modulus.
        start: pressures to start from [Pa], same shape; None for even ones.

    Raises:
        BadData: the search does not end.

    Source:
        Polonsky and Keer, Wear 231 (1999) 206; by FFT as Stanley and Kato, J. Tribol.
        119 (1997) 481.
    """
    pressure = np.full(heights.shape, mean_pressure) if start is None else start.copy()
    pressure *= mean_pressure / pressure.mean()
    direction = np.zeros_like(pressure)
    before, conjugate = 1.0, 0.0
    for step in range(1, MOST_STEPS + 1):
        touching = pressure > 0
        gap = influence.displacement(pressure) - heights
        gap -= gap[touching].mean()
        square = float((gap[touching] ** 2).sum())
        if square == 0:
            return ElasticContact(pressure, np.maximum(gap, 0), step)
        direction = np.where(touching, gap + conjugate * square / before * direction, 0)
        before = square
        change = influence.displacement(direction)
        change -= change[touching].mean()
        length = float((gap * direction)[touching].sum())
        length /= float((change * direction)[touching].sum())
        old = pressure
        pressure = np.maximum(old - length * direction, 0)
        # A point that overlaps without pressure joins the contact, and the search
        # begins again from the steepest descent.
        joining = (pressure == 0) & (gap < 0)
        pressure[joining] -= length * gap[joining]
        conjugate = 0.0 if joining.any() else 1.0
        pressure *= mean_pressure / pressure.mean()
        if np.abs(pressure - old).sum() <= TOLERANCE * pressure.sum():
            return _settled(heights, pressure, influence, step)
    raise BadData(
        f"the contact of {heights.shape[0]} x {heights.shape[1]} points did not "
        f"settle in {MOST_STEPS} steps; coarsen the map or raise the load"
    )


def _settled(
    heights: FloatArray, pressure: FloatArray, influence: Influence, steps: int
) -> ElasticContact:
    gap = influence.displacement(pressure) - heights
    gap -= gap[pressure > 0].mean()
    return ElasticContact(pressure, np.where(pressure > 0, 0.0, gap), steps)
