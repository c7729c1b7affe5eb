# SPDX-License-Identifier: MIT
"""Settings of the judgement: caps, tolerances and limits of a record."""

from dataclasses import dataclass

from jointbench.analysis.gap.model.setting import numerical


@dataclass(frozen=True, slots=True)
class JudgementSettings:
    """Numbers of the algorithms; unit, purpose and basis are with each field."""

    flat_samples: int = numerical(
        6,
        "pairs",
        "pairs of neighbours at the common maximum from which a record counts as "
        "clipped",
    )
    at_top_sd: float = numerical(
        5.0,
        "sd of the noise",
        "distance from the maximum within which a sample counts as at the maximum",
    )
    near_top_sd: float = numerical(
        20.0,
        "sd of the noise",
        "distance from the maximum within which a sample counts as near it",
    )
    edge_ratio: float = numerical(
        1.5,
        "-",
        "growth of the number of samples between these distances below which the "
        "maximum is an edge",
        "the crest of an oscillation doubles it",
    )
    strong_sd: float = numerical(
        50.0,
        "sd of the noise",
        "maximum from which a record is checked for clipping",
    )
    refit_growth: float = numerical(
        1.5,
        "-",
        "growth of the chi2 of a held-out group in the linear step above which "
        "the other groups are fitted again",
        "single 96253",
    )
    refit_iterations: int = numerical(
        8,
        "steps",
        "most steps of that fit",
    )
    least_conditions: int = numerical(
        3,
        "conditions",
        "number of conditions below which a step is not checked by a refit",
        "two conditions: the other one alone determines nothing",
    )
    most_refits: int = numerical(
        4,
        "conditions",
        "most conditions that are refitted without their records",
        "computing time: a refit takes as long as a judgement",
    )
    refit_noise_sd: float = numerical(
        3.0,
        "sd",
        "difference of step and refit, in sd of chi2, that is noise",
        "closed form",
    )
    refit_tolerance: float = numerical(
        0.05,
        "of chi2",
        "difference of step and refit up to which the step is used elsewhere",
        "a gap is printed with two digits",
    )
    shown_sd: float = numerical(
        4.0,
        "sd",
        "size of a parameter above which all groups together show it",
        "single 105025; no verdict depends on it",
    )
    unshown_sd: float = numerical(
        1.0,
        "sd",
        "size of a parameter below which the groups left do not show it",
        "single 105025; no verdict depends on it",
    )
    part_bands: int = numerical(
        6,
        "bands",
        "frequency bands that are tested for separate parameters",
        "a low-pass named for a delay: six bands disagree by 48 units",
    )
    least_eigenvalue: float = numerical(
        1e-10,
        "of the largest",
        "eigenvalue below which a combination of slopes counts as zero",
        "rounding of double precision",
    )
    same_fault_score: float = numerical(
        0.5,
        "chi2",
        "score difference within which a fault at one channel and at all channels "
        "count as the same fault",
    )
    settling_rounds: int = numerical(
        30,
        "rounds",
        "most rounds of alternating fit and noise estimate",
        "hidden 96060 converged slowly, in more than 12",
    )
    settled_cost: float = numerical(
        2.0,
        "chi2",
        "change of the cost of the best fit below which fit and noise have converged",
        "development campaigns",
    )
    wandering_rounds: int = numerical(
        4,
        "rounds",
        "rounds without an approach to the records after which fit and noise wander",
        "case 26: 30 rounds between chi2/dof 1.38 and 1.51, in no order",
    )
    approach_share: float = numerical(
        0.8,
        "of the excess",
        "lowest excess of these rounds, over that before them, which is no approach",
        "case 26",
    )
    wandering_excess: float = numerical(
        0.05,
        "of dof",
        "excess of chi2 above which rounds may count as wandering",
        "nine sd of chi2 with 16 records: a fit at the noise settles",
    )
    repeated_cost: float = numerical(
        20.0,
        "chi2",
        "difference from the cost of two rounds before below which a fit alternates",
        "pair 107076: 105 s to be unknown",
    )
    overtaking_rounds: int = numerical(
        2,
        "rounds",
        "number of times that a rival which overtakes the best fit is judged",
        "development campaigns",
    )
    refit_score: float = numerical(
        1000.0,
        "chi2",
        "score difference up to which a rival is fitted again with the new noise",
        "development campaigns",
    )
    refit_score_failed: float = numerical(
        100.0,
        "chi2",
        "the same where the best fit does not explain the records",
        "development campaigns",
    )
    gain_share: float = numerical(
        0.2,
        "of the gain",
        "score difference, relative to the gain of the best fit by its noise "
        "estimate, up to which a rival may overtake it",
        "development campaigns",
    )
    hidden_rivals: int = numerical(
        3,
        "fits",
        "most rivals that are fitted again for that reason",
        "a low-pass and a preload law 7 % of the cost from the best",
    )
    own_noise_fits: int = numerical(
        2,
        "fits",
        "most fits that are judged with their own noise estimate if the best fit fails",
        "a maxwell that a delay had beaten",
    )


JUDGEMENT = JudgementSettings()
