# SPDX-License-Identifier: MIT
"""The largest contact area that carries a load, for many joints at once.

The regimes below that of the largest contact are complete: their integrals are
    constants of the joint, so a step of the search needs only one partial integral. All
    is in logarithms, because areas span hundreds of decades.
"""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.contact.asperity import log_ratio_at_unit_area
from jointbench.analysis.contact.asperity_laws import (
    REGIME_BOUNDS,
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

# Joints per batch: their arrays fit the processor's cache.
_BLOCK = 4096
_MOST_STEPS = 100
# About 20 ulp of ln(area): a step below this is rounding.
_STEP_TOLERANCE = 3e-15


@dataclass(frozen=True, slots=True, eq=False)
class _Regimes:
    """Constants of some joints; arrays of shape (4, n) in the order of `REGIMES`."""

    growth: FloatArray  # q, shape (n,)
    exponent: FloatArray  # s of the integral of a^(s-1)
    log_scale: FloatArray  # ln of the load's factor over the wanted load
    log_low: FloatArray  # ln of the regime's smallest area
    log_below: FloatArray  # ln of the load of all regimes below


def solve_largest_area(
    model: ContactModel,
    surface: FractalSurface,
    material: ContactMaterial,
    load: FloatArray,
) -> FloatArray:
    """Find the largest contact area that carries `load`; load rises with it.

    Args:
        model: its terms.
        surface: dimension, roughness and hardness.
        material: effective modulus and yield properties.
        load: preload [N], broadcast with the surfaces, positive.

    Returns:
        ln(a_l / m^2) of the broadcast shape, to rounding.
    """
    e = excess(model, surface)
    log_ratio = log_ratio_at_unit_area(model, surface, material)
    kappa = surface_yield_ratio(model, surface, material)
    arrays = np.broadcast_arrays(e, log_ratio, kappa, surface.hardness, load)
    flat = [np.ravel(array) for array in arrays]
    found = np.empty(arrays[0].size)
    for start in range(0, found.size, _BLOCK):
        block = slice(start, start + _BLOCK)
        parts = [array[block] for array in flat]
        regimes = _regimes(model, material.effective_modulus, *parts)
        found[block] = _search(regimes)
    return found.reshape(arrays[0].shape)


def _regimes(
    model: ContactModel,
    modulus: float,
    e: FloatArray,
    log_ratio: FloatArray,
    kappa: FloatArray,
    hardness: FloatArray,
    load: FloatArray,
) -> _Regimes:
    """Collect exponent, factor and bound of each regime, and the load below it."""
    wanted = np.log(load) - np.log(model.population * (1 + e) / 2)
    elastic = np.log(4 / 3 * modulus * kappa / model.topography.shape) - wanted
    hard = np.log(hardness) - wanted
    below = np.full_like(e, -np.inf)
    rows: list[tuple[FloatArray, FloatArray, FloatArray, FloatArray]] = []
    laws = zip(regime_laws(model), pairwise(REGIME_BOUNDS), strict=True)
    for law, (upper, lower) in laws:
        if isinstance(law, PowerLaw):
            exponent = (1 + e) / 2 - law.exponent * e
            factor = elastic + (law.exponent - 1) * log_ratio
            coefficient = law.coefficient
        else:
            exponent, factor, coefficient = (1 - e) / 2, hard, law.pressure_factor
        if bears_nothing(law):
            factor, coefficient = np.full_like(e, -np.inf), 1.0
        scale = factor + math.log(coefficient)
        low = (log_ratio - math.log(upper)) / e
        rows.append((exponent, scale, low, below))
        if lower:
            high = (log_ratio - math.log(lower)) / e
            below = np.logaddexp(below, scale + _log_integral(exponent, low, high))
    columns = [np.stack(column) for column in zip(*rows, strict=True)]
    return _Regimes((1 + e) / 2, *columns)


def _log_integral(
    exponent: FloatArray, log_low: FloatArray, log_high: FloatArray
) -> FloatArray:
    """Return ln of the integral of a^(exponent - 1); down to 0 where low is -inf."""
    width = log_high - log_low
    span = np.abs(exponent) * width
    small = span < 1e-5
    safe = np.where(small, 1.0, span)
    with np.errstate(divide="ignore", invalid="ignore"):
        # ln of width (1 - e^-span)/span, without the 0/0 of a vanishing exponent.
        mean = np.where(
            small,
            np.log(width) - span / 2,
            np.log(-np.expm1(-safe)) - np.log(np.abs(exponent)),
        )
    end = np.where(exponent >= 0, log_high, log_low)
    return np.asarray(exponent * end + mean)


def _excess_load(
    regimes: _Regimes, log_area: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return ln(load/wanted) and its derivative by ln a_l."""
    number = (log_area[None] > regimes.log_low[1:]).sum(axis=0)
    columns = np.arange(log_area.size)
    exponent = regimes.exponent[number, columns]
    scale = regimes.log_scale[number, columns]
    low = regimes.log_low[number, columns]
    partial = scale + _log_integral(exponent, low, np.maximum(log_area, low))
    total = np.logaddexp(regimes.log_below[number, columns], partial)
    slope = regimes.growth + np.exp(scale + exponent * log_area - total)
    return regimes.growth * log_area + total, slope


def _search(regimes: _Regimes) -> FloatArray:
    """Return ln a_l by Newton steps inside a shrinking bracket."""
    first = np.isfinite(regimes.log_scale).argmax(axis=0)
    edge = np.take_along_axis(regimes.log_low, first[None], axis=0)[0]
    # Where all contacts are plastic, load is proportional to area, and the start is the
    # solution.
    here = np.log(regimes.exponent[0]) - regimes.log_scale[0]
    here = np.where(first > 0, edge + 1.0, here)
    difference, slope = _excess_load(regimes, here)
    # ln(load) rises by at least q for every ln(a_l).
    reach = np.abs(difference) / regimes.growth + 1e-12
    low = np.maximum(here - np.where(difference > 0, reach, 0.0), edge)
    high = here + np.where(difference < 0, reach, 0.0)
    for _ in range(_MOST_STEPS):
        newton = here - difference / slope
        inside = (newton > low) & (newton < high)
        following = np.where(inside, newton, 0.5 * (low + high))
        step = np.abs(following - here)
        # At the end of its bracket a solution is exact to rounding.
        here = following
        difference, slope = _excess_load(regimes, here)
        low = np.where(difference < 0, here, low)
        high = np.where(difference > 0, here, high)
        if np.all((step <= _STEP_TOLERANCE * (20 + np.abs(here))) | (difference == 0)):
            break
    return np.asarray(here)
