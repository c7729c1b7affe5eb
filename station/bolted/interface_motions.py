# SPDX-License-Identifier: MIT
"""Few relative motions of each bolted area, in place of those of all its nodes.

The modes of the assembled structure, its joints at their nominal stiffness, move the
two sides of an area against each other in a few patterns. The mean motion is always
kept; of the others, by direction, those that hold a share of the strain energy of a
mode.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
from jointbench.station.bolted.bolted_areas import AreaMotions

# Stiffness of a rigid direction, over that of the mass at the end of the band.
_HELD = 1e3
# Modes up to this multiple of the band show the motions.
_REACH = 2.0


@dataclass(frozen=True, slots=True, eq=False)
class BoltedArea:
    """One bolted area with the relative motions that are followed.

    Attributes:
        name: of the area.
        joint: that it belongs to.
        position: of its middle [m], shape (3,).
        rows: mean motion of the upper less the lower body along x, y and z, shape
            (3, n_free).
        spread: further patterns, orthonormal over the area, shape (n_spread, n_free).
        directions: of these, shape (n_spread,).
    """

    name: str
    joint: str
    position: FloatArray
    rows: FloatArray
    spread: FloatArray
    directions: IntArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "position", "rows", "spread", "directions")

    @property
    def every_row(self) -> FloatArray:
        """All rows, shape (3 + n_spread, n_free)."""
        return np.concatenate([self.rows, self.spread])


@dataclass(frozen=True, slots=True, eq=False)
class ReducedBodies:
    """Free bodies in reduced coordinates.

    Attributes:
        omega: [rad/s], shape (n,).
        basis: motion of the mesh, shape (n_free, n).
    """

    omega: FloatArray
    basis: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "omega", "basis")


def interface_motions(
    areas: Sequence[AreaMotions],
    bodies: ReducedBodies,
    stiffness: FloatArray,
    band: float,
    share: float,
) -> list[BoltedArea]:
    """Return the bolted areas with the relative motions that matter.

    Args:
        areas: with all polynomials.
        bodies: reduced with their static response to all of them.
        stiffness: nominal one of an area along x, y, z [N/m]; infinite if rigid.
        band: highest frequency [Hz].
        share: of the strain energy of a mode above which a pattern is kept [-].
    """
    top = 2.0 * np.pi * band
    mass = 1.0 / max(float((bodies.basis**2).sum(axis=1).max()), 1e-300)
    k = np.where(np.isfinite(stiffness), stiffness, _HELD * top**2 * mass)
    rows = [area.rows @ bodies.basis for area in areas]
    whole = np.diag(bodies.omega**2)
    for own in rows:
        for d in range(3):
            whole += k[d] * own[:, d].T @ own[:, d]
    value, vector = np.linalg.eigh(whole)
    kept = (value > (1e-3 * top) ** 2) & (value < (_REACH * top) ** 2)
    shapes = vector[:, kept] / np.sqrt(value[kept])
    return [
        _chosen(area, own @ shapes, k, share)
        for area, own in zip(areas, rows, strict=True)
    ]


def _chosen(
    area: AreaMotions, motion: FloatArray, stiffness: FloatArray, share: float
) -> BoltedArea:
    """Return an area with its principal patterns.

    Args:
        area: with all polynomials.
        motion: of the modes at unit strain energy, shape (n_polynomials, 3, n_modes).
        stiffness: along x, y, z [N/m].
        share: of the strain energy above which a pattern is kept [-].
    """
    spread, directions = [], []
    for d in range(3):
        turn, size, _ = np.linalg.svd(motion[1:, d], full_matrices=False)
        # Rocking and twisting belong to a rigid motion: never fewer than two.
        count = max(int(np.sum(stiffness[d] * size**2 > share)), 2)
        spread.append(turn[:, :count].T @ area.rows[1:, d])
        directions += [d] * spread[-1].shape[0]
    return BoltedArea(
        area.name,
        area.joint,
        area.position,
        area.rows[0],
        np.concatenate(spread),
        np.array(directions, dtype=np.int64),
    )
