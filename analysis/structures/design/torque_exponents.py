# SPDX-License-Identifier: MIT
"""How the parameters of a joint change with the torque on its bolts."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray, freeze

STIFFNESS_EXPONENT = (2.0 / 3.0, 1.0 / 3.0)
"""Mean and sd before a measurement: Hertz 1/3, rough contact 1 (Persson 2007)."""
DAMPING_EXPONENT = (0.0, 1.0)
"""Likewise: c = eta k/omega rises with k, and the loss factor falls with the load."""


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredLevels:
    """Parameters identified at several torques.

    Attributes:
        log_ratio: ln of each torque over a common one [-], shape (n_states,).
        log_value: ln of the parameters, shape (n_states, p).
        deviation: sd of these; infinite where one is not known, same shape.
    """

    log_ratio: FloatArray
    log_value: FloatArray
    deviation: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "log_ratio", "log_value", "deviation")


def prior_exponents(damping: BoolArray) -> tuple[FloatArray, FloatArray]:
    """Return mean and sd of exponents before a measurement, shape (p,) each.

    Args:
        damping: whether each parameter is a damping, shape (p,).
    """
    mean = np.where(damping, DAMPING_EXPONENT[0], STIFFNESS_EXPONENT[0])
    return mean, np.where(damping, DAMPING_EXPONENT[1], STIFFNESS_EXPONENT[1])


def fitted_exponents(
    levels: MeasuredLevels, damping: BoolArray, scatter: float
) -> FloatArray:
    """Return the exponents that measured levels and the prior give, shape (p,).

    Args:
        levels: by torque.
        damping: whether each parameter is a damping, shape (p,).
        scatter: sd in ln by which a state departs from the law [-].

    Source:
        Weighted line through ln k over ln T with a free level, and a normal prior.
    """
    mean, sd = prior_exponents(damping)
    weight = 1.0 / (np.maximum(levels.deviation, 1e-6) ** 2 + scatter**2)
    total = np.maximum(weight.sum(axis=0), 1e-300)
    x = levels.log_ratio[:, None] - (weight * levels.log_ratio[:, None]).sum(0) / total
    slope = np.sum(weight * x * levels.log_value, axis=0)
    return np.asarray((slope + mean / sd**2) / (np.sum(weight * x**2, axis=0) + sd**-2))
