# SPDX-License-Identifier: MIT
"""Loss of a power law by removal of the mean line."""

import numpy as np
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
    s = exponent
    slope_variance = 36 * _beta(s + 3, 2) - 12 * _beta(s + 1, 4)

    def moment(t: FloatArray) -> FloatArray:
        """Integrate cov(z(t), b) from 0 to t."""
        rest = 1 - t
        left = t ** (s + 3) / (s + 3) - t ** (s + 2) / (2 * (s + 2))
        right = rest ** (s + 3) / (s + 3) - rest ** (s + 2) / (2 * (s + 2))
        start = 1 / (s + 3) - 1 / (2 * (s + 2))
        first = (left + right - start) / (s + 1)
        second = (t ** (s + 3) + rest ** (s + 3) - 1) / ((s + 2) * (s + 3))
        integral: FloatArray = -6 * (first - second)
        return integral

    ends = moment(np.ones_like(share)) - moment(1 - share) - moment(share)
    loss: FloatArray = 2 * share * ends / (1 - share) - share**2 * slope_variance
    return loss


def _beta(a: float, b: float) -> float:
    """Return Euler's beta function."""
    return float(gamma_function(a) * gamma_function(b) / gamma_function(a + b))
