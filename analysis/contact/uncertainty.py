# SPDX-License-Identifier: MIT
"""Uncertainty of stiffness and damping, and the share of each input."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.contact.contact_case import ContactCase
from jointbench.analysis.contact.curve import contact_curve
from jointbench.analysis.contact.damping import damping_coefficient, loss_factor
from jointbench.analysis.contact.draws import (
    DrawnInputs,
    StiffnessInterval,
    central_interval,
    draw_inputs,
)
from jointbench.analysis.contact.fractal_surface import FractalSurface
from jointbench.analysis.contact.tangential import tangential_stiffness

SURFACE_INPUT = "surface (D and G)"
# Steps of the central differences: of D itself, of the logarithm of all others.
_STEP = 1e-4
_Z_LEVEL = 0.95
_Z = 1.959963984540054  # normal quantile of 97.5 %


@dataclass(frozen=True, slots=True)
class Uncertainty:
    """One predicted quantity with its uncertainty by two methods.

    Attributes:
        interval: central 95 % of the draws.
        first_order: lower and upper end by linear propagation in the logarithm.
        shares: of the variance, by input, largest first; D and G are one input, because
            a fit of a surface correlates them.
    """

    interval: StiffnessInterval
    first_order: tuple[float, float]
    shares: Mapping[str, float]

    @property
    def dominant(self) -> str | None:
        """The input with the largest share of the variance, if any."""
        return next((name for name, share in self.shares.items() if share > 0), None)


@dataclass(frozen=True, slots=True)
class JointUncertainty:
    """Uncertainty of a joint.

    Attributes:
        stiffness: of the normal stiffness [N/m].
        tangential: of the tangential stiffness without slip [N/m].
        damping: of the damping [N s/m]; None where not requested.
    """

    stiffness: Uncertainty
    tangential: Uncertainty
    damping: Uncertainty | None


def predict_uncertainty(
    case: ContactCase, *, draws: int = 2000, seed: int = 0
) -> JointUncertainty:
    """Propagate the uncertainty of the inputs, by draws and to first order.

    Args:
        case: the joint, with the uncertainty of its inputs; the spread of the preload
            includes the nut factor's.
        draws: number of draws.
        seed: of the draws.

    Returns:
        Intervals and shares of variance for stiffnesses and damping.

    Raises:
        BadData: a number outside the model's range.
    """
    drawn = draw_inputs(case, draws=draws, seed=seed)
    by_draw, by_step = _evaluate(case, drawn), _evaluate(case, _steps(case))
    found = [
        _uncertainty(many, few, case, drawn.outside)
        for many, few in zip(by_draw, by_step, strict=True)
    ]
    return JointUncertainty(
        found[0], found[1], found[2] if case.conditions.damping is not None else None
    )


def _steps(case: ContactCase) -> DrawnInputs:
    """Return the centre, then a step up and down of each input."""
    steps = np.zeros((5, 11))
    for row in range(5):
        steps[row, 1 + 2 * row : 3 + 2 * row] = _STEP, -_STEP
    factors = np.exp(steps)
    return DrawnInputs(
        dimension=case.dimension + steps[0],
        roughness=case.surface.roughness * factors[1],
        preload=case.preload.value * factors[2],
        hardness=case.material.hardness * factors[3],
        friction=case.material.friction_factor * factors[4],
        outside=0.0,
    )


def _evaluate(case: ContactCase, inputs: DrawnInputs) -> list[FloatArray]:
    """Return both stiffnesses, and damping where requested, of all inputs."""
    sums = contact_curve(
        case.model,
        dimension=inputs.dimension,
        roughness=inputs.roughness,
        material=case.material,
        preload=inputs.preload,
        hardness=inputs.hardness,
        friction=inputs.friction,
        gamma=case.gamma,
    )
    stiffness = sums.stiffness.sum(axis=0)
    both = [stiffness, tangential_stiffness(case.model, sums, case.material)]
    damping = case.conditions.damping
    if damping is None:
        return both
    surface = FractalSurface(
        inputs.dimension, inputs.roughness, inputs.hardness, case.gamma, inputs.friction
    )
    factor = loss_factor(
        case.model,
        surface,
        case.material,
        np.log(sums.largest_area),
        form=damping.form,
        convention=damping.convention,
    )
    return [*both, damping_coefficient(factor, stiffness, damping)]


def _uncertainty(
    by_draw: FloatArray, by_step: FloatArray, case: ContactCase, outside: float
) -> Uncertainty:
    """Return intervals and shares of one quantity."""
    spread, material = case.spread, case.material
    interval = central_interval(by_draw, level=_Z_LEVEL, outside=outside)
    centre = float(by_step[0])
    if not np.all(by_step > 0):
        return Uncertainty(interval, (centre, centre), {})
    slopes = (np.log(by_step[1::2]) - np.log(by_step[2::2])) / (2 * _STEP)
    first, second = slopes[0] * spread.dimension, slopes[1] * spread.log_roughness
    parts = {
        SURFACE_INPUT: first**2 + second**2 + 2 * spread.correlation * first * second,
        "preload": (slopes[2] * spread.preload / case.preload.value) ** 2,
        "hardness": (slopes[3] * spread.hardness / material.hardness) ** 2,
        "friction": (slopes[4] * spread.friction / material.friction_factor) ** 2,
    }
    variance = float(sum(parts.values()))
    width = math.exp(_Z * math.sqrt(variance))
    ordered = sorted(parts.items(), key=lambda item: -item[1])
    shares = {k: float(v) / variance for k, v in ordered} if variance > 0 else {}
    return Uncertainty(interval, (centre / width, centre * width), shares)
