# SPDX-License-Identifier: MIT
"""Fisher information, what nuisances take from it, and the intervals to expect.

The core of every plan: of hits and sensors (`fisher_plan`), of torques (`torque_law`),
and of the next experiment that separates explanations (`gap.next_experiment`).

Source:
    Fedorov 1972, Theory of Optimal Experiments, ch. 1 and 2.
"""

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray

# Prior precision that stands for none: a standard deviation of 1e4.
OPEN = 1e-8
# Least eigenvalue of a scaled information over the largest: rounding.
_ROUNDING = 1e-14


def information_of(slopes: FloatArray | ComplexArray) -> FloatArray:
    """Return the information of data on parameters.

    Args:
        slopes: derivatives of the data, each over its standard deviation (complex data:
            over that of its real part), shape (..., n_data, p).

    Returns:
        Shape (..., p, p).
    """
    turned = np.swapaxes(slopes, -1, -2).conj()
    return np.ascontiguousarray(np.asarray(turned @ slopes).real)


def prior_information(deviation: FloatArray) -> FloatArray:
    """Return what is known before, as a diagonal matrix.

    Args:
        deviation: standard deviations, infinite without a prior, shape (p,).
    """
    with np.errstate(divide="ignore"):
        known = np.where(np.isfinite(deviation), 1.0 / deviation**2, OPEN)
    return np.diag(known)


def without_nuisances(
    own: FloatArray, link: FloatArray, nuisance: FloatArray
) -> FloatArray:
    """Return the information on parameters whose nuisances are unknown as well.

    Args:
        own: of the parameters, shape (p, p).
        link: between these and the nuisances, shape (p, q).
        nuisance: of the nuisances with their priors, shape (q, q).

    Source:
        Schur complement: the inverse of the result is the block of the whole inverse.
    """
    return np.asarray(own - link @ np.linalg.solve(nuisance, link.T))


def expected_covariance(information: FloatArray) -> FloatArray:
    """Return the covariance to expect; very large where a direction is open.

    Args:
        information: with the priors, shape (p, p). It is scaled before it is inverted,
            so that open parameters do not spoil the others.
    """
    size = np.sqrt(np.maximum(np.diag(information), OPEN))
    scaled = information / np.outer(size, size)
    value, vector = np.linalg.eigh(0.5 * (scaled + scaled.T))
    value = np.maximum(value, _ROUNDING * value[-1])
    inverse = (vector / value) @ vector.T
    return np.asarray(inverse / np.outer(size, size))


def forecast_covariance(slopes: FloatArray, information: FloatArray) -> FloatArray:
    """Return the covariance of data to come, from that of the parameters.

    Args:
        slopes: derivatives of the data to come, shape (n, p).
        information: on the parameters, with the priors, shape (p, p).

    Returns:
        Without the errors of the new data, shape (n, n).
    """
    return np.asarray(slopes @ expected_covariance(information) @ slopes.T)
