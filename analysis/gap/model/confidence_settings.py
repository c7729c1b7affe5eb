# SPDX-License-Identifier: MIT
"""Coefficients and ranges of the confidence of a name."""

from dataclasses import dataclass

from jointbench.analysis.gap.model.setting import numerical


@dataclass(frozen=True, slots=True)
class ConfidenceSettings:
    """Numbers of the logistic model; unit, purpose and basis are with each field."""

    intercept: float = numerical(
        1.560,
        "logit",
        "confidence without any further evidence",
        "benchmarks/gap/calibrate.py on 15 forced answers (seeds 130000 to 130014), "
        "with a prior of 0.3 +- 0.3 on each slope",
    )
    slopes: tuple[float, ...] = numerical(
        (0.298, -0.342, -0.345, -0.57, -0.364, -0.329, 0.26, -0.3),
        "logit/decade",
        "change of the logit by margin, excess, probe, left, scatter, deviation, "
        "amplitude, and by a second effect",
        "benchmarks/gap/calibrate.py on 15 forced answers (seeds 130000 to 130014), "
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
