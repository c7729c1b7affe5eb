# SPDX-License-Identifier: MIT
"""Two elastic bodies on bolts, with feet, points under the hammer and sensors."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.simulators.flexible.block_modes import (
    RIGID,
    BlockModes,
    ElasticBlock,
    block_modes,
)

Vector = tuple[float, float, float]

BODY_NAMES = ("bottom", "top")

_HIGHEST = 7500.0  # natural frequencies in a modal table [Hz]

_FEWEST, _MOST = 14, 32  # elastic modes in a modal table

_SEARCHED = 60


@dataclass(frozen=True, slots=True)
class ElasticBody:
    """A block in its place.

    Attributes:
        name: one of `BODY_NAMES`.
        material: its name.
        block: its size and material.
        corner: with the least coordinates [m].
    """

    name: str
    material: str
    block: ElasticBlock
    corner: Vector

    def modes(self, elastic: int) -> BlockModes:
        """Return the free modes, six of them rigid."""
        shortest = min(self.block.size)
        terms = [
            int(np.clip(round(5 + 0.6 * side / max(shortest, 0.02)), 4, 20))
            for side in self.block.size
        ]
        return block_modes(
            self.block, terms=(terms[0], terms[1], terms[2]), elastic=elastic
        )

    def within(self, place: Vector) -> FloatArray:
        """Return a place from the corner of the body [m], shape (3,)."""
        return np.asarray(np.subtract(place, self.corner), dtype=float)

    def holds(self, place: Vector) -> bool:
        """Return whether a place is in the body or on its surface."""
        inside = self.within(place)
        edge = 1e-6  # [m]
        return bool(
            np.all((inside > -edge) & (inside < np.array(self.block.size) + edge))
        )


@dataclass(frozen=True, slots=True)
class BodyPlace:
    """A place on a body, with a direction.

    Attributes:
        name: of the sensor or of the point under the hammer.
        body: index of the body.
        position: [m].
        direction: unit vector.
    """

    name: str
    body: int
    position: Vector
    direction: Vector


@dataclass(frozen=True, slots=True)
class BoltedSpecimen:
    """Two bodies on bolts.

    Attributes:
        kind: one of `SPECIMEN_KINDS`.
        bodies: bottom and top; their interface is normal to z.
        bolts: places in the interface [m].
        feet: places under the bottom body [m].
        points: under the hammer.
        sensors: accelerometers, one direction each.
    """

    kind: str
    bodies: tuple[ElasticBody, ElasticBody]
    bolts: tuple[Vector, ...]
    feet: tuple[Vector, ...]
    points: tuple[BodyPlace, ...]
    sensors: tuple[BodyPlace, ...]


def table_size(body: ElasticBody) -> int:
    """Return the number of elastic modes that a modal table of a body lists."""
    frequency = body.modes(_SEARCHED).frequency[RIGID:]
    return int(np.clip(np.sum(frequency < _HIGHEST), _FEWEST, _MOST))
