# SPDX-License-Identifier: MIT
"""Work of loading a rough joint, and the part recovered by unloading.

Work is the integral of the load laws themselves, so that full plasticity includes its
load; only the recovered part needs quadrature, because the exponents of the unloading
law change with the interference.
"""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.contact.asperity import log_critical_area
from jointbench.analysis.contact.asperity_laws import REGIME_BOUNDS, PowerLaw
from jointbench.analysis.contact.fractal_surface import (
    FractalSurface,
    excess,
    surface_yield_ratio,
)
from jointbench.analysis.contact.joint_sums import power_integral
from jointbench.analysis.contact.material import ContactMaterial
from jointbench.analysis.contact.models import ContactModel, regime_laws

# e^-45 of an integral is below rounding; that length is divided into Gauss panels.
_LONGEST = 45.0
_PANELS = 6
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
_BISECTIONS = 60


@dataclass(frozen=True, slots=True, eq=False)
class JointEnergy:
    """Work done on a joint by its first loading, by regime.

    Attributes:
        loading: work of the load [J], shape (4, ...), as `REGIMES`.
        recovered: by unloading [J], same shape.
        dissipated: loading less recovered, not negative for any contact [J].
    """

    loading: FloatArray
    recovered: FloatArray
    dissipated: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class _Stage:
    """One regime: load is factor * P_c * s^exponent, `before` the work below it."""

    factor: FloatArray
    exponent: float
    upper: float  # of s
    lower: float
    before: FloatArray  # work up to s = lower, in P_c delta_c

    def work(self, s: FloatArray) -> FloatArray:
        """Return the work of loading one contact to `s` [P_c delta_c]."""
        p = self.exponent + 1
        return np.asarray(self.before + self.factor * (s**p - self.lower**p) / p)

    def recovered(self, s: FloatArray) -> FloatArray:
        """Return the recovered work of unloading one contact from `s` [P_c delta_c]."""
        return np.asarray(self.factor * s ** (self.exponent + 1) * recovered_share(s))


@dataclass(frozen=True, slots=True, eq=False)
class _Scale:
    """Factors common to all regimes."""

    excess: FloatArray
    log_x: FloatArray
    log_unit: FloatArray  # ln of A P_c delta_c at the critical area [J]


def recovered_share(ratio: FloatArray) -> FloatArray:
    """Return the recovered work of an unloading over P_max delta_max [-].

    Args:
        ratio: largest interference over the critical one, at least 1 [-].

    Returns:
        (1 - res)/(n + 1) of P = P_max ((x - res)/(1 - res))^n, x in delta_max.

    Source:
        Etsion, Kligerman and Kadin, Int. J. Solids Struct. 42 (2005) 3716:
        res = (1 - s^-0.28)(1 - s^-0.69), n = 1.5 s^-0.0331.
    """
    residual = (1 - ratio**-0.28) * (1 - ratio**-0.69)
    return np.asarray((1 - residual) / (1.5 * ratio**-0.0331 + 1))


def joint_energy(
    model: ContactModel,
    surface: FractalSurface,
    material: ContactMaterial,
    log_largest: FloatArray,
) -> JointEnergy:
    """Return the energies of a joint loaded once, and unloaded by Etsion's law.

    Args:
        model: its load laws are integrated.
        surface: dimension, roughness and hardness of one or many surfaces.
        material: effective modulus and yield properties.
        log_largest: ln(a_l / m^2), broadcast with the surfaces.

    Returns:
        Loading, recovered and dissipated work by regime. Elastic contacts lose
        nothing. Just above yield the unloading law would return more than the load law
        stored (it jumps by 3 % there): such a contact dissipates nothing.
    """
    scale = _scale(model, surface, material, log_largest)
    stages = _stages(model, surface, material)
    loading = [_loading(scale, stage) for stage in stages]
    recovered = [_recovered(scale, s, s.lower, s.upper) for s in stages[:-1]]
    start = _first_loss(stages[2])
    above = _clipped(scale, stages[2], start)
    lost = above - _recovered(scale, stages[2], start, stages[2].upper)
    dissipated = [
        loading[0] - recovered[0],
        loading[1] - recovered[1],
        np.maximum(lost, 0.0),
        0.0 * loading[3],
    ]
    return JointEnergy(
        np.stack(loading), np.stack([*recovered, loading[3]]), np.stack(dissipated)
    )


