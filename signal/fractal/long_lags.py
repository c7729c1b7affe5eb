# SPDX-License-Identifier: MIT
"""Test whether S at long lags is below a fit, to which chi2 is insensitive.

S at a long lag is a mean of few squares: it may exceed a model by many times its value,
    but be below it by that value at most, so that a plateau has little weight in linear
    residuals.
"""

import numpy as np
from scipy.linalg import solve_triangular

from jointbench.acquisition.basics.arrays import IntArray
from jointbench.acquisition.basics.tail_probabilities import chi2_above
from jointbench.signal.fractal.fit_problem import FractalProblem
from jointbench.signal.fractal.lag_weights import lower_root
from jointbench.signal.fractal.least_squares import GlsFit

LAGS = 4
"""Lags of the test [-]."""
RATIO = 2.5
"""Least ratio of neighbours among them [-]: cube roots of more strongly correlated
values no longer have the covariance of the values."""


def long_lag_probability(problem: FractalProblem, fit: GlsFit) -> float:
    """Return the probability of long-lag values as far from a fit as these [-].

    Args:
        problem: the structure function that was fitted.
        fit: with its own surface and instrument.

    Source:
        Wilson and Hilferty, Proc. Natl. Acad. Sci. 17 (1931) 684: a mean of squares of
        relative variance v has a nearly Gaussian cube root of mean 1 - v / 9 and
        variance v / 9.
    """
    keep = _spaced(problem)
    predicted = fit.predicted[keep]
    if np.any(predicted <= 0):
        return 0.0
    scatter = problem.scatter(fit.seen)[np.ix_(keep, keep)]
    error = problem.model_error(fit.seen)[np.ix_(keep, keep)]
    share = problem.estimate.value[keep] / predicted
    gap = 3 * (np.cbrt(share) - 1) + np.diag(scatter) / 3
    white = solve_triangular(lower_root(scatter + error), gap, lower=True)
    return chi2_above(float(white @ white), keep.size)


def _spaced(problem: FractalProblem) -> IntArray:
    """Return the indices of the longest lags that are far enough apart."""
    lag, kept = problem.lag, [problem.lag.size - 1]
    for k in range(lag.size - 2, -1, -1):
        if len(kept) < LAGS and lag[kept[-1]] >= RATIO * lag[k]:
            kept.append(k)
    return np.array(kept[::-1])
