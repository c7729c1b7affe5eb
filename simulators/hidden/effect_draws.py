# SPDX-License-Identifier: MIT
"""Random hidden effects: shapes drawn log-uniformly, sizes from zero to extreme.

Shapes are drawn in proportion to the response of the specimen (largest elongation,
frequencies), so that a gap closes and a slider slips within the levels of the hits.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.hidden.campaign_design import CampaignDesign
from jointbench.simulators.hidden.campaign_response import sketch_responses
from jointbench.simulators.hidden.campaign_sampling import SAMPLE_RATE
from jointbench.simulators.hidden.hidden_effects import HiddenEffect
from jointbench.simulators.mechanics.plant import plant_modes, two_bodies

_Draw = Callable[["Scales", np.random.Generator], dict[str, float]]


@dataclass(frozen=True, slots=True)
class Scales:
    """Response of the specimen of a design without hidden effects.

    Attributes:
        elongation: largest of the joint over all records [m].
        rate: largest elongation rate [m/s].
        acceleration: largest of either body [m/s^2].
        frequency: natural frequencies [Hz].
        kj: stiffness of the joint [N/m].
        cj: damping coefficient of the joint [N s/m].
        noise: of the accelerations [m/s^2].
    """

    elongation: float
    rate: float
    acceleration: float
    frequency: tuple[float, float]
    kj: float
    cj: float
    noise: float


@dataclass(frozen=True, slots=True)
class EffectFamily:
    """Distribution of one kind of effect.

    Attributes:
        draw: parameters at the largest size that is still physical.
        free: number of parameters an analyst would fit [-].
        scaled: parameters proportional to the size of the effect.
        inverse: parameters inversely proportional to it.
    """

    draw: _Draw
    free: int
    scaled: tuple[str, ...]
    inverse: tuple[str, ...] = ()

    @property
    def resizable(self) -> bool:
        """True if the effect has a size; a reversed sign has none."""
        return bool(self.scaled or self.inverse)


def specimen_scales(design: CampaignDesign) -> Scales:
    """Measure the specimen of a design on its noise-free base responses."""
    acceleration = sketch_responses(design)
    relative = acceleration[:, 1] - acceleration[:, 0]
    step = 1 / SAMPLE_RATE
    rate = _integral(relative, step)
    elongation = _integral(rate, step)
    # The first milliseconds hold the peak, before the integrals drift.
    early = slice(0, 128 + 256)
    modes = plant_modes(two_bodies(**design.physical)).natural_frequency
    return Scales(
        elongation=float(np.abs(elongation[:, early]).max()),
        rate=float(np.abs(rate[:, early]).max()),
        acceleration=float(np.abs(acceleration).max()),
        frequency=(float(modes[0]), float(modes[1])),
        kj=design.physical["kj"],
        cj=design.physical["cj"],
        noise=design.noise,
    )


def _integral(rate: FloatArray, step: float) -> FloatArray:
    """Return the integral by trapezia of rows that begin at 0, in the shape of them."""
    pieces = step * (rate[:, 1:] + rate[:, :-1]) / 2.0
    return np.pad(np.cumsum(pieces, axis=1), ((0, 0), (1, 0)))


def draw_effect(name: str, scales: Scales, rng: np.random.Generator) -> HiddenEffect:
    """Draw an effect of the largest size that is still physical.

    Args:
        name: one of `FAMILIES`.
        scales: of the specimen.
        rng: source of the draw.

    Returns:
        The effect; `resize_effect` reduces it.

    Raises:
        UsageError: there is no such effect.
    """
    require_effect(name)
    return HiddenEffect(name, FAMILIES[name].draw(scales, rng))


def require_effect(name: str) -> None:
    """Raise unless there is an effect of that name.

    Raises:
        UsageError: there is none.
    """
    if name not in FAMILIES:
        raise UsageError(
            f"unknown effect {name!r}; there are {', '.join(sorted(FAMILIES))}"
        )


def resize_effect(effect: HiddenEffect, share: float) -> HiddenEffect:
    """Return the effect at `share` of its size [-], its shape unchanged."""
    family = FAMILIES[effect.name]
    parameters = dict(effect.parameters)
    for name in family.scaled:
        parameters[name] *= share
    for name in family.inverse:
        parameters[name] /= share
    return HiddenEffect(effect.name, parameters)


def _log(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _sign(rng: np.random.Generator) -> float:
    return float(rng.choice([-1.0, 1.0]))


def _dof(rng: np.random.Generator) -> float:
    return float(rng.integers(2))


def _sharpness(rng: np.random.Generator) -> float:
    return float(rng.integers(8, 21))


def _odd(name: str, power: int) -> _Draw:
    """Harden by up to half of kj at the largest elongation, soften by a fifth."""

    def draw(s: Scales, rng: np.random.Generator) -> dict[str, float]:
        share = 0.5 if rng.uniform() < 0.6 else -0.2
        return {name: share * s.kj / s.elongation ** (power - 1)}

    return draw


def _jenkins(s: Scales, rng: np.random.Generator) -> dict[str, float]:
    kt = 0.4 * s.kj
    slip = s.elongation * _log(rng, 0.05, 0.6)
    return {"kt": kt, "Fs": kt * slip, "sharpness": _sharpness(rng)}


def _iwan(s: Scales, rng: np.random.Generator) -> dict[str, float]:
    return {
        "kt": 0.4 * s.kj,
        "phimax": s.elongation * _log(rng, 0.3, 2.5),
        "chi": float(rng.uniform(-0.7, 0.0)),
        "sharpness": _sharpness(rng),
        "sliders": float(rng.choice([12, 16, 24, 40])),
    }


def _bouc_wen(s: Scales, rng: np.random.Generator) -> dict[str, float]:
    b = float(rng.uniform(0.4, 0.8))
    return {
        "k": 0.4 * s.kj,
        "n": float(rng.choice([1.0, 1.5, 2.0])),
        "b": b,
        "g": float(rng.uniform(-0.4, 0.4)) * b,
        "zy": s.elongation * _log(rng, 0.1, 1.0),
    }


def _hidden_mode(s: Scales, rng: np.random.Generator) -> dict[str, float]:
    mass, ratio = 0.5, _log(rng, 0.6, 4.0)
    omega = 2 * np.pi * s.frequency[0] * ratio
    return {
        "m": mass,
        "k": mass * omega**2,
        "c": 2 * _log(rng, 0.004, 0.03) * mass * omega,
        "dof": _dof(rng),
    }


def _rattling_mass(s: Scales, rng: np.random.Generator) -> dict[str, float]:
    mass = 0.2
    return {
        "m": mass,
        "k": mass * (2 * np.pi * _log(rng, 800, 2000)) ** 2,
        "g": s.elongation * _log(rng, 0.05, 0.5),
        "dof": _dof(rng),
    }


# Sizes up to gross effects.
FAMILIES: Mapping[str, EffectFamily] = {
    "cubic_stiffness": EffectFamily(_odd("k3", 3), 1, ("k3",)),
    "quadratic_stiffness": EffectFamily(
        lambda s, rng: {"k2": _sign(rng) * 0.3 * s.kj / s.elongation}, 1, ("k2",)
    ),
    "gap": EffectFamily(
        lambda s, rng: {"k": 0.6 * s.kj, "g": s.elongation * _log(rng, 0.08, 0.6)},
        2,
        ("k",),
    ),
    "jenkins": EffectFamily(_jenkins, 2, ("kt", "Fs")),
    "iwan": EffectFamily(_iwan, 3, ("kt",)),
    "bouc_wen": EffectFamily(_bouc_wen, 5, ("k",)),
    "coulomb": EffectFamily(
        lambda s, _: {"Fc": 0.05 * s.kj * s.elongation}, 1, ("Fc",)
    ),
    "quadratic_damping": EffectFamily(lambda s, _: {"c": 6 * s.cj / s.rate}, 1, ("c",)),
    "maxwell": EffectFamily(
        lambda s, rng: {"k": 0.5 * s.kj, "tau": _log(rng, 5e-5, 1e-3)}, 2, ("k",)
    ),
    "extra_damping": EffectFamily(lambda s, _: {"c": 6 * s.cj}, 1, ("c",)),
    "added_mass": EffectFamily(lambda _, rng: {"m": 0.4, "dof": _dof(rng)}, 1, ("m",)),
    "hidden_mode": EffectFamily(_hidden_mode, 3, ("m", "k", "c")),
    "preload_stiffness": EffectFamily(lambda _, __: {"n": 0.6}, 1, ("n",)),
    "preload_damping": EffectFamily(lambda _, rng: {"n": _sign(rng) * 1.0}, 1, ("n",)),
    "loosening": EffectFamily(lambda _, __: {"frac": 0.2}, 1, ("frac",)),
    "delay": EffectFamily(lambda _, rng: {"tau": 2e-4, "dof": _dof(rng)}, 1, ("tau",)),
    "gain_error": EffectFamily(
        lambda _, rng: {"frac": _sign(rng) * 0.15, "dof": _dof(rng)}, 1, ("frac",)
    ),
    "sensor_lowpass": EffectFamily(
        lambda _, rng: {"fc": 800.0, "dof": _dof(rng)}, 1, (), ("fc",)
    ),
    "cross_talk": EffectFamily(
        lambda _, rng: {"frac": _sign(rng) * 0.15}, 1, ("frac",)
    ),
    # A saturation is smaller the higher its limit, and gone above the peak.
    "saturation": EffectFamily(
        lambda s, rng: {"amax": s.acceleration * _log(rng, 0.3, 0.9)}, 1, ()
    ),
    "polarity": EffectFamily(lambda _, rng: {"dof": _dof(rng)}, 0, ()),
    "hum": EffectFamily(
        lambda s, rng: {
            "amp": 10 * s.noise,
            "freq": float(rng.choice([50.0, 100.0, 150.0]) * rng.normal(1, 5e-4)),
            "dof": _dof(rng),
        },
        2,
        ("amp",),
    ),
    # Outside the catalogue.
    "quintic_stiffness": EffectFamily(_odd("k5", 5), 1, ("k5",)),
    "root_stiffness": EffectFamily(
        lambda s, _: {
            "k": 0.2 * s.kj * np.sqrt(s.elongation),
            "e": 0.02 * s.elongation,
        },
        1,
        ("k",),
    ),
    "time_varying_stiffness": EffectFamily(
        lambda _, rng: {"frac": _sign(rng) * 0.2}, 1, ("frac",)
    ),
    "rattling_mass": EffectFamily(_rattling_mass, 3, ("m", "k")),
    "dead_zone_damping": EffectFamily(
        lambda s, rng: {"c": 8 * s.cj, "g": s.elongation * _log(rng, 0.1, 0.5)},
        2,
        ("c",),
    ),
    "thermal_drift": EffectFamily(
        lambda _, rng: {"frac": _sign(rng) * 0.2}, 1, ("frac",)
    ),
    "preload_ground": EffectFamily(lambda _, __: {"n": 0.5}, 1, ("n",)),
    "sensor_resonance": EffectFamily(
        lambda _, rng: {"f0": 1500.0, "zeta": _log(rng, 0.02, 0.3), "dof": _dof(rng)},
        2,
        (),
        ("f0",),
    ),
    "clock_drift": EffectFamily(
        lambda _, rng: {"rate": _sign(rng) * 2e-3}, 1, ("rate",)
    ),
    "zero_shift": EffectFamily(
        lambda _, rng: {
            "frac": _sign(rng) * 0.02,
            "tau": _log(rng, 0.01, 0.1),
            "dof": _dof(rng),
        },
        2,
        ("frac",),
    ),
}
OUTSIDE_CATALOGUE = (
    *("quintic_stiffness", "root_stiffness", "time_varying_stiffness"),
    *("rattling_mass", "dead_zone_damping", "thermal_drift", "preload_ground"),
    *("sensor_resonance", "clock_drift", "zero_shift"),
)
CATALOGUE = tuple(name for name in FAMILIES if name not in OUTSIDE_CATALOGUE)
