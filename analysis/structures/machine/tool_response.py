# SPDX-License-Identifier: MIT
"""Rows of a point and the response across a cut."""

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray
from jointbench.analysis.structures.machine.lean_machine import (
    LeanMachine,
)
from jointbench.analysis.structures.machine.machine_request import Cut


def rows_at(lean: LeanMachine, point: str) -> slice:
    """Return the rows of x, y, z of a point among those of all points."""
    at = list(lean.points).index(point)
    return slice(3 * at, 3 * at + 3)


def oriented_response(response: ComplexArray, cut: Cut) -> ComplexArray:
    """Return the receptance along the chip thickness from the cutting force."""
    chip, force = (
        np.asarray(one) / np.linalg.norm(one) for one in (cut.chip, cut.force)
    )
    return np.asarray(np.einsum("a,abl,b->l", chip, response, force))
