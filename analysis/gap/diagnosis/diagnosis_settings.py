# SPDX-License-Identifier: MIT
"""Settings of the diagnosis: rounds of the search, and contents of the evidence."""

from dataclasses import dataclass

from jointbench.analysis.gap.model.setting import numerical


@dataclass(frozen=True, slots=True)
class DiagnosisSettings:
    """Numbers of the algorithms; unit, purpose and basis are with each field."""

    most_effects: int = numerical(
        3,
        "effects",
        "most effects of one explanation",
        "three at one link can imitate any law",
    )
    first_effects: int = numerical(
        3,
        "fits",
        "single effects to which a second is added",
        "development campaigns",
    )
    second_cost_ratio: float = numerical(
        4.0,
        "-",
        "excess of the cost over the smallest above which no second effect is added "
        "to a single one",
        "development campaigns",
    )
    noise_excess: float = numerical(
        0.01,
        "of dof",
        "excess of the cost that noise alone may cause",
        "closed form",
    )
    wrong_minimum_chi2: float = numerical(
        2.0,
        "-",
        "chi2/dof above which a base may have stopped in a wrong minimum",
        "3 of 1,500 null draws (docs/gap-null.md), null 80290",
    )
    second_candidates: int = numerical(
        4,
        "effects",
        "second effects tried on each first, by their directed tests",
        "development campaigns",
    )
    needless_gain: float = numerical(
        1000.0,
        "chi2",
        "gain of the best fit by its noise estimate above which one of its effects "
        "may be unnecessary",
        "hidden 96060",
    )
    base_rounds: int = numerical(
        12,
        "rounds",
        "most rounds of alternating base fit and noise estimate",
        "nulls of docs/gap-null.md",
    )
    base_approach_share: float = numerical(
        0.5,
        "of the cost",
        "cost of a base far from the records, over that of the round before, above "
        "which rounds of fit and noise estimate end",
        "case 14: the rounds repeat four costs without end",
    )
    base_settled_cost: float = numerical(
        0.5,
        "chi2",
        "change of the cost below which base and noise have converged",
        "nulls of docs/gap-null.md",
    )
    settled_share: float = numerical(
        0.5,
        "of chi2",
        "chi2 of a base expanded about the settled hits, relative to the usual base, "
        "below which it is used",
        "26 of 36 quiet draws: all end between 0.97 and 1.03",
    )
    no_rival_score: float = numerical(
        1e12,
        "chi2",
        "score of a rival if none was fitted",
        "larger than any cost",
    )
    one_record_share: float = numerical(
        0.8,
        "of the residual",
        "share of one record from which that record is reported as faulty",
    )
    scored_steps: int = numerical(
        8,
        "steps/sample",
        "steps of the time integration on parts of a record that no fit has seen",
        "Silverbox",
    )
    held_out_score: float = numerical(
        200.0,
        "chi2",
        "score difference within which a rival competes again when a condition is held "
        "out",
        "a condition holds a tenth of the records, and of a difference of 2,000",
    )
    held_out_rivals: int = numerical(
        2,
        "fits",
        "most rivals that compete again",
        "computing time",
    )
    outstanding_sd: float = numerical(
        4.0,
        "sd",
        "deviation of a hit, in sd of its direction, above which it is listed",
        "closed form: one hit in 16,000 by chance",
    )
    repeat_share: float = numerical(
        0.3,
        "of the residual",
        "share of the residual of a record that its repeats must leave as well, for it "
        "to belong to the condition and not to the hit",
    )
    clear_sd: float = numerical(
        4.0,
        "sd",
        "distance from zero at which the estimate of a record counts",
        "closed form: one test in 16,000 by chance",
    )
    taken_share: float = numerical(
        0.3,
        "of the residual",
        "share that the estimates of the records must explain to be reported",
    )
    uneven_ratio: float = numerical(
        2.0,
        "-",
        "ratio of relative residuals between channels from which it is reported",
    )
    growth_ratio: float = numerical(
        0.7,
        "-",
        "relative residual at the next lower level, over the highest, below which "
        "it grows with level",
    )
    mainly_share: float = numerical(
        0.6,
        "of the residual",
        "share of a channel from which the residual is mainly on it",
    )
    band_share: float = numerical(
        0.8,
        "of the residual",
        "share of the residual within the reported band",
    )
    level_force_floor: float = numerical(
        0.05,
        "of the largest line",
        "line of a force below which a ratio to it is not used",
    )
    vague_sd: float = numerical(
        0.15,
        "-",
        "sd above which a recurrence is not reported",
    )
    linear_within: float = numerical(
        0.35,
        "-",
        "departure of a ratio of levels from 1 within which the residual is "
        "linear in level",
    )
    level_step: float = numerical(
        1e-4,
        "-",
        "difference step of the joint stiffness in the evidence",
    )
    figure_share: float = numerical(
        0.9,
        "of the residual",
        "share of the residual of a record that the window of the figure holds",
    )
    figure_lead: float = numerical(
        1e-3,
        "s",
        "time before the hit in the figure",
    )
    figure_least_samples: int = numerical(
        256,
        "samples",
        "shortest window of the figure",
    )
    figure_most_samples: int = numerical(
        2048,
        "samples",
        "longest window of the figure",
    )
    figure_lines: int = numerical(
        400,
        "lines",
        "lines of a response function in the figure",
    )
    figure_force_floor: float = numerical(
        0.03,
        "of the largest line",
        "line of the force below which a response function is not drawn",
    )
    figure_bands: int = numerical(
        48,
        "bands/decade",
        "bands that the spectrum of the residual is averaged over",
    )
    figure_tests: int = numerical(
        8,
        "tests",
        "directed tests that the evidence keeps",
    )
    prior_candidates_sd: float = numerical(
        3.5,
        "sd",
        "prior deviation above which effects that only priors show are tried as a "
        "second effect",
        "below the limit of 4 sd at which a fit is rejected",
    )
    one_sided_quantile: float = numerical(
        1.645,
        "sd",
        "reach of the limit of an effect that has one sign",
        "closed form: 95 %",
    )
    two_sided_quantile: float = numerical(
        1.96,
        "sd",
        "reach of the limit of an effect that may have either sign",
        "closed form: 95 %",
    )
    longest_check: int = numerical(
        8192,
        "samples",
        "longest record that the second method predicts",
        "computing time: 0.3 to 2 s for 1,024 samples",
    )
    check_tolerance: float = numerical(
        1e-10,
        "of the state",
        "local error of the second method, which is a multistep one for one record",
        "the difference of the methods is that of DOP853 at 1e-8, in half the time",
    )

    curve_draws: int = numerical(
        12,
        "draws",
        "draws of the covariance of a fit, for the bands of the curves of its laws",
        "the sd of a band is known to 20 %",
    )
    curve_amplitudes: int = numerical(
        16,
        "amplitudes",
        "amplitudes of the curves of a law",
        "smooth to the eye on a log scale",
    )
    least_amplitude: float = numerical(
        1 / 300,
        "of the largest motion",
        "smallest amplitude of the curves of a law",
        "softer than the softest hits of a campaign",
    )
    curve_every: int = numerical(
        3,
        "amplitudes",
        "every such amplitude is drawn as a loop, from the largest",
        "loops stay apart to the eye",
    )
    curve_spacing: float = numerical(
        0.7,
        "in ln a",
        "distance of the amplitudes at which measured and predicted curves of modes "
        "are compared",
        "widest knots of a measured curve: closer points are correlated",
    )
    curve_near: float = numerical(
        0.05,
        "-",
        "largest relative distance in frequency of a measured mode from that of the "
        "base",
        "five half-power widths of a joint with 1 % of damping",
    )
    curve_harmonic_error: float = numerical(
        0.1,
        "-",
        "relative error of a predicted change, added to its uncertainty",
        "first harmonic of a law instead of its force; shapes of decays",
    )
    curve_consistent: float = numerical(
        2.0,
        "sd",
        "deviation of a measured change up to which a predicted one is consistent",
        "normal errors: 95 % of right laws",
    )
    curve_inconsistent: float = numerical(
        3.0,
        "sd",
        "deviation above which a predicted change is inconsistent with the measured "
        "one",
        "normal errors: 0.3 % of right laws",
    )
    curve_known: float = numerical(
        0.5,
        "-",
        "relative sd of a measured change above which it decides nothing",
        "no change and the predicted one are then within two sd",
    )
    curve_margin: float = numerical(
        2.0,
        "-",
        "factor by which the amplitudes of a law exceed those of a measured curve",
        "mode shapes turn by less over the amplitudes of a joint",
    )
    curve_steps: int = numerical(
        32,
        "amplitudes",
        "amplitudes at which a predicted curve is computed",
        "harmonic balance of two bodies: interpolated to 20 ppm",
    )
    curve_rounds: int = numerical(
        2,
        "rounds",
        "repetitions for the motion across the links of further laws",
        "mode shapes turn little from one amplitude to the next",
    )


DIAGNOSIS = DiagnosisSettings()
