# SPDX-License-Identifier: MIT
"""Load and stiffness of a whole joint: asperity laws summed in closed form.

Every law is a power of the contact area, so all sums are
A * scale * J(s; lo, hi), J the integral of a^(s-1) between the regime's bounds, both
clipped to the largest area. Areas and factors are kept as logarithms: the bounds span
thousands of decades as the fractal dimension nears its ends, so no area, least of all
the critical one, can serve as a unit.
"""

import math
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.contact.asperity import (
    log_critical_area,
    log_ratio_at_unit_area,
)
from jointbench.analysis.contact.asperity_laws import (
    REGIME_BOUNDS,
    AsperityLaw,
    PowerLaw,
    bears_nothing,
)
from jointbench.analysis.contact.fractal_surface import (
    FractalSurface,
    excess,
    surface_yield_ratio,
)
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.models import ContactModel, regime_laws


@dataclass(frozen=True, slots=True, eq=False)
class JointSums:
    """Load and stiffness of a joint for given largest contact areas.

    Attributes:
        largest_area: area of the largest contact a_l [m^2], shape (...).
        log_critical_area: ln of the area below which asperities yield, in m^2 [-],
            shape (...).
        real_area: sum of all contact areas [m^2], shape (...).
        load: by regime [N], shape (4, ...), in the order of `REGIMES`.
        stiffness: by regime [N/m], shape (4, ...).
    """

    largest_area: FloatArray
    log_critical_area: FloatArray
    real_area: FloatArray
    load: FloatArray
    stiffness: FloatArray

    @property
    def critical_area(self) -> FloatArray:
        """Area below which asperities yield a_c [m^2]; inf where a double overflows."""
        with np.errstate(over="ignore"):
            return np.asarray(np.exp(self.log_critical_area))


@dataclass(frozen=True, slots=True, eq=False)
class _Sum:
    """Common parts of one sum: a_l, bounds, factors; arrays that broadcast."""

    excess: FloatArray
    log_ratio: FloatArray  # ln of delta / delta_c at 1 m^2
    log_largest: FloatArray
    log_population: FloatArray  # ln of A = f q a_l^q
    log_hard: FloatArray  # ln of H times 1 m^2 [N]
    log_load: FloatArray  # ln of 4/3 E kappa / g times 1 m^2 [N]
    log_slope: float  # ln of 4/3 E / sqrt(g) times 1 m [N/m]

    def bound(self, ratio: float) -> FloatArray:
        """Return ln of the area whose interference ratio is `ratio`, at most a_l."""
        log_area = (self.log_ratio - math.log(ratio)) / self.excess
        return np.asarray(np.minimum(log_area, self.log_largest))

    def limits(self, upper: float, lower: float) -> tuple[FloatArray, FloatArray]:
        """Return ln of the integration limits of a regime, clipped to a_l."""
        high = self.bound(lower) if lower else self.log_largest
        return self.bound(upper), high


def power_integral(
    exponent: FloatArray,
    log_low: FloatArray,
    log_high: FloatArray,
    log_factor: FloatArray | float = 0.0,
) -> FloatArray:
    """Integrate x^(exponent - 1) from exp(`log_low`) to exp(`log_high`).

    Args:
        exponent: s, any shape; 0 gives the logarithm.
        log_low: ln of the lower limit, finite.
        log_high: ln of the upper limit, finite and at least `log_low`.
        log_factor: ln of a factor, included in the exponent against overflow.

    Returns:
        The integral, 0 where the limits meet; exact to rounding at and near s = 0.
    """
    # Factor out the larger end: the rest is between 0 and 1.
    width = log_high - log_low
    span = np.abs(exponent) * width
    small = span < 1e-5
    safe = np.where(small, 1.0, span)
    mean = np.where(small, 1 - span / 2 + span**2 / 6, -np.expm1(-safe) / safe)
    end = np.where(exponent >= 0, log_high, log_low)
    return np.asarray(np.exp(exponent * end + log_factor) * width * mean)


