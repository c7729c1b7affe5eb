# SPDX-License-Identifier: MIT
"""Uncertainty of a predicted joint stiffness, by draws through the contact model."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.contact.contact_case import ContactCase
from jointbench.analysis.contact.curve import contact_curve


@dataclass(frozen=True, slots=True, eq=False)
class DrawnInputs:
    """Draws of all inputs, one array of equal length each.

    Attributes:
        dimension: inside the model's range [-].
        roughness: G [m].
        preload: [N].
        hardness: [Pa].
        friction: factor k_mu [-].
        outside: share of dimensions that were drawn outside the range.
    """

    dimension: FloatArray
    roughness: FloatArray
    preload: FloatArray
    hardness: FloatArray
    friction: FloatArray
    outside: float


@dataclass(frozen=True, slots=True)
class StiffnessInterval:
    """A predicted stiffness, or damping, with its uncertainty.

    Attributes:
        median: [N/m], or [N s/m].
        lower: lower end of the central interval, same unit.
        upper: upper end, same unit.
        level: probability that the interval covers [-].
        draws: number of draws.
        outside: share of draws with a dimension outside the model's range, drawn again.
    """

    median: float
    lower: float
    upper: float
    level: float
    draws: int
    outside: float


def predict_interval(
    case: ContactCase, *, level: float = 0.95, draws: int = 2000, seed: int = 0
) -> StiffnessInterval:
    """Predict an interval of the normal stiffness.

    Args:
        case: the joint, with the uncertainty of its inputs.
        level: probability of the interval [-].
        draws: number of draws.
        seed: of the draws; the same seed gives the same interval.

    Returns:
        Median and central interval over the draws. Preload and hardness are drawn
        lognormal, so that no draw is negative; ln G normal, correlated with D.

    Raises:
        BadData: a number outside the model's range, or a dimension so uncertain that
            fewer than half of the draws stay inside it.
    """
    drawn = draw_inputs(case, draws=draws, seed=seed)
    sums = contact_curve(
        case.model,
        dimension=drawn.dimension,
        roughness=drawn.roughness,
        material=case.material,
        preload=drawn.preload,
        hardness=drawn.hardness,
        friction=drawn.friction,
        gamma=case.gamma,
    )
    return central_interval(
        sums.stiffness.sum(axis=0), level=level, outside=drawn.outside
    )


def central_interval(
    values: FloatArray, *, level: float, outside: float
) -> StiffnessInterval:
    """Return median and central interval of draws [unit of `values`]."""
    tail = 0.5 * (1 - level)
    lower, median, upper = np.quantile(values, [tail, 0.5, 1 - tail])
    return StiffnessInterval(
        float(median), float(lower), float(upper), level, values.size, outside
    )


def draw_inputs(case: ContactCase, *, draws: int, seed: int) -> DrawnInputs:
    """Draw the inputs of a contact model; the same seed gives the same draws.

    Args:
        case: its numbers are the centres; its model sets the range of dimensions.
        draws: number of draws.
        seed: of the draws.

    Returns:
        Draws, those outside the model's range of dimensions replaced.

    Raises:
        BadData: fewer than half of the dimensions stay inside the range.
    """
    random = np.random.default_rng(seed)
    dimensions, logs, outside = _draw_surface(case, draws=draws, random=random)
    material, spread = case.material, case.spread
    return DrawnInputs(
        dimension=dimensions,
        roughness=case.surface.roughness * np.exp(logs),
        preload=_lognormal(case.preload.value, spread.preload, draws, random),
        hardness=_lognormal(material.hardness, spread.hardness, draws, random),
        friction=_lognormal(material.friction_factor, spread.friction, draws, random),
        outside=outside,
    )


def _draw_surface(
    case: ContactCase, *, draws: int, random: np.random.Generator
) -> tuple[FloatArray, FloatArray, float]:
    """Return dimensions in range, ln(G/roughness), and the share of rejected draws."""
    spread, model, dimension = case.spread, case.model, case.dimension
    first, second = random.standard_normal((2, 4 * draws))
    dimensions = dimension + spread.dimension * first
    rest = np.sqrt(1 - spread.correlation**2)
    logs = spread.log_roughness * (spread.correlation * first + rest * second)
    low = model.topography.lowest_dimension
    inside = (dimensions > low) & (dimensions < low + 1)
    if inside.mean() < 0.5:
        raise BadData(
            f"fractal dimension {dimension:g} +- {spread.dimension:g} is mostly "
            f"outside {low:g} to {low + 1:g} of model {model.name!r}; "
            "measure more or longer profiles, or choose another model"
        )
    return (
        dimensions[inside][:draws],
        logs[inside][:draws],
        float(1 - inside.mean()),
    )


def _lognormal(
    value: float, sd: float, draws: int, random: np.random.Generator
) -> FloatArray:
    """Return positive draws with median `value` and about the given sd."""
    if not value > 0:
        return np.full(draws, value)  # for the contact model to refuse by name
    return value * np.exp(sd / value * random.standard_normal(draws))
