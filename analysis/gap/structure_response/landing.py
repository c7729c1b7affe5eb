# SPDX-License-Identifier: MIT
"""Where and in which direction a hit met the structure, and its force columns.

A hit may land beside its point and tilt. Its force on the modes is a product: direction
of the force, times shape at the landing point. The nine columns of a hit point hold all
products of three force directions with the shape and its two derivatives.
"""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.structure_response.hit_campaign import HitCampaign
from jointbench.analysis.gap.structure_response.jointed_bodies import HitPoint

COLUMNS = 9
"""Columns of a hit point."""
DIRECTIONS_OF_A_HIT = 5
"""Two tilts, two offsets and the gain."""


def point_columns(point: HitPoint) -> FloatArray:
    """Return the force columns of a hit point in modes, shape (9, n_modes)."""
    frame = np.concatenate([point.direction[None], point.across])
    shapes = [point.rows, point.gradient[0], point.gradient[1]]
    return np.concatenate([frame @ shape for shape in shapes])


def landing_weights(landing: FloatArray) -> FloatArray:
    """Return the weight of each column for hits, shape (n_hits, 9).

    Args:
        landing: tilts [rad] and offsets [m] of each hit, shape (n_hits, 4).
    """
    ones = np.ones(len(landing))
    force = np.stack([ones, landing[:, 0], landing[:, 1]], axis=1)
    force /= np.linalg.norm(force, axis=1, keepdims=True)
    shape = np.stack([ones, landing[:, 2], landing[:, 3]], axis=1)
    return (shape[:, :, None] * force[:, None, :]).reshape(-1, COLUMNS)


def mean_landing(campaign: HitCampaign, point: str, landing: FloatArray) -> FloatArray:
    """Return the mean offset of the hits of a point along its surface [m], shape (2,).

    Args:
        campaign: with the surface around the point.
        point: its name.
        landing: tilts [rad] and offsets [m] of each hit, shape (n_hits, 4).
    """
    bodies = campaign.bodies
    index = [p.name for p in bodies.points].index(point)
    own = landing[campaign.hits.point == index, 2:]
    axes = list(bodies.around_points[point].axes)
    return np.asarray(own.mean(axis=0) @ bodies.points[index].across[:, axes])


def mark_missed(
    campaign: HitCampaign, landing: FloatArray, common: float, error: float
) -> str:
    """Return which mark all hits missed, in words; empty if none.

    Aim scatters from hit to hit. What the hits of a point have in common is no scatter
    of the aim, even where aim and tilt of each hit follow the records.

    Args:
        campaign: with the points and the sd of the aim.
        landing: tilts [rad] and offsets [m] of each hit, shape (n_hits, 4).
        common: mean offset that the scatter of the aim may have [sd of a hit].
        error: the same in sd of the mean of so many hits, where that is larger.
    """
    point, aim = campaign.hits.point, campaign.nominal.aim_sd
    for index in np.unique(point):
        own = landing[point == index, 2:]
        offset = float(np.linalg.norm(own.mean(axis=0)))
        if offset > aim * max(common, error / np.sqrt(len(own))):
            name = campaign.bodies.points[index].name
            return f"hits at {name} landed {1e3 * offset:.1f} mm beside it on average"
    return ""


def landing_slopes(landing: FloatArray) -> FloatArray:
    """Return slopes of the weights by tilts, offsets and gain, (n_hits, 5, 9)."""
    step = np.array([1e-6, 1e-6, 1e-9, 1e-9])
    weights = landing_weights(landing)
    slopes = np.empty((len(landing), DIRECTIONS_OF_A_HIT, COLUMNS))
    for k in range(4):
        up, down = landing.copy(), landing.copy()
        up[:, k] += step[k]
        down[:, k] -= step[k]
        change = landing_weights(up) - landing_weights(down)
        slopes[:, k] = change / (2 * step[k])
    slopes[:, 4] = weights
    return slopes
