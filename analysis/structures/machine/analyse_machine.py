# SPDX-License-Identifier: MIT
"""Modes, energies, tool receptance, costs of joints, chatter, motion of a machine."""

from dataclasses import replace

import numpy as np
from scipy.optimize import linear_sum_assignment

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, IntArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.structures.machine.complex_modes import PoleSet
from jointbench.analysis.structures.machine.joint_samples import (
    COUPLED_SAMPLE,
    sample_joints,
)
from jointbench.analysis.structures.machine.lean_machine import (
    LeanMachine,
    Variant,
    VariantState,
    glued,
    jointed,
    lean_machine,
)
from jointbench.analysis.structures.machine.machine_request import MachineRequest
from jointbench.analysis.structures.machine.machine_result import (
    JointCost,
    MachineResult,
    ToolMotion,
    ToolReceptance,
    VariantModes,
    VariantResult,
)
from jointbench.analysis.structures.machine.reduce_machine import ReducedMachine
from jointbench.analysis.structures.machine.shape_shares import (
    modal_assurance,
    motion_shares,
    strain_shares,
)
from jointbench.analysis.structures.machine.stability_lobes import (
    StabilityLobes,
    stability_lobes,
)
from jointbench.analysis.structures.machine.tool_bound import direct_bound
from jointbench.analysis.structures.machine.tool_response import (
    oriented_response,
    rows_at,
)
from jointbench.analysis.structures.machine.transient import transient
from jointbench.analysis.structures.reduction.full_modes import frequency_of
from jointbench.analysis.structures.reduction.reduced_model import frequency_bound

# A complex mode is that of an undamped one if their shapes agree this much,
# and their frequencies differ by no more than this factor.
_SAME_SHAPE, _SAME_FREQUENCY = 0.5, 1.4
_SPEEDS = 600
# Lines are spaced evenly in the logarithm from this share of the band.
_LOWEST_LINE = 0.002
# Least damping ratio of the lines around a pole, and their offset.
_BESIDE = 1e-4


def analyse_machine(machine: ReducedMachine, request: MachineRequest) -> MachineResult:
    """Compute a machine glued and jointed.

    Args:
        machine: reduced.
        request: what to compute.

    Returns:
        The result.

    Raises:
        BadData: a body floats.
        UsageError: there is no such point.
    """
    if request.tool not in machine.points:
        raise UsageError(
            f"no point {request.tool!r}; the machine has {list(machine.points)}"
        )
    lean = lean_machine(machine, request.band_hz)
    nominal = jointed(machine)
    rigid_one = _variant_result(lean, glued(machine), request)
    soft_one = _variant_result(lean, nominal, request)
    spread = None
    if machine.deviations.any() or machine.measured:
        spread = sample_joints(lean, request, soft_one.tool.frequency)
    if spread is not None:
        tool = replace(
            soft_one.tool,
            interval=spread.receptance,
            static_interval=spread.static,
        )
        soft_one = replace(soft_one, tool=tool)
    frequency, bound = frequency_bound(
        machine.assembled.model, machine.parameters(machine.stiffness), request.modes
    )
    return MachineResult(
        glued=rigid_one,
        jointed=soft_one,
        pairs=_pairs(soft_one.modes, rigid_one.modes),
        costs=_costs(lean, nominal, request, soft_one.tool),
        frequency_interval=None if spread is None else spread.frequency,
        limit_interval=None if spread is None else spread.limit,
        freedoms=machine.freedoms,
        size=(machine.assembled.model.size, lean.model.size),
        bound=float((bound / frequency).max()),
        turn=lean.turn,
        speeds=machine.speeds,
    )


def _variant_result(
    lean: LeanMachine, variant: Variant, request: MachineRequest
) -> VariantResult:
    state = lean.state(variant)
    poles = state.poles
    tool = _receptance(lean, poles, request)
    if not lean.gyroscopic.any():
        bound = direct_bound(lean, variant, state, request.tool, tool)
        tool = replace(tool, bound=bound)
    motion = None
    if request.span is not None:
        few = poles.lowest(request.span.poles)
        span = request.span
        time, moved = transient(
            few,
            request.loads,
            duration=span.duration,
            step=span.step,
            begin=span.begin,
        )
        motion = ToolMotion(time, moved[rows_at(lean, request.tool)])
    return VariantResult(
        _modes(lean, variant, state, poles, request.modes),
        poles,
        tool,
        _chatter(tool.frequency, tool.response, request),
        motion,
    )


def _modes(
    lean: LeanMachine, variant: Variant, state: VariantState, poles: PoleSet, count: int
) -> VariantModes:
    count = min(count, state.eigenvalue.size)
    shapes = state.shapes[:, :count]
    omega = np.sqrt(state.eigenvalue[:count])
    swings = np.flatnonzero(poles.oscillates)
    found = _matching_ratios(state.eigenvalue[:count], poles, swings)
    lowest = swings[:count]
    return VariantModes(
        natural_frequency=frequency_of(state.eigenvalue[:count]),
        damping_ratio=found,
        first_order=np.diag(state.damping)[:count] / (2.0 * omega),
        overdamped=int((~poles.oscillates).sum()),
        oscillating=np.stack(
            [poles.natural_frequency[lowest], poles.damping_ratio[lowest]]
        ),
        energy=strain_shares(lean, variant, shapes),
        motion=motion_shares(lean, shapes),
        shapes=shapes,
    )