def two_regime_energy(
    model: ContactModel,
    surface: FractalSurface,
    material: ContactMaterial,
    log_largest: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Return stored and dissipated energy where a contact is elastic or plastic [J].

    Args:
        model: its elastic law stores; below the critical area all contacts are plastic.
        surface: dimension, roughness and hardness.
        material: effective modulus and yield properties.
        log_largest: ln(a_l / m^2).

    Returns:
        W_e = sum of 2/5 P delta over a > a_c, and W_p = sum of H a delta/2 over
        a < a_c.

    Source:
        Zhang's form, as both papers use it (loss factor W_d/W_e); physics as there:
        first plastic loading, not the loss of a small cycle.
    """
    scale = _scale(model, surface, material, log_largest)
    elastic = _stages(model, surface, material)[-1]
    e, top = scale.excess, scale.log_x
    unit = scale.log_unit
    stored = power_integral(1.5 - e - (1 + e) / 2, np.minimum(0.0, top), top, unit)
    stored = stored * elastic.factor / (elastic.exponent + 1)
    # H a delta/2 in P_c delta_c, at s = 1: the plastic factor of a pressure H.
    half = 0.5 * _plastic_factor(model, surface, material, 1.0)
    lost = half * np.exp(unit + (1 - e) * np.minimum(0.0, top)) / (1 - e)
    return stored, np.asarray(lost)


def _plastic_factor(
    model: ContactModel,
    surface: FractalSurface,
    material: ContactMaterial,
    pressure_factor: float,
) -> FloatArray:
    """Return full plasticity's load over P_c s: f H a with a = g R delta [-]."""
    kappa = surface_yield_ratio(model, surface, material)
    unit = 4 / 3 * material.effective_modulus * kappa / model.topography.shape
    return np.asarray(pressure_factor * surface.hardness / unit)


def _stages(
    model: ContactModel, surface: FractalSurface, material: ContactMaterial
) -> list[_Stage]:
    """Return the regimes in the order of `REGIMES`, with the work done before each."""
    before = np.zeros_like(surface.hardness)
    result: list[_Stage] = []
    laws = zip(regime_laws(model), pairwise(REGIME_BOUNDS), strict=True)
    for law, (upper, lower) in reversed(list(laws)):
        if isinstance(law, PowerLaw):
            factor, exponent = np.asarray(law.coefficient), law.exponent
        else:
            pressure = law.pressure_factor
            factor = _plastic_factor(model, surface, material, pressure)
            exponent = 1.0
        stage = _Stage(factor, exponent, upper, lower, before)
        result.insert(0, stage)
        if math.isfinite(upper):
            before = stage.work(np.asarray(upper))
    return result


def _scale(
    model: ContactModel,
    surface: FractalSurface,
    material: ContactMaterial,
    log_largest: FloatArray,
) -> _Scale:
    e = excess(model, surface)
    log_critical = log_critical_area(model, surface, material)
    log_x = np.asarray(log_largest - log_critical)
    kappa = surface_yield_ratio(model, surface, material)
    shape = math.log(model.topography.shape)
    # P_c = 4/3 E kappa a_c/g, and delta_c = kappa^2 R with a = g R delta.
    load = np.log(4 / 3 * material.effective_modulus * kappa) + log_critical - shape
    depth = np.log(kappa) + 0.5 * (log_critical - shape)
    population = np.log(model.population * (1 + e) / 2) + (1 + e) / 2 * log_x
    return _Scale(e, log_x, np.asarray(load + depth + population))


def _clipped(scale: _Scale, stage: _Stage, start: FloatArray) -> FloatArray:
    """Return the loading work of the contacts of a stage beyond s = `start` [J]."""
    e, p = scale.excess, stage.exponent + 1
    high = np.minimum(-np.log(start) / e if np.all(start > 0) else scale.log_x, 0.0)
    return _between(scale, stage, -math.log(stage.upper) / e, high, p)


def _loading(scale: _Scale, stage: _Stage) -> FloatArray:
    """Return the loading work of all contacts of a stage [J]."""
    e, p = scale.excess, stage.exponent + 1
    high = -math.log(stage.lower) / e if stage.lower else scale.log_x
    if math.isinf(stage.upper):  # down to zero area; both exponents are positive
        high = np.minimum(high, scale.log_x)
        first = np.exp(scale.log_unit + (1 + e) * high) / (1 + e)
        rest = np.exp(scale.log_unit + (1 + e - p * e) * high) / (1 + e - p * e)
        start = stage.before - stage.factor * stage.lower**p / p
        return np.asarray(start * first + stage.factor / p * rest)
    return _between(scale, stage, -math.log(stage.upper) / e, high, p)


def _between(
    scale: _Scale, stage: _Stage, low: FloatArray, high: FloatArray, p: float
) -> FloatArray:
    """Integrate a stage's work over ln x from `low` to `high`, clipped to X [J]."""
    e = scale.excess
    low, high = np.minimum(low, scale.log_x), np.minimum(high, scale.log_x)
    high = np.maximum(low, high)
    first = power_integral(1 + e, low, high, scale.log_unit)
    rest = power_integral(1 + e - p * e, low, high, scale.log_unit)
    start = stage.before - stage.factor * stage.lower**p / p
    return np.asarray(start * first + stage.factor / p * rest)


def _recovered(
    scale: _Scale, stage: _Stage, lower: FloatArray | float, upper: float
) -> FloatArray:
    """Integrate the recovered work of contacts between two interference ratios [J]."""
    e = scale.excess
    start = np.maximum(np.log(lower), -e * scale.log_x)
    # The integrand falls as exp(-decay t) in t = ln s, and in full plasticity faster.
    decay = (1 + e) / e - (stage.exponent + 1)
    longest = _LONGEST / np.maximum(decay + 0.28, 1e-3)
    span = np.clip(math.log(upper) - start, 0.0, longest)
    edges = span[..., None] * np.linspace(0, 1, _PANELS + 1)[:-1]
    nodes = edges[..., None] + span[..., None, None] * (_NODES + 1) / (2 * _PANELS)
    t = start[..., None] + nodes.reshape(*span.shape, -1)
    weights = np.tile(_WEIGHTS, _PANELS) / (2 * _PANELS)
    # ln(s^p) and the population's share are taken together against overflow.
    value = np.exp(-decay[..., None] * t + scale.log_unit[..., None])
    total = (value * recovered_share(np.exp(t)) * weights).sum(axis=-1)
    return np.asarray(stage.factor * total * span / e)


def _first_loss(stage: _Stage) -> FloatArray:
    """Return the interference ratio from which a contact of the first stage loses."""
    low = np.full(np.broadcast(stage.factor, stage.before).shape, stage.lower)
    high = np.full_like(low, stage.upper)
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        loses = stage.work(middle) > stage.recovered(middle)
        low, high = np.where(loses, low, middle), np.where(loses, middle, high)
    return np.asarray(high)
