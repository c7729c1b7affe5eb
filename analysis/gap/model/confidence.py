# SPDX-License-Identifier: MIT
"""Convert the evidence for a name into a probability that it is right."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, slots=True)
class Evidence:
    """Quantities from which the confidence of a name is computed.

    Attributes:
        margin: score of the nearest rival of another name or site, less the best's.
        slack: distance of the best fit's chi2 from its limit, from 0 (at the limit) to
            1 (at or below the chi2 of noise alone) [-].
        amplitude: smallest distance of an amplitude from OFF [sd].
        effects: number of effects named.
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
        record: how, and on which campaigns, the coefficients were estimated.
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
    record="benchmarks/gap/calibrate.py on 85 names reported in 168 simulated "
    "campaigns, seeds 70000 and on (pairs and reduced catalogues: of an earlier "
    "version); one campaign in ten is assumed to hide an effect of no catalogue",
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
