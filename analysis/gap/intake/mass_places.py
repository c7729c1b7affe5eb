# SPDX-License-Identifier: MIT
"""Places of bodies at which a mass or an oscillator may sit."""

from collections.abc import Sequence

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.structure_response.jointed_bodies import (
    HitPoint,
    MassPlace,
)

Vector = tuple[float, ...] | None
PlacedSensor = tuple[str, int, Vector, Vector]
"""Channel, index of its body, position [m], direction."""


def motion_across(
    sensors: Sequence[PlacedSensor], sites: Sequence[FloatArray] | None, *, total: int
) -> FloatArray:
    """Return the motion along the two axes most at right angles to each sensor."""
    if sites is None or any(direction is None for *_, direction in sensors):
        return np.zeros((0, 2, total))
    found = []
    for (*_, direction), site in zip(sensors, sites, strict=True):
        along = np.abs(np.asarray(direction, dtype=float))
        found.append(site[np.sort(np.argsort(along)[:2])])
    return np.array(found)


def numbered_places(name: str, rows: FloatArray) -> list[MassPlace]:
    """Return numbered points, such as the bolts of a body.

    Args:
        name: what they are.
        rows: their motion, shape (n_points, 3, n_modes).
    """
    none = np.zeros((0, rows.shape[2]))
    return [MassPlace(f"{name} {k}", one, none) for k, one in enumerate(rows)]


def point_places(points: Sequence[HitPoint]) -> list[MassPlace]:
    """Return hammer points, free or along the direction of a hit."""
    return [
        MassPlace(p.name, p.rows, np.abs(p.direction)[None] @ p.rows) for p in points
    ]


def sensor_places(
    sensors: Sequence[PlacedSensor],
    rows: Sequence[FloatArray],
    sites: Sequence[FloatArray] | None,
) -> list[MassPlace]:
    """Return a place for each sensor position, with all directions known there."""
    groups: dict[tuple[object, ...], list[int]] = {}
    for k, (name, body, position, _) in enumerate(sensors):
        groups.setdefault((body, position or name), []).append(k)
    found = []
    for own in groups.values():
        measured = np.array([rows[k] for k in own])
        whole = measured if sites is None else sites[own[0]]
        found.append(MassPlace(sensors[own[0]][0], whole, measured[:1]))
        found += [
            MassPlace(sensors[k][0], np.zeros_like(whole[:0]), rows[k][None])
            for k in own[1:]
        ]
    return found
