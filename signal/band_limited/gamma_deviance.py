# SPDX-License-Identifier: MIT
"""Deviance of the ordinates of a spectrum from a right model."""

import numpy as np
from scipy.special import digamma

from jointbench.acquisition.basics.arrays import FloatArray


def expected_deviance(count: FloatArray) -> tuple[float, float]:
    """Return mean and standard deviation of the gamma deviance of a right model.

    Args:
        count: independent ordinates of each bin [-], shape (n_bins,).

    Source:
        Moments of ln of a gamma variable; the variance by a normal expansion.
    """
    mean = mean_deviance(count)
    return float(mean.sum()), float(np.sqrt(np.sum(2 * mean**2)))


def mean_deviance(count: FloatArray) -> FloatArray:
    """Return the mean gamma deviance of each bin of a right model, shape (n_bins,).

    Args:
        count: independent ordinates of each bin [-], shape (n_bins,).
    """
    mean: FloatArray = 2 * count * (np.log(count) - digamma(count))
    return mean
