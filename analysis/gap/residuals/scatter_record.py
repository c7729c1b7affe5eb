# SPDX-License-Identifier: MIT
"""Records of the scatter of hits: its directions, sizes, and outstanding hits."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze

FORCE_GAIN = "force gain"
CHANNEL_GAIN = "channel gain"
DELAY_OF_HIT = "force delay"
DELAY_OF_CHANNEL = "channel delay"
JOINT = "stiffness of "


@dataclass(frozen=True, slots=True)
class ScatterDirection:
    """A way in which hits scatter, with one size.

    Attributes:
        name: for example ``"force gain"``.
        unit: of its size, ``"-"`` or ``"s"``.
        columns: derivatives of the model that share the size.
        scale: size in that unit of an internal size of 1.
        expected: size that the nominal parameters state [unit]; 0 if none.
    """

    name: str
    unit: str
    columns: tuple[int, ...]
    scale: float = 1.0
    expected: float = 0.0

    @property
    def is_joint(self) -> bool:
        """Whether it is the stiffness of a joint."""
        return self.name.startswith(JOINT)


@dataclass(frozen=True, slots=True, eq=False)
class HitScatter:
    """Scatter from hit to hit along directions of the model.

    Attributes:
        directions: in the order of their columns.
        size: sd of each direction, in its internal unit, shape (n_directions,).
        rho: correlation between successive hits [-].
        sd: of each hit and column: larger for a hit that stands out, shape
            (n_records, n_columns).
        values: expected deviation of each hit, same shape.
        outstanding: record and column of each hit that stands out.
    """

    directions: tuple[ScatterDirection, ...]
    size: FloatArray
    rho: float
    sd: FloatArray
    values: FloatArray
    outstanding: tuple[tuple[int, int], ...] = ()

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "size", "sd", "values")

    def size_of(self, name: str) -> float:
        """Return the size of a direction in its unit; 0 if there is none."""
        found = [
            float(s) * d.scale
            for s, d in zip(self.size, self.directions, strict=True)
            if d.name == name
        ]
        return found[0] if found else 0.0

    @property
    def largest_share(self) -> float:
        """Largest size of the directions without unit: of gains and stiffnesses [-]."""
        sizes = zip(self.size, self.directions, strict=True)
        return max((float(s) * d.scale for s, d in sizes if d.unit == "-"), default=0.0)

    @property
    def joint_size(self) -> float:
        """Scatter of the first joint's stiffness [-]; 0 if there is no joint."""
        found = [k for k, d in enumerate(self.directions) if d.is_joint]
        return float(self.size[found[0]]) if found else 0.0

    @property
    def joint_values(self) -> FloatArray:
        """Expected log stiffness of the first joint in each hit, (n_records,)."""
        found = [d.columns[0] for d in self.directions if d.is_joint]
        return self.values[:, found[0]]


def no_scatter(directions: Sequence[ScatterDirection], hits: int) -> HitScatter:
    """Return the scatter of hits that do not scatter."""
    columns = sum(len(d.columns) for d in directions)
    none = np.zeros((hits, columns))
    return HitScatter(
        tuple(directions), np.zeros(len(directions)), 0.0, none, none.copy()
    )
