# SPDX-License-Identifier: MIT
"""Expected gain of an experiment: outcomes drawn under each surviving explanation."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.linalg

from jointbench.acquisition.basics.arrays import FloatArray, freeze

_LEAST = 1e-12
_LEAST_DRAWS = 20


@dataclass(frozen=True, slots=True, eq=False)
class Forecast:
    """What one explanation expects of the data of an experiment.

    Attributes:
        score: of the explanation on the data so far.
        mean: of the new data, shape (n,).
        covariance: with the uncertainty of all parameters, shape (n, n).
    """

    score: float
    mean: FloatArray
    covariance: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "mean", "covariance")


@dataclass(frozen=True, slots=True)
class ExpectedGain:
    """What an experiment is expected to give.

    Attributes:
        before: probability of the true explanation before it [-].
        after: expected probability after it [-].
        decided: probability that one explanation is left by the rule of rivals [-].
        wrong: probability that this one is not the true one [-].
    """

    before: float
    after: float
    decided: float
    wrong: float

    @property
    def gain(self) -> float:
        """Expected gain of probability [-]."""
        return self.after - self.before


def expected_gain(
    forecasts: Sequence[Forecast], rival_score: float, *, draws: int, seed: int = 0
) -> ExpectedGain:
    """Simulate an experiment under every explanation and judge the outcomes.

    Parameters are marginalised to first order: the covariance of a forecast holds
    them, so that the rise of an explanation's cost is the squared distance of the
    outcome from its forecast.

    Args:
        forecasts: of the explanations that survive.
        rival_score: score difference from which an explanation is excluded.
        draws: simulated outcomes, shared by the explanations.
        seed: of the draws.

    Source:
        Lindley 1956, Ann. Math. Stat. 27, 986; Box and Hill 1967, Technometrics 9, 57,
        for the discrimination of models.
    """
    rng = np.random.default_rng(seed)
    scores = np.array([f.score for f in forecasts])
    prior = _weights(scores)
    roots = [scipy.linalg.cholesky(_safe(f.covariance), lower=True) for f in forecasts]
    totals = np.zeros(4)
    each = max(draws // len(forecasts), _LEAST_DRAWS)
    for true, forecast in enumerate(forecasts):
        white = rng.standard_normal((forecast.mean.size, each))
        outcome = forecast.mean[:, None] + roots[true] @ white
        found = np.empty((len(forecasts), each))
        for k, (other, root) in enumerate(zip(forecasts, roots, strict=True)):
            off = scipy.linalg.solve_triangular(
                root, outcome - other.mean[:, None], lower=True
            )
            found[k] = scores[k] + np.sum(off**2, axis=0)
        posterior = _weights(found)
        ranked = np.sort(found, axis=0)
        clear = ranked[1] - ranked[0] >= rival_score
        wrong = clear & (np.argmin(found, axis=0) != true)
        totals += prior[true] * np.array(
            [prior[true], posterior[true].mean(), clear.mean(), wrong.mean()]
        )
    return ExpectedGain(*(float(one) for one in totals))


def _weights(scores: FloatArray) -> FloatArray:
    """Return probabilities of scores along the first axis."""
    weight = np.exp(-0.5 * (scores - scores.min(axis=0)))
    found: FloatArray = weight / weight.sum(axis=0)
    return found


def _safe(covariance: FloatArray) -> FloatArray:
    """Return a covariance that has a Cholesky factor."""
    scale = float(np.trace(covariance)) / len(covariance)
    return np.asarray(covariance + _LEAST * scale * np.eye(len(covariance)))
