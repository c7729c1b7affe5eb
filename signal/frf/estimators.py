# SPDX-License-Identifier: MIT
"""FRF estimators H1, H2 and Hv, and the bias of each.

With force f + n_f and response x + n_x as measured, noises independent of everything:

- H1 = S_xf / S_ff is low by 1 / (1 + noise of the force over force);
- H2 = S_xx / S_fx is high by 1 + noise of the response over response;
- Hv, the geometric mean of their sizes, is unbiased where the two shares are equal.

All three share one phase, and coherence is |H1| / |H2|: the true value is between the
two. None detects errors correlated between force and response: leakage, a second
impact.

Source:
    Bendat and Piersol, Random Data (2010), sec. 6.1.4 and 9.2; Rocklin, Crowley and
    Vold, IMAC 3 (1985) 272 (Hv).
"""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from scipy.ndimage import uniform_filter1d

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray

# The scatter of a few hits is itself noisy; it is averaged over this many lines.
_SCATTER_LINES = 9
_LEAST_POWER = 1e-24


class Estimator(StrEnum):
    """How force and response are weighted."""

    H1 = "H1"
    H2 = "H2"
    HV = "Hv"

    @property
    def bias(self) -> str:
        """The bias of the estimator, as text."""
        return {
            "H1": "low where the force is noisy: |H| by its noise over its power",
            "H2": "high where the response is noisy: |H| by its noise over its power",
            "Hv": "between H1 and H2; unbiased where force and response are equally "
            "noisy",
        }[self.value]


@dataclass(frozen=True, slots=True, eq=False)
class EstimatedPair:
    """One output from one input.

    Attributes:
        response: FRF [response unit/N], shape (n_lines,).
        coherence: ordinary coherence [-], shape (n_lines,).
        variance: E|error|^2 of the average from the scatter between hits, shape
            (n_lines,); of no meaning for a single hit.
    """

    response: ComplexArray
    coherence: FloatArray
    variance: FloatArray


def estimate_pair(
    force: ComplexArray, response: ComplexArray, estimator: Estimator = Estimator.H1
) -> EstimatedPair:
    """Average the spectra of several hits.

    Args:
        force: shape (n_hits, n_lines).
        response: shape (n_hits, n_lines).
        estimator: which of the three.

    Returns:
        The estimate. Its relative random error is that of H1 for all three, to the
        first order (Bendat and Piersol, table 9.6).
    """
    force_power = np.sum(np.abs(force) ** 2, axis=0)
    safe = np.where(force_power > 0.0, force_power, 1.0)
    h1 = np.sum(response * force.conj(), axis=0) / safe
    response_power = np.sum(np.abs(response) ** 2, axis=0)
    scatter = np.sum(np.abs(response - h1 * force) ** 2, axis=0)
    powers = (force_power, response_power, scatter)
    return pair_of_sums(h1, powers, force.shape[0], estimator)


def floored_power(force_power: FloatArray) -> FloatArray:
    """Return the power of a force, at least a share of the largest that it has."""
    return np.asarray(np.maximum(force_power, _LEAST_POWER * force_power.max()))


def pair_of_sums(
    h1: ComplexArray,
    powers: tuple[FloatArray, FloatArray, FloatArray],
    hits: int,
    estimator: Estimator = Estimator.H1,
) -> EstimatedPair:
    """Return the estimate that sums over hits give; see `estimate_pair`.

    Args:
        h1: response over force, shape (n_lines,). On a line where the force has less
            power than the floor it is reduced, and what that leaves is scatter.
        powers: sums of |F|^2, |X|^2 and |X - H1 F|^2, same shape.
        hits: number of hits.
        estimator: which of the three.
    """
    own_power, response_power, scatter = powers
    force_power = floored_power(own_power)
    if force_power.max() > 0.0:
        share = own_power / force_power
        scatter = scatter + np.abs((1.0 - share) * h1) ** 2 * own_power
        h1 = h1 * share
    safe = np.where(response_power > 0.0, response_power, 1.0)
    coherence = np.clip(1.0 - scatter / safe, 0.0, 1.0)
    noise = uniform_filter1d(scatter, _SCATTER_LINES, mode="nearest")
    noise = noise / max(1, hits - 1)
    gain = _over_h1(h1, force_power, response_power, estimator)
    return EstimatedPair(h1 * gain, coherence, noise / force_power * gain**2)


def bias_bound(coherence: FloatArray, averages: int) -> FloatArray:
    """Return how far apart |H1| and |H2| are, as a share of |H2|.

    Args:
        coherence: ordinary [-], any shape.
        averages: number of hits; few hits raise coherence by chance, which is
            corrected.

    Returns:
        Largest bias due to noise of either [-], same shape; the true value is between
        them.
    """
    freedom = max(1, averages - 1)
    return np.asarray(np.minimum(1.0, (1.0 - coherence) * averages / freedom))


def _over_h1(
    h1: ComplexArray,
    force_power: FloatArray,
    response_power: FloatArray,
    estimator: Estimator,
) -> FloatArray:
    """Return the size of an estimator over that of H1, 1 or more."""
    if estimator is Estimator.H1:
        return np.ones(h1.size)
    shared = np.abs(h1) ** 2 * force_power
    tiny = max(_LEAST_POWER * float(response_power.max()), np.finfo(float).tiny)
    ratio = np.maximum(response_power, tiny) / np.maximum(shared, tiny)
    return np.asarray(ratio if estimator is Estimator.H2 else np.sqrt(ratio))
