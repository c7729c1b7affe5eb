# SPDX-License-Identifier: MIT
"""Settings of the verdict under model error: discrepancy, fits of laws, scores."""

from dataclasses import dataclass

from jointbench.analysis.gap.model.setting import numerical


@dataclass(frozen=True, slots=True)
class ModelErrorSettings:
    """Numbers of the algorithms; unit, purpose and basis are with each field."""

    bands: int = numerical(
        8,
        "bands",
        "logarithmic bands in which the discrepancy is estimated and laws are scored",
        "a prototype on 65 campaigns with model error",
    )
    least_lines: int = numerical(
        4,
        "lines",
        "width of the lowest band, and of the smoothing of a spectrum",
    )
    highest_line: float = numerical(
        0.4,
        "of the sample rate",
        "highest line that is compared, inside the pass band of an anti-alias filter",
        "the pass band ends at 0.42 of the sample rate",
    )
    least_signal: float = numerical(
        10.0,
        "of the noise power",
        "signal below which a band of a record is not compared",
        "below it the noise, and not the model, decides the power left",
    )
    noise_rounds: int = numerical(
        4,
        "rounds",
        "rounds of the estimate of coherent and incoherent discrepancy",
        "a prototype on 65 campaigns with model error",
    )
    base_rounds: int = numerical(
        3,
        "rounds",
        "rounds of fit and estimate for the base",
        "a prototype on 65 campaigns with model error",
    )
    largest_leverage: float = numerical(
        0.5,
        "-",
        "share of one record in the common error of its hit point above which the "
        "record does not count in the incoherent discrepancy",
    )
    base_prior_sd: float = numerical(
        0.02,
        "-",
        "least prior sd of a base parameter, since nominal values may be wrong",
        "masses of the judge's benches are off by 1 %",
    )
    base_iterations: int = numerical(
        8,
        "steps",
        "most steps of a fit of the base",
    )
    starts: int = numerical(
        2,
        "starts",
        "starts of a law, those of the largest directed drops",
        "friction laws that never slip are a start trap",
    )
    law_iterations: int = numerical(
        8,
        "steps",
        "most steps of the fit of a law",
    )
    first_damping: float = numerical(
        1e-6,
        "-",
        "first damping of a descent, of the scaled curvature",
    )
    shorter_steps: int = numerical(
        4,
        "steps",
        "steps tried in a descent, each with 30 times the damping",
    )
    least_drop_share: float = numerical(
        5e-4,
        "of dof",
        "drop of the cost below which a fit has converged: it changes the log power "
        "by less than a thousandth",
        "closed form",
    )
    members: int = numerical(
        2,
        "laws",
        "laws of each family that are fitted again under the final discrepancy",
    )
    least_conditions: int = numerical(
        4,
        "conditions",
        "conditions below which no law is judged: the standard error of fewer means "
        "nothing",
    )
    visible_gain: float = numerical(
        0.1,
        "-",
        "expected gain of log power below which a condition has no vote: its hits "
        "show no difference between the two explanations",
    )


MODEL_ERROR_SETTINGS = ModelErrorSettings()
