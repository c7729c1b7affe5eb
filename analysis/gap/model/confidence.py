# SPDX-License-Identifier: MIT
"""Convert the evidence for a name into a probability that it is right."""

from dataclasses import dataclass

import numpy as np

from jointbench.analysis.gap.model.confidence_settings import CONFIDENCE


@dataclass(frozen=True, slots=True)
class Evidence:
    """Quantities from which the confidence of a name is computed.

    Attributes:
        margin: score of the nearest rival of another name or site, less the best's.
        slack: distance of the best fit's chi2 from its limit, from 0 (at the limit) to
            1 (at or below the chi2 of noise alone) [-].
        amplitude: smallest distance of an amplitude from OFF [sd].
        effects: number of effects named.
        excess: excess of chi2/dof over its limit [-]; 1 at the limit.
        probe: largest remaining directed test over its limit [-]; 1 at the limit.
        left: share of the base's excess chi2 that is left: the distance of the records
            from everything that the catalogue can make [-].
        scatter: relative scatter between hits that is whitened [-].
        deviation: largest prior deviation over its limit [-]; 1 at the limit.
    """

    margin: float
    slack: float
    amplitude: float
    effects: int
    excess: float = 0.0
    probe: float = 0.0
    left: float = 0.0
    scatter: float = 0.0
    deviation: float = 0.0


@dataclass(frozen=True, slots=True)
class Regressor:
    """One regressor of the logistic model: a clipped logarithm of the evidence."""

    name: str
    floor: float
    top: float

    def of(self, value: float) -> float:
        """Return the decades of a value above the floor, at most to the top [-]."""
        return float(np.log10(np.clip(value, self.floor, self.top) / self.floor))


REGRESSORS = (
    Regressor("margin", *CONFIDENCE.margin_range),
    Regressor("excess", *CONFIDENCE.limit_range),
    Regressor("probe", *CONFIDENCE.limit_range),
    Regressor("left", *CONFIDENCE.left_range),
    Regressor("scatter", *CONFIDENCE.scatter_range),
    Regressor("deviation", *CONFIDENCE.limit_range),
    Regressor("amplitude", *CONFIDENCE.amplitude_range),
)


def features(evidence: Evidence) -> tuple[float, ...]:
    """Return the regressors of the logistic model, in the order of its slopes."""
    found = [r.of(float(getattr(evidence, r.name))) for r in REGRESSORS]
    return (*found, float(evidence.effects > 1))


def confidence_of(
    evidence: Evidence,
    slopes: tuple[float, ...] = CONFIDENCE.slopes,
    intercept: float = CONFIDENCE.intercept,
) -> float:
    """Return the probability that name and site are right [-]."""
    logit = intercept + float(np.dot(slopes, features(evidence)))
    return float(1.0 / (1.0 + np.exp(-logit)))
