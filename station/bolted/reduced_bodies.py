# SPDX-License-Identifier: MIT
"""Meshed bodies reduced one by one: modes, and static response where forces act."""

from collections.abc import Mapping

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.reduction.component import (
    BodyMatrices,
    point_port,
)
from jointbench.analysis.structures.reduction.reduce_body import reduce_body
from jointbench.analysis.structures.reduction.structure_bodies import (
    body_matrices,
    body_ranges,
)
from jointbench.station.bolted.modal_rows import BodyModes

_POINTS = "hits and sensors"


def reduce_bodies(
    structure: Structure,
    areas: Mapping[str, FloatArray],
    points: FloatArray,
    band: float,
) -> BodyModes:
    """Reduce every body.

    Args:
        structure: matrices of the bodies.
        areas: relative motions of each bolted area, shape (n_rows, n_free).
        points: motion at hits and sensors, shape (n_rows, n_free).
        band: highest frequency [Hz].
    """
    ranges = body_ranges(structure)
    found = [
        reduced_body(
            body_matrices(structure, one),
            {name: rows[:, one.low : one.high] for name, rows in areas.items()},
            points[:, one.low : one.high],
            band,
        )
        for one in ranges
    ]
    sizes = [omega.size for omega, _ in found]
    basis = np.zeros((structure.size, sum(sizes)))
    first = 0
    for one, (omega, space) in zip(ranges, found, strict=True):
        basis[one.low : one.high, first : first + omega.size] = space
        first += omega.size
    return BodyModes(
        structure,
        tuple(one.name for one in ranges),
        np.repeat(np.arange(len(ranges)), sizes),
        np.concatenate([omega for omega, _ in found]),
        basis,
    )


def reduced_body(
    matrices: BodyMatrices,
    areas: Mapping[str, FloatArray],
    points: FloatArray,
    band: float,
) -> tuple[FloatArray, FloatArray]:
    """Reduce one body to its modes and its static response at areas and points.

    Args:
        matrices: of the body.
        areas: relative motions of each bolted area, shape (n_rows, n).
        points: motion at hits and sensors, shape (n_rows, n).
        band: highest frequency [Hz]; modes are kept up to twice that.

    Returns:
        Angular frequencies of the reduced coordinates [rad/s], and their motions,
        shape (n, n_modes).
    """
    rows = dict(areas) | {_POINTS: points[np.any(points, axis=1)]}
    ports = [point_port(name, one) for name, one in rows.items() if np.any(one)]
    found = reduce_body(matrices, ports, band)
    return np.sqrt(np.diag(found.stiffness)), found.basis
