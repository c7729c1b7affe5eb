# SPDX-License-Identifier: MIT
"""Results of a machine over its uncertain joints, by random samples."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.structures.machine.lean_machine import (
    LeanMachine,
    Variant,
    jointed,
    log_deviation,
    whole_machine,
)
from jointbench.analysis.structures.machine.machine_request import MachineRequest
from jointbench.analysis.structures.machine.reduce_machine import redrawn
from jointbench.analysis.structures.machine.stability_lobes import (
    stability_limit,
)
from jointbench.analysis.structures.machine.tool_response import (
    oriented_response,
    rows_at,
)
from jointbench.analysis.structures.reduction.full_modes import frequency_of

# Undamped modes that damping couples in variants and random samples; the results
# couple all.
COUPLED_SAMPLE = 60
_QUANTILES = (0.025, 0.975)
# Draws of measured bodies at most: each is an assembly of its own.
_MOST_DRAWS = 40


@dataclass(frozen=True, slots=True, eq=False)
class SampledIntervals:
    """95 % intervals over the uncertain joint values."""

    frequency: FloatArray
    receptance: FloatArray
    static: FloatArray
    limit: tuple[float, float] | None


def sample_joints(
    lean: LeanMachine, request: MachineRequest, lines: FloatArray
) -> SampledIntervals:
    """Propagate the deviations of joints, log-normal, and of measured bodies."""
    machine, nominal = lean.machine, jointed(lean.machine)
    deviation = log_deviation(machine.deviations)
    random = np.random.default_rng(request.seed)
    count = request.samples
    if machine.measured:
        count = min(count, _MOST_DRAWS)
    steps = random.standard_normal((count, *deviation.shape))
    rows = rows_at(lean, request.tool)
    levels, sizes, statics, limits = [], [], [], []
    for step in steps:
        factor = np.exp(deviation * step)
        one = Variant(nominal.stiffness * factor[0], nominal.damping * factor[1])
        own = lean if not machine.measured else whole_machine(redrawn(machine, random))
        state = own.state(one, COUPLED_SAMPLE)
        poles = state.poles
        response = poles.receptance(lines)[rows, rows]
        levels.append(frequency_of(state.eigenvalue[: request.modes]))
        sizes.append(np.abs(np.einsum("aal->al", response)))
        statics.append(np.diag(poles.receptance(np.zeros(1))[rows, rows, 0].real))
        if request.cut is not None:
            oriented = oriented_response(response, request.cut)
            limits.append(stability_limit(lines, oriented, request.cut.coefficient)[0])
    limit = _interval(limits)
    return SampledIntervals(
        _interval(levels),
        _interval(sizes),
        _interval(statics),
        (float(limit[0]), float(limit[1])) if limits else None,
    )


def _interval(samples: Sequence[FloatArray] | Sequence[float]) -> FloatArray:
    if not len(samples):
        return np.zeros(2)
    return np.asarray(
        np.quantile(np.array(samples), _QUANTILES, axis=0, method="nearest")
    )
