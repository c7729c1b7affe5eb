# SPDX-License-Identifier: MIT
"""Loss of a power law by removal of the mean line."""

import math

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.compiled import compiled


def levelling_loss(share: FloatArray, exponent: float) -> FloatArray:
    """Return the loss of S = t^s on a unit length by removal of the mean line.

    Args:
        share: lag over the length of the profile, between 0 and 1 [-], shape (n,).
        exponent: s [-].

    Returns:
        Loss of the mean of S over all pairs of one profile, same shape [-].

    Source:
        The slope b of the line is 12 times the integral of (t - 1/2) z. With it
        S_levelled = S - 2 lag mean(cov(dz, b)) + lag^2 var(b), and both moments
        follow from cov = -S/2 for weights that sum to zero.
    """
    loss = np.empty(share.size)
    fill_loss(np.array(share, dtype=np.float64), exponent, loss)
    return loss


@compiled()
def fill_loss(share: FloatArray, exponent: float, loss: FloatArray) -> None:
    """Fill in the loss by levelling, see `levelling_loss`."""
    s = exponent
    whole = math.gamma(s + 1)
    # Beta functions B(s + 3, 2) and B(s + 1, 4).
    first = whole * (s + 1) * (s + 2) / math.gamma(s + 5)
    second = 6 * whole / math.gamma(s + 5)
    variance = 36 * first - 12 * second
    for i in range(share.size):
        t = share[i]
        rest = 1 - t
        lower, upper = t ** (s + 2), rest ** (s + 2)
        # The integral of cov(z(t), b) from 0 to t is the same at t and at 1 - t.
        squares = (lower + upper - 1) / (2 * (s + 2))
        cubes = (lower * t + upper * rest - 1) / (s + 3)
        moment = 6 * (squares - cubes / (s + 2)) / (s + 1)
        loss[i] = -4 * t * moment / rest - t**2 * variance
