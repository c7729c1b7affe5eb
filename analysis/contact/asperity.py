# SPDX-License-Identifier: MIT
"""One asperity of a fractal surface: geometry, load and stiffness by regime.

The joint is the sum of these laws over the contact-area distribution; the closed form
of that sum is in `sums`.
"""

import math

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.contact.asperity_laws import (
    REGIME_BOUNDS,
    AsperityLaw,
    FullyPlastic,
    PowerLaw,
)
from jointbench.analysis.contact.fractal_surface import (
    FractalSurface,
    excess,
    surface_yield_ratio,
)
from jointbench.analysis.contact.material import (
    ContactMaterial,
)
from jointbench.analysis.contact.models import ContactModel, regime_laws

# Far above every regime bound; powers of it must not overflow.
_LARGEST_LOG_RATIO = 300.0


def log_ratio_at_unit_area(
    model: ContactModel, surface: FractalSurface, material: ContactMaterial
) -> FloatArray:
    """Return ln(delta / delta_c) of a contact of 1 m^2 [-].

    It is of moderate size where the critical area, its exponential over e, overflows a
    double.

    Args:
        model: topography and yield criterion count.
        surface: dimension, roughness, hardness.
        material: modulus and what else the yield criterion needs.

    Returns:
        b of ln(delta / delta_c) = b - e ln(a / m^2).

    Source:
        a = g R delta, delta = c a^((1-e)/2) and delta_c = kappa^2 R.
    """
    kappa = surface_yield_ratio(model, surface, material)
    e = excess(model, surface)
    log_c = model.topography.log_interference(e, surface.roughness, surface.gamma)
    log_shape = math.log(model.topography.shape)
    return np.asarray(2 * log_c + log_shape - 2 * np.log(kappa))


def log_critical_area(
    model: ContactModel, surface: FractalSurface, material: ContactMaterial
) -> FloatArray:
    """Return ln of the contact area below which an asperity yields.

    Args:
        model: topography and yield criterion count.
        surface: dimension, roughness, hardness.
        material: modulus and what else the yield criterion needs.

    Returns:
        ln(a_c / m^2); above about 700 the area itself overflows a double.

    Source:
        Appl. Sci. 2023, 13, 11680, eqs. (23) and (41); from a = g R delta and
        delta_c = kappa^2 R. Note: eq. (41) as printed counts pi^(2/(2-D)) twice.
    """
    at_unit = log_ratio_at_unit_area(model, surface, material)
    return np.asarray(at_unit / excess(model, surface))


def interference(
    model: ContactModel, surface: FractalSurface, area: FloatArray
) -> FloatArray:
    """Return the interference delta of contacts of `area` [m]."""
    e = excess(model, surface)
    log_c = model.topography.log_interference(e, surface.roughness, surface.gamma)
    return np.asarray(np.exp(log_c + (1 - e) / 2 * np.log(area)))


def interference_ratio(
    model: ContactModel,
    surface: FractalSurface,
    material: ContactMaterial,
    log_area: FloatArray,
) -> FloatArray:
    """Return delta / delta_c = (a_c / a)^e of contacts of exp(`log_area`) m^2 [-]."""
    at_unit = log_ratio_at_unit_area(model, surface, material)
    log_ratio = at_unit - excess(model, surface) * log_area
    return np.asarray(np.exp(np.minimum(log_ratio, _LARGEST_LOG_RATIO)))


def asperity_load(
    model: ContactModel,
    surface: FractalSurface,
    material: ContactMaterial,
    log_area: FloatArray,
) -> FloatArray:
    """Return the load on one contact of exp(`log_area`) m^2 [N].

    Args:
        model: laws of the regimes.
        surface: dimension, roughness, hardness.
        material: effective modulus and yield properties.
        log_area: ln(a / m^2), any shape that broadcasts with `surface`.

    Returns:
        Load [N], of the broadcast shape.

    Source:
        Kogut and Etsion 2002; Appl. Sci. 2023, 13, 11680, eqs. (16)-(22), where the
        elastic factor 4/3 E R^(1/2) delta^(3/2) has lost its exponent.
    """
    ratio = interference_ratio(model, surface, material, log_area)
    area = np.exp(log_area)
    kappa = surface_yield_ratio(model, surface, material)
    # P_c = 4/3 E R^(1/2) delta_c^(3/2) with delta_c = kappa^2 R and a = g R delta.
    critical = 4 / 3 * material.effective_modulus * kappa * area
    critical = critical / (model.topography.shape * ratio)
    loads = [
        law.pressure_factor * surface.hardness * area
        if isinstance(law, FullyPlastic)
        else law.coefficient * critical * np.clip(ratio, lower, upper) ** law.exponent
        for law, upper, lower in _laws_with_bounds(model)
    ]
    return _choose(ratio, loads)


def asperity_stiffness(
    model: ContactModel,
    surface: FractalSurface,
    material: ContactMaterial,
    log_area: FloatArray,
) -> FloatArray:
    """Return dP/d(approach) of one contact of exp(`log_area`) m^2 [N/m].

    The radius is constant while the interference grows.

    Args:
        model: laws of the regimes.
        surface: dimension, roughness, hardness.
        material: effective modulus and yield properties.
        log_area: ln(a / m^2), any shape that broadcasts with `surface`.

    Returns:
        Stiffness [N/m]: exponent times load over interference; 0 where plastic.

    Source:
        Hertz; Appl. Sci. 2023, 13, 11680, eqs. (30) and (32), corrected.
    """
    ratio = interference_ratio(model, surface, material, log_area)
    load = asperity_load(model, surface, material, log_area)
    slope = load / interference(model, surface, np.exp(log_area))
    return _choose(
        ratio,
        [
            0.0 * slope if isinstance(law, FullyPlastic) else _steepness(law) * slope
            for law in regime_laws(model)
        ],
    )


def _steepness(law: PowerLaw) -> float:
    """Return dP/d(delta) over P/delta [-]; the exponent, unless one is printed."""
    return law.slope / law.coefficient


def _laws_with_bounds(
    model: ContactModel,
) -> list[tuple[AsperityLaw, float, float]]:
    """Return law, upper and lower interference ratio of each regime."""
    return list(
        zip(regime_laws(model), REGIME_BOUNDS[:-1], REGIME_BOUNDS[1:], strict=True)
    )


def _choose(ratio: FloatArray, by_regime: list[FloatArray]) -> FloatArray:
    """Return, element by element, the value of the regime that `ratio` is in."""
    ratio, *values = np.broadcast_arrays(ratio, *by_regime)
    regimes = [ratio > lower for lower in REGIME_BOUNDS[1:]]
    return np.asarray(np.select(regimes, values))
