# SPDX-License-Identifier: MIT
"""How far stiffness and damping are sure, and which input leaves the most open."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.arrays import FloatArray
from jointbench.analysis.contact.asperity import FractalSurface
from jointbench.analysis.contact.curve import contact_curve
from jointbench.analysis.contact.damping import (
    DampingChoice,
    damping_coefficient,
    loss_factor,
)
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.models import ContactModel, contact_model
from jointbench.analysis.contact.spread import (
    ContactSpread,
    DrawnInputs,
    StiffnessInterval,
    central_interval,
    draw_inputs,
)
from jointbench.analysis.contact.tangential import tangential_stiffness

SURFACE_INPUT = "surface (D and G)"
# Steps of the central differences: of D itself, of the logarithm of all others.
_STEP = 1e-4
_Z_LEVEL = 0.95
_Z = 1.959963984540054  # normal quantile of 97.5 %


@dataclass(frozen=True, slots=True)
class Uncertainty:
    """One predicted quantity with its uncertainty, found twice.

    Attributes:
        interval: central 95 % of the draws.
        first_order: lower and upper end by linear propagation in the logarithm.
        shares: of the variance, by input, largest first; D and G are one input, for a
            fit of a surface makes them go together.
    """

    interval: StiffnessInterval
    first_order: tuple[float, float]
    shares: Mapping[str, float]

    @property
    def dominant(self) -> str | None:
        """The input that leaves the most open, if any does."""
        return next((name for name, share in self.shares.items() if share > 0), None)


@dataclass(frozen=True, slots=True)
class JointUncertainty:
    """Uncertainty of a joint.

    Attributes:
        stiffness: of the normal stiffness [N/m].
        tangential: of the tangential stiffness without slip [N/m].
        damping: of the damping [N s/m]; None where it was not asked for.
    """

    stiffness: Uncertainty
    tangential: Uncertainty
    damping: Uncertainty | None


def predict_uncertainty(
    model: str | ContactModel,
    *,
    dimension: float,
    roughness: float,
    material: ContactMaterial,
    preload: float,
    spread: ContactSpread,
    gamma: float = 1.5,
    damping: DampingChoice | None = None,
    draws: int = 2000,
    seed: int = 0,
) -> JointUncertainty:
    """Propagate what is not sure of the inputs, by draws and to first order.

    Args:
        model: name or record.
        dimension: fractal dimension as the model wants it [-].
        roughness: fractal roughness G [m].
        material: composite modulus, hardness and so on.
        preload: [N]; its spread holds the nut factor's.
        spread: how uncertain these are.
        gamma: frequency ratio of the Weierstrass-Mandelbrot function [-].
        damping: what a damping coefficient is made of; None for none.
        draws: how many.
        seed: of the draws.

    Returns:
        Intervals and shares of variance for stiffnesses and damping.

    Raises:
        BadData: a number outside the model's range.
    """
    model = contact_model(model) if isinstance(model, str) else model
    drawn = draw_inputs(
        model,
        dimension=dimension,
        roughness=roughness,
        material=material,
        preload=preload,
        spread=spread,
        draws=draws,
        seed=seed,
    )
    steps = _steps(dimension, roughness, material, preload)
    by_draw = _evaluate(model, drawn, material, gamma, damping)
    by_step = _evaluate(model, steps, material, gamma, damping)
    found = [
        _uncertainty(many, few, spread, material, preload, drawn.outside)
        for many, few in zip(by_draw, by_step, strict=True)
    ]
    return JointUncertainty(
        found[0], found[1], found[2] if damping is not None else None
    )


def _steps(
    dimension: float, roughness: float, material: ContactMaterial, preload: float
) -> DrawnInputs:
    """Return the centre, then a step up and down of each input."""
    steps = np.zeros((5, 11))
    for row in range(5):
        steps[row, 1 + 2 * row : 3 + 2 * row] = _STEP, -_STEP
    factors = np.exp(steps)
    return DrawnInputs(
        dimension=dimension + steps[0],
        roughness=roughness * factors[1],
        preload=preload * factors[2],
        hardness=material.hardness * factors[3],
        friction=material.friction_factor * factors[4],
        outside=0.0,
    )


def _evaluate(
    model: ContactModel,
    inputs: DrawnInputs,
    material: ContactMaterial,
    gamma: float,
    damping: DampingChoice | None,
) -> list[FloatArray]:
    """Return both stiffnesses, and damping where it is asked for, of all inputs."""
    sums = contact_curve(
        model,
        dimension=inputs.dimension,
        roughness=inputs.roughness,
        material=material,
        preload=inputs.preload,
        hardness=inputs.hardness,
        friction=inputs.friction,
        gamma=gamma,
    )
    stiffness = sums.stiffness.sum(axis=0)
    both = [stiffness, tangential_stiffness(model, sums, material)]
    if damping is None:
        return both
    surface = FractalSurface(
        inputs.dimension, inputs.roughness, inputs.hardness, gamma, inputs.friction
    )
    factor = loss_factor(
        model,
        surface,
        material,
        np.log(sums.largest_area),
        form=damping.form,
        convention=damping.convention,
    )
    return [*both, damping_coefficient(factor, stiffness, damping)]


def _uncertainty(
    by_draw: FloatArray,
    by_step: FloatArray,
    spread: ContactSpread,
    material: ContactMaterial,
    preload: float,
    outside: float,
) -> Uncertainty:
    """Return intervals and shares of one quantity."""
    interval = central_interval(by_draw, level=_Z_LEVEL, outside=outside)
    centre = float(by_step[0])
    if not np.all(by_step > 0):
        return Uncertainty(interval, (centre, centre), {})
    slopes = (np.log(by_step[1::2]) - np.log(by_step[2::2])) / (2 * _STEP)
    first, second = slopes[0] * spread.dimension, slopes[1] * spread.log_roughness
    parts = {
        SURFACE_INPUT: first**2 + second**2 + 2 * spread.correlation * first * second,
        "preload": (slopes[2] * spread.preload / preload) ** 2,
        "hardness": (slopes[3] * spread.hardness / material.hardness) ** 2,
        "friction": (slopes[4] * spread.friction / material.friction_factor) ** 2,
    }
    variance = float(sum(parts.values()))
    width = math.exp(_Z * math.sqrt(variance))
    ordered = sorted(parts.items(), key=lambda item: -item[1])
    shares = {k: float(v) / variance for k, v in ordered} if variance > 0 else {}
    return Uncertainty(interval, (centre / width, centre * width), shares)
