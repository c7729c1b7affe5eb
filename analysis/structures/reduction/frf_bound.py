# SPDX-License-Identifier: MIT
"""Bound of the error of receptances that come from the poles of a small projection."""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.structures.reduction.assembled_response import (
    Projected,
    distinct,
    project,
    receptance,
    state_matrix,
)
from jointbench.analysis.structures.reduction.predict_modes import JointValues
from jointbench.analysis.structures.reduction.receptance_bound import (
    DampedSolution,
    receptance_bound,
)
from jointbench.analysis.structures.reduction.reduced_model import (
    ReducedModel,
    ReducedModes,
    solve_below,
    solve_reduced,
)

# The bound is that of a projection on the modes up to this multiple of the last line.
_REACH = 2.5
# ... and on those with dampers replaced by springs at these shares of that line.
_LOCKED = (1.0, 0.1)


def frf_bound(
    model: ReducedModel,
    values: JointValues,
    omega: FloatArray,
    rows: FloatArray,
    load: tuple[int, slice],
) -> FloatArray:
    """Bound the error of `receptance` between the rows of a port.

    It is the change by a projection on more modes, and the bound of that one's error.

    Args:
        model: of the assembly.
        values: of its joints.
        omega: lines [rad/s], shape (n_lines,); the highest sets the projection.
        rows: of the port from the coordinates of the model, shape (n_rows, r).
        load: number of its body, and its pattern columns.

    Returns:
        [m/N], shape (n_rows, n_rows, n_lines).
    """
    top = float(omega.max(initial=0.0))
    small = project(model, values, top, distinct(rows.T), _wider(model, values, top))
    level, turn = np.linalg.eigh(small.stiffness.real)
    level = np.maximum(level, 0.0)
    modal = Projected(
        small.space @ turn,
        turn.T @ small.stiffness @ turn,
        turn.T @ small.damping @ turn,
    )
    count = level.size
    pole, vector = np.linalg.eig(state_matrix(modal))
    force = np.zeros((2 * count, rows.shape[0]), complex)
    force[count:] = (rows @ modal.space).T
    weight = np.linalg.solve(vector, force)
    lines = 1.0 / (1j * omega - pole[:, None])
    response = np.stack(
        [vector[:count] @ (one[:, None] * lines) for one in weight.T], axis=1
    )
    few = replace(
        model,
        loss=modal.stiffness.imag,
        residual=model.residual.restricted(modal.space),
    )
    solution = DampedSolution(
        model=few,
        values=values,
        eigenvalue=level,
        shapes=np.eye(count),
        damping=modal.damping,
        modal_damping=np.zeros(count),
        structural=True,
        poles=pole,
        vectors=vector[:count],
    )
    better = np.einsum("or,ril->oil", rows @ modal.space, response)
    apart = np.abs(receptance(model, values, 1j * omega, rows, rows) - better)
    return np.asarray(apart + receptance_bound(solution, load, response, omega))


def _wider(
    model: ReducedModel, values: JointValues, top: float
) -> tuple[ReducedModes, FloatArray]:
    """Return modes beyond the last line, and those with the dampers locked."""
    limit = (_REACH * top) ** 2
    found = solve_reduced(model, values.stiffness, model.size)
    kept = max(int(np.searchsorted(found.eigenvalue, limit)), found.rigid)
    modes = ReducedModes(
        found.eigenvalue[:kept],
        found.natural_frequency[:kept],
        found.shapes[:, :kept],
        found.rigid,
    )
    locked = [
        solve_below(model, values.stiffness + share * top * values.damping, limit)
        for share in _LOCKED
        if values.damping.any()
    ]
    none = np.zeros((model.size, 0))
    return modes, np.concatenate([none, *(one.shapes for one in locked)], axis=1)
