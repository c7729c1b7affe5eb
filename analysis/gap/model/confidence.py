# SPDX-License-Identifier: MIT
"""From margins to a probability of being right."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, slots=True)
class Evidence:
    """What the confidence of a name rests on.

    Attributes:
        margin: score of the nearest rival of another name or site, less the best's.
        slack: how far the chi2 of the winner stays inside its gate, from 0 (on the
            limit) to 1 (at or below what noise alone leaves) [-].
        amplitude: smallest distance of an amplitude from OFF [sd].
        effects: how many effects are named.
    """

    margin: float
    slack: float
    amplitude: float
    effects: int


@dataclass(frozen=True, slots=True)
class Calibration:
    """Coefficients of a logistic model of the evidence.

    Attributes:
        intercept: of the logit.
        margin: per decade of the margin over 15.
        slack: per unit of slack.
        amplitude: per decade of the amplitude over 4 sd.
        second: for a second effect.
        record: how and on what the numbers were found.
    """

    intercept: float
    margin: float
    slack: float
    amplitude: float
    second: float
    record: str


CALIBRATION = Calibration(
    intercept=2.161,
    margin=0.0,
    slack=0.885,
    amplitude=0.0,
    second=0.0,
    record="benchmarks/gap/calibrate.py on 85 names told of 168 simulated campaigns, "
    "seeds 70000 and on (two effects and effects taken out: of an earlier state); one "
    "campaign in ten taken to hide what no catalogue has",
)


def features(evidence: Evidence) -> tuple[float, float, float, float]:
    """Return the regressors of the logistic model, in the order of `Calibration`."""
    return (
        float(np.clip(np.log10(max(evidence.margin, 1.0) / 15.0), -1.2, 3.0)),
        float(np.clip(evidence.slack, 0.0, 1.0)),
        float(np.clip(np.log10(max(evidence.amplitude, 1.0) / 4.0), -0.6, 2.0)),
        float(evidence.effects > 1),
    )


def confidence_of(evidence: Evidence, calibration: Calibration = CALIBRATION) -> float:
    """Return the probability that name and site are right [-]."""
    margin, slack, amplitude, second = features(evidence)
    logit = (
        calibration.intercept
        + calibration.margin * margin
        + calibration.slack * slack
        + calibration.amplitude * amplitude
        + calibration.second * second
    )
    return float(1.0 / (1.0 + np.exp(-logit)))
