# SPDX-License-Identifier: MIT
"""Responses to errors of the stiffness of the free bodies, each with all its records.

An error of a body's modal table is an element of its stiffness in its free modes (see
`table_errors`). It is one number, and changes all records, channels and modes at once:
to first order, an element dK between modes i and j changes the response H by

    dH = -dK (H_i H_j' + H_j H_i'),

where H_i and H_j are the closed responses of channels and hits in these modes (Fox and
Kapoor, AIAA J. 6 (1968), eq. 3, summed over the modes of the closed structure).
"""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, IntArray
from jointbench.analysis.gap.structure_response.closed_response import close
from jointbench.analysis.gap.structure_response.hit_response import (
    HitModel,
    struck_columns,
)
from jointbench.analysis.gap.structure_response.landing import landing_weights
from jointbench.analysis.gap.structure_response.structure_settings import STRUCTURE
from jointbench.analysis.gap.structure_response.table_errors import stiffness_errors


def responses_to_body_errors(model: HitModel, landing: FloatArray) -> FloatArray:
    """Return the change of the responses by each error of the bodies, one sd each.

    Args:
        model: of the hits in a window, at the joints of one torque.
        landing: tilts [rad] and offsets [m] of each hit, shape (n_records, 4).

    Returns:
        Accelerations [m/s^2], shape (n_records, n_errors, n_channels, n_samples).
    """
    bodies = model.state.bodies_of(model.campaign.bodies)
    rows = model.state.sensors_of(bodies)
    each = np.eye(bodies.omega.size)
    state = replace(model.state, sensors=each)
    flexibility = close(bodies, state, model.frame.s, each)
    weights = landing_weights(landing)
    columns = struck_columns(model.campaign, model.state, weights)
    left = (rows @ flexibility) * model.transfers()[:, :, None]
    right = np.einsum("lnm,rm->rln", flexibility, columns)
    right *= model.frame.force[:, :, None]
    first, second, stiffness = _elements(model)
    found = np.empty((len(columns), first.size, *model.shape))
    step = STRUCTURE.columns_at_once
    for at in range(0, first.size, step):
        some = slice(at, at + step)
        i, j = first[some], second[some]
        for record, moved in enumerate(right):
            lines = _changed(left, moved, i, j) * -stiffness[some, None, None]
            found[record, some] = model.frame.records(lines)
    return found


def _elements(model: HitModel) -> tuple[IntArray, IntArray, FloatArray]:
    """Return the two modes of each error, and the stiffness between them of one sd."""
    beside, diagonal = stiffness_errors(model.campaign, model.campaign.bodies)
    first, second = np.nonzero(np.triu(beside, 1))
    alone = np.flatnonzero(diagonal)
    # The two products of one mode are the same one.
    sd = [np.sqrt(beside[first, second]), np.sqrt(diagonal[alone]) / 2.0]
    return (
        np.concatenate([first, alone]),
        np.concatenate([second, alone]),
        np.concatenate(sd),
    )


def _changed(
    left: ComplexArray, right: ComplexArray, i: IntArray, j: IntArray
) -> ComplexArray:
    """Return both products of closed responses, shape (n, n_channels, n_lines)."""
    found = left[:, :, i] * right[:, None, j] + left[:, :, j] * right[:, None, i]
    return np.ascontiguousarray(found.transpose(2, 1, 0))
