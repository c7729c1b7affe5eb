# SPDX-License-Identifier: MIT
"""How the springs of a joint are spread over it, where not evenly."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData

_NEAR = 8


@dataclass(frozen=True, slots=True, eq=False)
class SpringPattern:
    """Stiffness per area at places of a joint; only its ratios matter.

    Attributes:
        place: along both tangents, global coordinates [m], shape (n, 2).
        density: stiffness per area, 0 where the joint is open, shape (n,).
    """

    place: FloatArray
    density: FloatArray

    def __post_init__(self) -> None:
        """Check the numbers, and make the arrays read-only."""
        right = np.all(np.isfinite(self.place)) and np.all(np.isfinite(self.density))
        if not (right and np.all(self.density >= 0) and np.any(self.density > 0)):
            raise BadData(
                "a pattern of springs needs finite numbers, 0 or more, and one above 0"
            )
        freeze(self, "place", "density")

    def spread(self, place: FloatArray, area: FloatArray) -> FloatArray:
        """Return areas weighted by the pattern, with the same sum [m^2], shape (m,).

        Args:
            place: of points, as above [m], shape (m, 2).
            area: of each [m^2], shape (m,).

        Raises:
            BadData: the pattern is 0 at all of them.
        """
        near = min(_NEAR, self.density.size)
        distance, index = cKDTree(self.place).query(place, k=near)
        weight = 1 / (
            np.reshape(distance, (-1, near)) + 1e-3 * np.ptp(self.place, axis=0).max()
        )
        found = (weight * self.density[np.reshape(index, (-1, near))]).sum(axis=1)
        share = area * found / weight.sum(axis=1)
        if not share.sum() > 0:
            raise BadData(
                "the pattern of a joint has no stiffness on its surface; check that it "
                "belongs to this joint"
            )
        return np.asarray(share * area.sum() / share.sum())
