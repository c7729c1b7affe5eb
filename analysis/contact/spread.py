# SPDX-License-Identifier: MIT
"""How uncertain a predicted joint stiffness is: draws through the contact model."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.arrays import FloatArray
from jointbench.acquisition.errors import BadData, UsageError
from jointbench.analysis.contact.curve import contact_curve
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.models import ContactModel, contact_model


@dataclass(frozen=True, slots=True)
class ContactSpread:
    """Standard deviations of what goes into a contact model.

    Attributes:
        dimension: of the fractal dimension [-].
        log_roughness: of ln G [-].
        correlation: between dimension and ln G [-]; a structure-function fit has a
            strong one.
        preload: [N].
        hardness: [Pa].
        friction: of the friction factor k_mu [-].
    """

    dimension: float = 0.0
    log_roughness: float = 0.0
    correlation: float = 0.0
    preload: float = 0.0
    hardness: float = 0.0
    friction: float = 0.0

    def __post_init__(self) -> None:
        """Check signs and the correlation."""
        for name in ("dimension", "log_roughness", "preload", "hardness", "friction"):
            if not 0 <= getattr(self, name) < np.inf:
                raise UsageError(
                    f"spread of {name} is {getattr(self, name)!r}, it cannot be "
                    "negative; give a standard deviation or 0"
                )
        if not -1 <= self.correlation <= 1:
            raise UsageError(
                f"correlation is {self.correlation!r}, it lies between -1 and 1"
            )


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
        draws: how many draws it rests on.
        outside: share of draws whose dimension left the model's range, drawn again.
    """

    median: float
    lower: float
    upper: float
    level: float
    draws: int
    outside: float


def predict_interval(
    model: str | ContactModel,
    *,
    dimension: float,
    roughness: float,
    material: ContactMaterial,
    preload: float,
    spread: ContactSpread,
    gamma: float = 1.5,
    level: float = 0.95,
    draws: int = 2000,
    seed: int = 0,
) -> StiffnessInterval:
    """Predict an interval of the normal stiffness.

    Args:
        model: name or record.
        dimension: fractal dimension as the model wants it [-].
        roughness: fractal roughness G [m].
        material: composite modulus, hardness and so on.
        preload: [N].
        spread: how uncertain these are.
        gamma: frequency ratio of the Weierstrass-Mandelbrot function [-].
        level: probability of the interval [-].
        draws: how many.
        seed: of the draws; the same seed gives the same interval.

    Returns:
        Median and central interval over the draws. Preload and hardness are drawn
        lognormal, so that no draw is negative; ln G normal, correlated with D.

    Raises:
        BadData: a number outside the model's range, or a dimension so uncertain that
            fewer than half of the draws stay inside it.
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
    sums = contact_curve(
        model,
        dimension=drawn.dimension,
        roughness=drawn.roughness,
        material=material,
        preload=drawn.preload,
        hardness=drawn.hardness,
        friction=drawn.friction,
        gamma=gamma,
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


def draw_inputs(
    model: ContactModel,
    *,
    dimension: float,
    roughness: float,
    material: ContactMaterial,
    preload: float,
    spread: ContactSpread,
    draws: int,
    seed: int,
) -> DrawnInputs:
    """Draw what goes into a contact model; the same seed draws the same.

    Args:
        model: whose range of dimensions counts.
        dimension: centre [-].
        roughness: G, centre [m].
        material: hardness and friction factor are centres.
        preload: centre [N].
        spread: standard deviations.
        draws: how many.
        seed: of the draws.

    Returns:
        Draws, those outside the model's range of dimensions replaced.

    Raises:
        BadData: fewer than half of the dimensions stay inside the range.
    """
    random = np.random.default_rng(seed)
    dimensions, logs, outside = _draw_surface(
        model, dimension, spread, draws=draws, random=random
    )
    return DrawnInputs(
        dimension=dimensions,
        roughness=roughness * np.exp(logs),
        preload=_lognormal(preload, spread.preload, draws, random),
        hardness=_lognormal(material.hardness, spread.hardness, draws, random),
        friction=_lognormal(material.friction_factor, spread.friction, draws, random),
        outside=outside,
    )


def _draw_surface(
    model: ContactModel,
    dimension: float,
    spread: ContactSpread,
    *,
    draws: int,
    random: np.random.Generator,
) -> tuple[FloatArray, FloatArray, float]:
    """Return dimensions in range, ln(G/roughness), and the share drawn in vain."""
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
            "measure more or longer profiles, or take another model"
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