def joint_sums(
    model: ContactModel,
    surface: FractalSurface,
    material: ContactMaterial,
    log_largest: FloatArray,
) -> JointSums:
    """Sum load and stiffness over all contacts up to the largest.

    Args:
        model: its terms.
        surface: dimension, roughness and hardness of one or many surfaces.
        material: effective modulus and yield properties.
        log_largest: ln(a_l / m^2), broadcast with the surfaces.

    Returns:
        Load and stiffness by regime; continuous in `log_largest`.

    Source:
        Appl. Sci. 2023, 13, 11680, eqs. (24)-(48), and 2025, 15, 9040, eqs. (6)-(8),
        re-derived: there each regime and dimension has a separate formula, with
        misprints. Note: limits are clipped to the largest area, which the papers omit.
    """
    total = _prepare(model, surface, material, log_largest)
    log_critical = log_critical_area(model, surface, material)
    regimes = list(
        zip(regime_laws(model), REGIME_BOUNDS[:-1], REGIME_BOUNDS[1:], strict=True)
    )
    e = excess(model, surface)
    real_area = model.population * (1 + e) / (1 - e) * np.exp(log_largest)
    return JointSums(
        largest_area=np.exp(log_largest + 0 * real_area),
        log_critical_area=log_critical + 0 * real_area,
        real_area=real_area,
        load=np.stack([_load(total, *regime) for regime in regimes]),
        stiffness=np.stack([_stiffness(total, *regime) for regime in regimes]),
    )


def _prepare(
    model: ContactModel,
    surface: FractalSurface,
    material: ContactMaterial,
    log_largest: FloatArray,
) -> _Sum:
    """Collect the factors common to all regimes."""
    e = excess(model, surface)
    kappa = surface_yield_ratio(model, surface, material)
    stiff = math.log(4 / 3 * material.effective_modulus)
    log_shape = math.log(model.topography.shape)
    growth = (1 + e) / 2
    return _Sum(
        excess=e,
        log_ratio=log_ratio_at_unit_area(model, surface, material),
        log_largest=np.asarray(log_largest),
        log_population=np.log(model.population * growth) + growth * log_largest,
        log_hard=np.log(surface.hardness),
        log_load=stiff + np.log(kappa) - log_shape,
        log_slope=stiff - 0.5 * log_shape,
    )


def _load(total: _Sum, law: AsperityLaw, upper: float, lower: float) -> FloatArray:
    """Return the load of one regime [N]."""
    e = total.excess
    if bears_nothing(law):
        return np.zeros(np.broadcast(total.log_population, total.log_load).shape)
    if isinstance(law, PowerLaw):
        # P = coefficient * 4/3 E kappa a/g * s^(exponent - 1), s = delta/delta_c.
        exponent = (1 + e) / 2 - law.exponent * e
        factor = total.log_population + total.log_load + math.log(law.coefficient)
        factor = factor + (law.exponent - 1) * total.log_ratio
        return power_integral(exponent, *total.limits(upper, lower), factor)
    exponent = (1 - e) / 2
    factor = total.log_population + total.log_hard + math.log(law.pressure_factor)
    if math.isinf(upper):  # down to zero area; the exponent is positive
        return np.asarray(np.exp(factor + exponent * total.bound(lower)) / exponent)
    return power_integral(exponent, *total.limits(upper, lower), factor)


def _stiffness(total: _Sum, law: AsperityLaw, upper: float, lower: float) -> FloatArray:
    """Return the stiffness of one regime [N/m]."""
    if not isinstance(law, PowerLaw) or bears_nothing(law):
        return np.zeros(np.broadcast(total.log_population, total.log_load).shape)
    # dP/d(delta) = slope * 4/3 E sqrt(a/g) * s^(exponent - 3/2).
    factor = total.log_population + total.log_slope + math.log(law.slope)
    factor = factor + (law.exponent - 1.5) * total.log_ratio
    exponent = (1 - law.exponent) * total.excess
    return power_integral(exponent, *total.limits(upper, lower), factor)
