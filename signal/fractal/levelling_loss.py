# SPDX-License-Identifier: MIT
"""Loss of a power law by removal of the mean line."""

from scipy.special import gamma as gamma_function

from jointbench.acquisition.basics.arrays import FloatArray


def levelling_loss(share: FloatArray, exponent: float) -> FloatArray:
    """Return the loss of S = t^s on a unit length by removal of the mean line.

    Args:
        share: lag over the length of the profile, between 0 and 1 [-].
        exponent: s [-].

    Returns:
        Loss of the mean of S over all pairs of one profile, same shape [-].

    Source:
        The slope b of the line is 12 times the integral of (t - 1/2) z. With it
        S_levelled = S - 2 lag mean(cov(dz, b)) + lag^2 var(b), and both moments
        follow from cov = -S/2 for weights that sum to zero.
    """
    s, rest = exponent, 1 - share
    slope_variance = 36 * _beta(s + 3, 2) - 12 * _beta(s + 1, 4)
    lower, upper = share ** (s + 2), rest ** (s + 2)
    # The integral of cov(z(t), b) from 0 to t is the same at t and at 1 - t.
    squares = (lower + upper - 1) / (2 * (s + 2))
    cubes = (lower * share + upper * rest - 1) / (s + 3)
    moment = 6 * (squares - cubes / (s + 2)) / (s + 1)
    loss: FloatArray = -4 * share * moment / rest - share**2 * slope_variance
    return loss


def _beta(a: float, b: float) -> float:
    """Return Euler's beta function."""
    return float(gamma_function(a) * gamma_function(b) / gamma_function(a + b))
