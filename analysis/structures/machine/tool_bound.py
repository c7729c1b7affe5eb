# SPDX-License-Identifier: MIT
"""Bound of the error of the tool's receptance, compared with the unreduced machine."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.structures.machine.lean_machine import (
    LeanMachine,
    Variant,
    VariantState,
)
from jointbench.analysis.structures.machine.machine_result import (
    ReceptanceBound,
    ToolReceptance,
)
from jointbench.analysis.structures.machine.tool_response import rows_at
from jointbench.analysis.structures.reduction.predict_modes import JointValues
from jointbench.analysis.structures.reduction.receptance_bound import (
    DampedSolution,
    receptance_bound,
)

# A bound is computed at so many lines at most.
_MOST_LINES = 200


def direct_bound(
    lean: LeanMachine,
    variant: Variant,
    state: VariantState,
    point: str,
    tool: ToolReceptance,
) -> ReceptanceBound:
    """Bound the error of the direct receptances of a point, at some of their lines.

    Args:
        lean: the machine.
        variant: its values.
        state: all undamped modes at these values.
        point: its name.
        tool: its receptance.
    """
    few = np.linspace(0, tool.frequency.size - 1, _MOST_LINES).astype(int)
    kept = np.unique(few)
    lines = tool.frequency[kept]
    error = tool_bound(lean, variant, state, point, lines)
    size = np.abs(np.einsum("aal->al", tool.response[:, :, kept]))
    return ReceptanceBound(lines, size, np.einsum("aal->al", error))


def tool_bound(
    lean: LeanMachine,
    variant: Variant,
    state: VariantState,
    point: str,
    frequency: FloatArray,
) -> FloatArray:
    """Bound the error of the receptance at a point.

    The loss of the bodies is viscous damping of the computed modes; it is the same in
    the unreduced machine.

    Args:
        lean: the machine.
        variant: its values.
        state: all undamped modes at these values.
        point: its name.
        frequency: lines [Hz], shape (n_lines,).

    Returns:
        Largest size of the error [m/N], shape (3, 3, n_lines).
    """
    machine, poles = lean.machine, state.poles
    swings = poles.oscillates
    every = np.concatenate([poles.poles, poles.poles[swings].conj()])
    shapes = np.concatenate([poles.shapes, poles.shapes[:, swings].conj()], axis=1)
    weights = np.concatenate([poles.inputs, poles.inputs[swings].conj()])
    values = JointValues(
        machine.parameters(variant.stiffness, variant.rigid),
        np.concatenate([variant.damping, np.zeros(machine.rigid.size)]),
    )
    omega = 2.0 * np.pi * frequency
    # The residual is that of all modes: none is left to respond statically.
    solution = DampedSolution(
        model=lean.model,
        values=values,
        eigenvalue=state.eigenvalue,
        shapes=state.shapes,
        damping=state.damping - np.diag(state.loss_damping),
        modal_damping=state.loss_damping,
        structural=False,
        poles=every,
        vectors=shapes,
    )
    gain = weights[:, rows_at(lean, point)]
    lines = 1.0 / (1j * omega - every[:, None])
    response = np.stack([shapes @ (one[:, None] * lines) for one in gain.T], axis=1)
    body, port = machine.sides[point]
    number = machine.assembled.number(body)
    residual = machine.assembled.components[number].residual
    columns = slice(0, 3) if residual is None else residual.columns()[port]
    return receptance_bound(solution, (number, columns), response, omega)
