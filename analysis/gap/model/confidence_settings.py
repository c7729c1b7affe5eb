# SPDX-License-Identifier: MIT
"""Coefficients and ranges of the confidence of a name."""

from dataclasses import dataclass

from jointbench.analysis.gap.model.setting import numerical


@dataclass(frozen=True, slots=True)
class ConfidenceSettings:
    """Numbers of the logistic model; unit, purpose and basis are with each field."""

    intercept: float = numerical(
        0.753,
        "logit",
        "confidence without any further evidence",
        "benchmarks/gap/calibrate.py on 308 forced answers (seeds 210002 to 210368), "
        "with a prior of 0.3 +- 0.3 on each slope",
    )
    slopes: tuple[float, ...] = numerical(
        (0.786, -1.266, -0.856, -0.343, -0.367, -0.453, 0.332, -0.3),
        "logit/decade",
        "change of the logit by margin, excess, probe, left, scatter, deviation, "
        "amplitude, and by a second effect",
        "benchmarks/gap/calibrate.py on 308 forced answers (seeds 210002 to 210368), "
        "with a prior of 0.3 +- 0.3 on each slope",
    )
    margin_range: tuple[float, float] = numerical(
        (1.0, 1e5),
        "chi2",
        "margins between which the confidence changes",
    )
    limit_range: tuple[float, float] = numerical(
        (0.1, 1e3),
        "of the limit",
        "distances from a limit between which the confidence changes",
    )
    left_range: tuple[float, float] = numerical(
        (1e-7, 1.0),
        "of the excess chi2",
        "shares left between which the confidence changes",
    )
    scatter_range: tuple[float, float] = numerical(
        (1e-5, 1e-1),
        "-",
        "scatters between which the confidence changes",
    )
    amplitude_range: tuple[float, float] = numerical(
        (1.0, 1e3),
        "sd",
        "amplitudes between which the confidence changes",
    )


CONFIDENCE = ConfidenceSettings()