def _matching_ratios(
    eigenvalue: FloatArray, poles: PoleSet, swings: IntArray
) -> FloatArray:
    """Return the damping ratios of the complex modes of undamped ones [-].

    The coordinates of the poles are the undamped modes. Strong dampers lock their
    joints: a pole of a similar shape at another frequency is not the same mode.
    """
    count = eigenvalue.size
    if not swings.size:
        return np.full(count, np.nan)
    likeness = modal_assurance(
        np.eye(poles.shapes.shape[0], count), poles.shapes[:, swings]
    )
    change = poles.natural_frequency[swings] / frequency_of(eigenvalue)[:, None]
    near = (change < _SAME_FREQUENCY) & (change > 1.0 / _SAME_FREQUENCY)
    likeness = np.where(near, likeness, 0.0)
    best = likeness.argmax(axis=1)
    same = likeness[np.arange(count), best] >= _SAME_SHAPE
    return np.where(same, poles.damping_ratio[swings][best], np.nan)


def _lines(request: MachineRequest, poles: PoleSet) -> FloatArray:
    """Return lines over the band, closer together around lightly damped poles."""
    low = _LOWEST_LINE * request.band_hz
    even = np.geomspace(low, request.band_hz, request.lines // 2)
    inside = poles.oscillates & (poles.natural_frequency < request.band_hz)
    peaks, ratio = poles.natural_frequency[inside], poles.damping_ratio[inside]
    if not peaks.size:
        return even
    each = max(5, request.lines // (2 * peaks.size))
    around = np.sinh(np.linspace(-3.0, 3.0, each)) / np.sinh(3.0) * 8.0
    # On an undamped pole there is no receptance: the middle line is beside it.
    width = np.clip(ratio, _BESIDE, 0.1)[:, None]
    close = (peaks[:, None] * (1.0 + width * (around + _BESIDE))).ravel()
    close = close[(close > low) & (close < request.band_hz)]
    return np.unique(np.concatenate([even, close]))


def _receptance(
    lean: LeanMachine, poles: PoleSet, request: MachineRequest
) -> ToolReceptance:
    rows = rows_at(lean, request.tool)
    frequency = _lines(request, poles)
    response = poles.receptance(frequency)[rows, rows]
    static = poles.receptance(np.zeros(1))[rows, rows, 0].real
    direct = np.abs(np.einsum("aal->al", response))
    at = direct.argmax(axis=1)
    # Overdamped machines move most at rest.
    rest = np.diag(static) > direct.max(axis=1)
    largest = np.where(rest, np.diag(static), direct.max(axis=1))
    return ToolReceptance(
        frequency, response, static, largest, np.where(rest, 0.0, frequency[at])
    )


def _chatter(
    frequency: FloatArray, response: ComplexArray, request: MachineRequest
) -> StabilityLobes | None:
    cut = request.cut
    if cut is None:
        return None
    oriented = oriented_response(response, cut)
    speeds = np.linspace(*cut.speed, _SPEEDS)
    return stability_lobes(
        frequency, oriented, cut.coefficient, speeds, teeth=cut.teeth
    )


def _pairs(soft: VariantModes, rigid: VariantModes) -> FloatArray:
    """Return partners of the jointed modes, each glued mode once."""
    likeness = modal_assurance(soft.shapes, rigid.shapes)
    row, best = linear_sum_assignment(-likeness)
    return np.stack([best, likeness[row, best]], axis=1).astype(float)


def _costs(
    lean: LeanMachine, nominal: Variant, request: MachineRequest, tool: ToolReceptance
) -> tuple[JointCost, ...]:
    state = lean.state(nominal)
    rows = lean.points[request.tool] @ state.shapes
    bent = state.shapes @ (rows / state.eigenvalue).T
    shares = strain_shares(lean, nominal, bent)
    first = len(lean.machine.bodies)
    compliance = np.diag(tool.static)
    found = []
    for at, joint in enumerate(lean.machine.joints):
        held = replace(nominal, rigid=(at,), damping=_without(lean, nominal, at))
        stiff = lean.state(held, COUPLED_SAMPLE)
        better = _receptance(lean, stiff.poles, request)
        found.append(
            JointCost(
                joint.name,
                shares.share[:, first + at],
                np.diag(better.static) / compliance,
                better.largest / tool.largest,
            )
        )
    return tuple(found)


def _without(lean: LeanMachine, variant: Variant, joint: int) -> FloatArray:
    """Return the damping without that of a joint, which does not move any more."""
    return np.where(lean.machine.joint_of == joint, 0.0, variant.damping)
