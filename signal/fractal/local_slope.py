# SPDX-License-Identifier: MIT
"""Local slope of the structure function, lag by lag."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.signal.fractal.verdict_records import LocalSlope
from jointbench.signal.surface.structure_function import StructureFunction

NEIGHBOURS = 2
"""Lags on each side in the fit of one slope [-]."""


def local_slope(estimate: StructureFunction, covariance: FloatArray) -> LocalSlope:
    """Fit a straight line through the neighbours of every lag.

    Args:
        estimate: structure function, all values above 0.
        covariance: of its values over themselves, shape (n_lags, n_lags) [-].

    Returns:
        Slopes of ln S over ln lag at the lags of `estimate`; at the ends through
        fewer neighbours. Empty for fewer than two lags.
    """
    size = estimate.lag.size
    if size < 2:
        none = np.empty(0)
        return LocalSlope(lag=none, slope=none, sd=none)
    log_lag, log_value = np.log(estimate.lag), np.log(estimate.value)
    slopes, deviations = np.empty((2, size))
    for k in range(size):
        near = slice(max(0, k - NEIGHBOURS), min(size, k + NEIGHBOURS + 1))
        centred = log_lag[near] - log_lag[near].mean()
        weight = centred / np.sum(centred**2)
        slopes[k] = weight @ log_value[near]
        spread = float(weight @ covariance[near, near] @ weight)
        deviations[k] = np.sqrt(max(0.0, spread))
    return LocalSlope(lag=estimate.lag, slope=slopes, sd=deviations)
