# SPDX-License-Identifier: MIT
"""Nominal values of joint, feet and damping, and the true values drawn about them."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.simulators.flexible.flexible_specimen import BoltedSpecimen

MODULUS_SIGMA = 0.02
DAMPING_SIGMA = 0.3
STIFFNESS_SIGMA = 0.1
BOLT_SIGMA = 0.03
FEET_SIGMA = 0.2
"""Relative standard deviations of the true values about the nominal ones."""
_RIGID_SHARE = 0.25  # of the specimens: no tangential motion at the bolts
_NORMAL = {"plates": (5e6, 3e7), "lap-beam": (3e6, 1.5e7), "column": (1e7, 6e7)}
_LOSS, _LOSS_FREQUENCY = (0.01, 0.05), 800.0
_FEET_FREQUENCY, _FEET_DAMPING = (10.0, 22.0), (0.03, 0.08)


@dataclass(frozen=True, slots=True, eq=False)
class BoltValues:
    """Values of the base model; stiffness infinite where a direction is rigid.

    Attributes:
        stiffness: of the joint at each bolt, x, y, z [N/m], shape (n_bolts, 3).
        damping: of the joint at each bolt, x, y, z [N s/m], shape (n_bolts, 3).
        feet_stiffness: of each foot in each direction [N/m].
        feet_damping: of each foot in each direction [N s/m].
        modulus: Young's modulus of each body over its nominal one [-], shape (2,).
        damping_ratio: of the elastic modes of each body [-], shape (2,).
    """

    stiffness: FloatArray
    damping: FloatArray
    feet_stiffness: float
    feet_damping: float
    modulus: FloatArray
    damping_ratio: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "stiffness", "damping", "modulus", "damping_ratio")


def draw_nominal(specimen: BoltedSpecimen, rng: np.random.Generator) -> BoltValues:
    """Draw the nominal values of a specimen, the same at every bolt."""
    normal = _log_uniform(rng, *_NORMAL[specimen.kind])
    tangential = normal * rng.uniform(0.35, 0.9) * np.exp(0.05 * rng.normal(size=2))
    stiffness = np.array([*tangential, normal])
    loss = _log_uniform(rng, *_LOSS)
    damping = loss * stiffness / (2 * np.pi * _LOSS_FREQUENCY)
    damping[:2] = damping[:2].mean()
    if rng.random() < _RIGID_SHARE:
        stiffness[:2] = np.inf
    mass = sum(body.block.mass for body in specimen.bodies)
    omega = 2 * np.pi * rng.uniform(*_FEET_FREQUENCY)
    feet = len(specimen.feet)
    ratio = rng.uniform(*_FEET_DAMPING)
    count = len(specimen.bolts)
    return BoltValues(
        stiffness=np.tile(_digits(stiffness), (count, 1)),
        damping=np.tile(_digits(damping), (count, 1)),
        feet_stiffness=float(_digits(mass * omega**2 / feet)),
        feet_damping=float(_digits(2 * ratio * mass * omega / feet)),
        modulus=np.ones(2),
        damping_ratio=np.full(2, _digits(_log_uniform(rng, 0.0012, 0.005))),
    )


def draw_true(nominal: BoltValues, rng: np.random.Generator) -> BoltValues:
    """Draw the true values about the nominal ones, log-normal.

    Stiffness of one direction, and damping of the normal and of both tangential ones,
    deviate at all bolts together; each bolt then has a factor of its own.
    """
    bolts = np.exp(BOLT_SIGMA * rng.standard_normal(nominal.stiffness.shape[0]))
    common = np.exp(STIFFNESS_SIGMA * rng.standard_normal(3))
    tangential, normal = np.exp(DAMPING_SIGMA * rng.standard_normal(2))
    losses = np.array([tangential, tangential, normal])
    feet = np.exp(rng.standard_normal(2) * (FEET_SIGMA, DAMPING_SIGMA))
    return BoltValues(
        stiffness=nominal.stiffness * common * bolts[:, None],
        damping=nominal.damping * losses * bolts[:, None],
        feet_stiffness=nominal.feet_stiffness * float(feet[0]),
        feet_damping=nominal.feet_damping * float(feet[1]),
        modulus=np.exp(MODULUS_SIGMA * rng.standard_normal(2)),
        damping_ratio=nominal.damping_ratio
        * np.exp(DAMPING_SIGMA * rng.standard_normal(2)),
    )


def _log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _digits(values: FloatArray | float) -> FloatArray:
    """Return values with four digits, as a person states them."""
    x = np.asarray(values, dtype=float)
    finite = np.where(np.isfinite(x), x, 1.0)
    scale = 10.0 ** (3 - np.floor(np.log10(finite)))
    return np.asarray(np.where(np.isfinite(x), np.round(finite * scale) / scale, x))
