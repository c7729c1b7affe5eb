# SPDX-License-Identifier: MIT
"""The constant C in S(lag) = C G^(2(D-1)) lag^(4-2D), and G from S."""

from typing import Literal

import numpy as np
from scipy.special import gamma as gamma_function

from jointbench.acquisition.basics.errors import UsageError

DEFAULT_GAMMA = 1.5
"""Frequency ratio of Weierstrass-Mandelbrot surfaces in the papers [-]."""

ConstantForm = Literal["corrected", "as-printed"]


def spectral_integral(exponent: float) -> float:
    """Return I(s) = integral of u^(-1-s) (1 - cos u) over u > 0 [-].

    Args:
        exponent: s = 4 - 2D, between 0 and 2 [-].

    Source:
        Gradshteyn and Ryzhik, 3.823, with Gamma reflected at s = 1, where the
        textbook form Gamma(-s) cos(pi s/2) is infinity times zero.
    """
    half_angle = np.sin(np.pi * exponent / 2)
    return float(np.pi / (2 * gamma_function(1 + exponent) * half_angle))


def structure_constant(
    dimension: float,
    gamma: float = DEFAULT_GAMMA,
    form: ConstantForm = "corrected",
) -> float:
    """Return C in S(lag) = C G^(2(D-1)) lag^(4-2D).

    Args:
        dimension: D of a profile, between 1 and 2 [-].
        gamma: frequency ratio of the surface, above 1 [-].
        form: ``"corrected"`` for heights made of cos(2 pi gamma^n x);
            ``"as-printed"`` for the paper's constant, which belongs to cos(gamma^n x).

    Returns:
        C [-], smooth through D = 1.5.

    Raises:
        UsageError: D not between 1 and 2, gamma not above 1, or no such form.

    Source:
        S1 eq. (10) as printed.

    Note:
        With surfaces of cos(2 pi gamma^n x) the printed constant inflates G by
        (2 pi)^((2-D)/(D-1)); the corrected form carries (2 pi)^(4-2D).
    """
    if not 1 < dimension < 2:
        raise UsageError(f"dimension is {dimension:g}, it must be between 1 and 2")
    if not gamma > 1:
        raise UsageError(f"gamma is {gamma:g}, it must be above 1, for example 1.5")
    if form not in {"corrected", "as-printed"}:
        raise UsageError(f"constant {form!r}: give 'corrected' or 'as-printed'")
    exponent = 4 - 2 * dimension
    printed = spectral_integral(exponent) / float(np.log(gamma))
    return printed * (2 * np.pi) ** exponent if form == "corrected" else printed


def log_roughness(
    dimension: float,
    log_value: float,
    lag: float,
    *,
    gamma: float = DEFAULT_GAMMA,
    constant: ConstantForm = "corrected",
) -> float:
    """Return ln G from a dimension and the structure function at one lag.

    Args:
        dimension: D of the profile [-].
        log_value: ln of S in m^2 at `lag`.
        lag: [m].
        gamma: frequency ratio [-].
        constant: form of C.

    Returns:
        ln of G in m.

    Raises:
        UsageError: as `structure_constant`.

    Source:
        S1 eq. (9) solved for G.
    """
    level = log_value - (4 - 2 * dimension) * np.log(lag)
    level -= np.log(structure_constant(dimension, gamma, constant))
    return float(level / (2 * (dimension - 1)))
