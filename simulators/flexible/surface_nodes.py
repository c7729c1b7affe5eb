# SPDX-License-Identifier: MIT
"""Places on the sides of a body: moved along them, and nodes around them."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.simulators.flexible.flexible_specimen import (
    BodyPlace,
    BoltedSpecimen,
    ElasticBody,
    Vector,
)

_SPACING = 0.007  # [m]
_FEWEST = 7  # nodes along an edge
_NEAR = 0.07  # of a sensor or point [m]


def side_axes(body: ElasticBody, place: BodyPlace) -> tuple[int, int]:
    """Return the indices of the two axes along the side of a body at a place."""
    inside = body.within(place.position)
    to_side = np.minimum(np.abs(inside), np.abs(inside - np.array(body.block.size)))
    first, second = sorted(int(k) for k in np.argsort(to_side)[1:])
    return first, second


def along_side(body: ElasticBody, place: BodyPlace, u: float, v: float) -> Vector:
    """Return a place moved by u and v [m] along the side of its body."""
    moved = list(place.position)
    for axis, offset in zip(side_axes(body, place), (u, v), strict=True):
        moved[axis] += offset
    return moved[0], moved[1], moved[2]


def surface_nodes(specimen: BoltedSpecimen, index: int) -> FloatArray:
    """Return the nodes on the surface of a body near its places [m], (n_nodes, 3).

    Args:
        specimen: with its sensors and points.
        index: of the body.
    """
    body = specimen.bodies[index]
    every = (*specimen.points, *specimen.sensors)
    own = [_around(body, place) for place in every if place.body == index]
    return np.unique(np.round(np.concatenate(own), 9), axis=0)


def _around(body: ElasticBody, place: BodyPlace) -> FloatArray:
    """Return the nodes of the grid of a side that are near a place."""
    axes = side_axes(body, place)
    lines = [
        body.corner[k]
        + np.linspace(
            0.0,
            body.block.size[k],
            max(_FEWEST, 1 + round(body.block.size[k] / _SPACING)),
        )
        for k in axes
    ]
    first, second = np.meshgrid(*lines)
    nodes = np.tile(np.array(place.position), (first.size, 1))
    nodes[:, axes[0]], nodes[:, axes[1]] = first.ravel(), second.ravel()
    apart = np.linalg.norm(nodes - np.array(place.position), axis=1)
    return np.asarray(nodes[apart < _NEAR])
