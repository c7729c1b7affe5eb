# SPDX-License-Identifier: MIT
"""Evidence of an end of a search: how probable a measurement is under its reading.

Laplace's approximation around each end, with the noise factor summed out. Stiffness and
damping without a prior are even in ln over the range of the search.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.structures.identification.stiffness_problem import (
    Optimum,
    StiffnessProblem,
)

# Points of the sum over the factor of the noise.
_FACTORS = 33
# Probability that the stated standard deviations are right.
_AS_STATED = 0.5
_EVEN = np.sqrt(12.0)


@dataclass(frozen=True, slots=True, eq=False)
class WeighedEnd:
    """An end of a search with its share of the evidence.

    Attributes:
        end: of the search.
        log_evidence: up to a constant common to all readings of the measurement [-].
        covariance: of the logarithms, with the noise factor and the range of the
            search, shape (n_unknowns, n_unknowns).
    """

    end: Optimum
    log_evidence: float
    covariance: FloatArray


def weigh_end(
    problem: StiffnessProblem, end: Optimum, largest_noise: float
) -> WeighedEnd:
    """Return the evidence of one end.

    Args:
        problem: of the identification.
        end: of a descent.
        largest_noise: factor by which the stated deviations may be too small [-].

    Returns:
        The end with its evidence.

    Source:
        Kass and Raftery 1995, J. Am. Stat. Assoc. 90, 773-795, eq. (3).
    """
    width = problem.high - problem.low
    free = ~np.isfinite(problem.prior_sd)
    box = np.where(free, (_EVEN / width) ** 2, 0.0)
    measured = end.slopes.T @ end.slopes
    precision = measured + np.diag(box)
    covariance = np.linalg.inv(precision)
    determined = float(np.trace(covariance @ measured))
    rows = end.slopes.shape[0]
    factor = np.exp(np.linspace(0.0, np.log(largest_noise), _FACTORS))
    share = np.full(_FACTORS, (1.0 - _AS_STATED) / _FACTORS)
    share[0] += _AS_STATED
    terms = (
        np.log(share)
        - (rows - determined) * np.log(factor)
        - 0.5 * end.chi2 / factor**2
    )
    peak = float(terms.max())
    weight = np.exp(terms - peak)
    noise = float(weight @ factor**2 / weight.sum())
    spread = np.where(free, width, problem.prior_sd * np.sqrt(2.0 * np.pi))
    occam = (
        -0.5 * float(np.linalg.slogdet(precision)[1])
        + 0.5 * np.log(2.0 * np.pi) * problem.size
        - float(np.log(spread).sum())
    )
    whole = peak + float(np.log(weight.sum())) + occam
    return WeighedEnd(end, whole, noise * covariance)
