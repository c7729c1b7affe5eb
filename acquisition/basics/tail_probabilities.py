# SPDX-License-Identifier: MIT
"""Tail probabilities and quantiles of the distributions of statistical tests.

These are the functions of `scipy.special` that `scipy.stats` calls itself, without its
import, which takes longer than the rest of a short command.
"""

import math

import scipy.special


def chi2_above(value: float, dof: float) -> float:
    """Return the probability that a chi2 variable exceeds a value [-].

    Args:
        value: of chi2 [-].
        dof: degrees of freedom; NaN is returned unless there are any.
    """
    return float(scipy.special.chdtrc(dof, value)) if dof > 0 else math.nan


def chi2_limit(chance: float, dof: float) -> float:
    """Return the value that a chi2 variable exceeds with a given probability [-].

    Args:
        chance: the probability [-].
        dof: degrees of freedom; NaN is returned unless there are any.
    """
    return float(scipy.special.chdtri(dof, chance)) if dof > 0 else math.nan


def f_above(value: float, dof: float, dof_below: float) -> float:
    """Return the probability that an F ratio exceeds a value [-].

    Args:
        value: ratio of two mean squares [-].
        dof: degrees of freedom of the numerator.
        dof_below: degrees of freedom of the denominator.
    """
    return float(scipy.special.fdtrc(dof, dof_below, value))


def f_limit(chance: float, dof: float, dof_below: float) -> float:
    """Return the F ratio that is exceeded with a given probability [-].

    Args:
        chance: the probability [-].
        dof: degrees of freedom of the numerator.
        dof_below: degrees of freedom of the denominator.
    """
    return float(scipy.special.fdtri(dof, dof_below, 1.0 - chance))


def gamma_above(value: float, shape: float) -> float:
    """Return the probability that a gamma variable of scale 1 exceeds a value [-].

    Args:
        value: also below 0, where the probability is 1.
        shape: of the distribution [-], its mean.
    """
    return float(scipy.special.gammaincc(shape, max(value, 0.0)))


def t_quantile(share: float, dof: float) -> float:
    """Return a quantile of Student's t distribution [-].

    Args:
        share: probability below the quantile [-].
        dof: degrees of freedom, also infinite.
    """
    return float(scipy.special.stdtrit(dof, share))


def normal_quantile(share: float) -> float:
    """Return a quantile of the standard normal distribution [-].

    Args:
        share: probability below the quantile [-].
    """
    return float(scipy.special.ndtri(share))
