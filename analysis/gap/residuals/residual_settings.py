# SPDX-License-Identifier: MIT
"""Settings of the residuals: evaluation steps, noise, scatter and settling of hits."""

from dataclasses import dataclass

from jointbench.analysis.gap.model.setting import numerical


@dataclass(frozen=True, slots=True)
class ResidualSettings:
    """Numbers of the algorithms; unit, purpose and basis are with each field."""

    middle_steps: int = numerical(
        2,
        "steps/sample",
        "steps of the time integration in a search",
        "convergence tests of the second method",
    )
    full_steps: int = numerical(
        4,
        "steps/sample",
        "steps of the time integration in a final fit",
        "convergence tests of the second method",
    )
    fine_steps: int = numerical(
        8,
        "steps/sample",
        "steps of the time integration in a final fit, if the usual number exceeds "
        "the allowed integration error",
        "a stop of 75,000 times the noise (test_converter_edge.py): chi2/dof 1.19 "
        "at four steps, 1.003 at eight",
    )
    window_reach: float = numerical(
        3.5,
        "decay times",
        "length at which a windowed record is cut",
        "the window has decayed to exp(-3.5)",
    )
    force_paddings: tuple[int, ...] = numerical(
        (8, 12, 16, 24, 32, 48),
        "samples",
        "samples kept on each side of a hit: the fewest beyond which the force is "
        "noise",
        "ringing of the anti-alias filter; a relaxation at the limit of detection: "
        "squared distance 43 with 48 samples, 60 with 16, 82 with the pulse alone",
    )
    padding_noise: float = numerical(
        1.0,
        "sd of chi2",
        "excess of the force beyond a padding, up to which it is noise",
        "a ringing that is missed is then below 5 % of the noise of those samples",
    )
    noise_band: tuple[float, float] = numerical(
        (0.30, 0.497),
        "of the sample rate",
        "band in which the noise is estimated, above any response to a hammer",
        "the force of a hammer ends far below",
    )
    noise_share: float = numerical(
        0.2,
        "of the samples",
        "effective number of samples of the noise estimate",
        "0.39 of the spectrum, halved by the taper",
    )
    least_direction: float = numerical(
        0.03,
        "of the noise",
        "direction of force noise or scatter below which it is neglected: 0.03^2 "
        "of a unit of chi2",
    )
    force_directions: int = numerical(
        8,
        "directions",
        "directions of the force noise that are whitened",
        "they hold most of unit noise in every row",
    )
    least_information: float = numerical(
        1e-11,
        "of the largest",
        "information along a combination of columns below which it counts as none",
        "delays of all channels together are the common delay",
    )
    scatter_gain: float = numerical(
        4.0,
        "-2 log likelihood",
        "gain below which a direction has no scatter",
        "closed form: a chance of 2.3 % for one direction",
    )
    clear_scatter_gain: float = numerical(
        60.0,
        "-2 log likelihood",
        "loss without a direction above which it is significant whatever the others "
        "take over",
    )
    stated_spread: float = numerical(
        0.7,
        "-",
        "prior sd of the logarithm of a size that the nominal parameters state",
        "an operator knows the scatter of the hits within a factor of two",
    )
    scatter_iterations: int = numerical(
        25,
        "steps",
        "most Newton steps to the likeliest sizes",
    )
    scatter_damping: float = numerical(
        0.01,
        "-",
        "first damping of these steps",
    )
    most_damping: float = numerical(
        1e3,
        "-",
        "damping at which they end",
    )
    longest_step: float = numerical(
        4.0,
        "-",
        "longest step in the logarithm of a variance",
    )
    scatter_settled: float = numerical(
        1e-2,
        "-2 log likelihood",
        "gain below which the sizes have converged",
        "a hundredth of what a significant size gains",
    )
    limit_accuracy: float = numerical(
        0.05,
        "-",
        "relative accuracy of a limit by repeats",
    )
    repeat_limit: float = numerical(
        9.5,
        "-2 log likelihood",
        "loss beyond which repeats exclude a size",
        "closed form: a chance of 0.2 % for one direction",
    )
    correlations: tuple[float, ...] = numerical(
        (0.5, 0.8, 0.93),
        "-",
        "correlations between successive hits that are tried",
    )
    correlation_reach: float = numerical(
        12.0,
        "-2 log likelihood",
        "loss at the sizes of hits without correlation, above which correlated hits "
        "are not tried",
    )
    usual_trend: float = numerical(
        0.01,
        "-, samples",
        "prior sd of a trend of the stiffness of a joint over the hits",
        "singles 430004 and 900012 of benchmarks/gap/scatter.py: a loosening of 1e-5 a "
        "hit passed for correlated scatter",
    )
    correlation_gain: float = numerical(
        2.0,
        "-2 log likelihood",
        "gain below which hits are not correlated",
    )
    correlation_doubt: float = numerical(
        4.0,
        "-2 log likelihood",
        "loss up to which a larger correlation than the likeliest is taken",
        "closed form: a chance of 5 %; null 701051 of benchmarks/gap/scatter.py: from "
        "0.5 to 0.97 the loss is 1.2 with eight hits",
    )
    most_correlated: int = numerical(
        64,
        "hits",
        "number of hits above which no correlation between them is estimated",
    )
    most_systematic: int = numerical(
        6,
        "-",
        "most trends and outstanding hits",
        "a campaign with more has no common scatter",
    )
    systematic_tried: int = numerical(
        3,
        "-",
        "trends or hits, best by first order, for which sizes are estimated again",
    )
    systematic_share: float = numerical(
        0.8,
        "-",
        "gain by first order, over that of a trend at its chance, below which no trend "
        "or hit is tried",
    )
    outstanding_sd: float = numerical(
        1.0,
        "-, samples",
        "prior sd of a hit that stands out",
        "a hit that is 100 % off is not recorded",
    )
    least_outstanding: float = numerical(
        0.005,
        "-, samples",
        "deviation below which no hit stands out",
        "good hits scatter by as much",
    )
    least_hits: int = numerical(
        6,
        "hits",
        "number of hits below which neither trends nor outstanding hits are looked for",
    )
    flat_samples: int = numerical(
        4,
        "samples",
        "samples at the same largest value from which a channel counts as clipped",
    )
    gain_reach: float = numerical(
        0.5,
        "-",
        "largest gain of a hit less 1 about which a clipped channel is expanded",
        "beyond it a hit is a bad one, whose gain no expansion should follow",
    )
    least_grown: float = numerical(
        0.3,
        "-",
        "least factor by which a response changes beside the gains of its hits",
        "a response that shrank by more is another one, whose gains are unknown",
    )
    gain_rounds: int = numerical(
        3,
        "rounds",
        "estimates of the gains of hits ahead of a converter that clips",
        "each squares the error of the last: 3 % leave 1e-6 after three",
    )
    delay_step: float = numerical(
        1e-3,
        "samples",
        "difference step of the delay",
        "its second order is 1e-3 of the first at half the sample rate",
    )
    smallest_scatter: float = numerical(
        2e-7,
        "-",
        "smallest relative scatter between hits that is tried",
        "loosening 95054: a coarser grid estimated a scatter of 1e-6 as 2e-5",
    )
    uninformative_share: float = numerical(
        0.3,
        "of the response",
        "residual above which a fit is not used to estimate the settling of hits",
    )
    least_stiffness_factor: float = numerical(
        1e-3,
        "-",
        "smallest share of a stiffness after settling",
        "keeps the logarithm finite",
    )
    settling_reach: float = numerical(
        40.0,
        "sd of the scatter",
        "largest settling about which the model is expanded: a joint that loosens "
        "by 17 sd is modelled at the stiffness of each hit",
        "105020, 106030, 106052, 106076, 106096, 106164; eight draws of 3 to 9 % "
        "loosening, all named",
    )
    scatter_step: float = numerical(
        1e-6,
        "-",
        "difference step of the ways to scatter",
        "at 1e-4 the end of a record deviates from its slope by 1 %",
    )
    least_rise: float = numerical(
        -0.999,
        "of the stiffness",
        "smallest relative change of the stiffness by laws of the joint",
        "keeps the logarithm finite",
    )
    edge_prior_sd: float = numerical(
        0.5,
        "-",
        "prior sd of the filter gain about its default: anything from 1 to 0",
        "case 48, and a test with another filter",
    )
    edge_chi2: float = numerical(
        10.0,
        "chi2",
        "chi2 of a law at the end of the pass band above which the end is estimated",
        "case 48, and a test with another filter",
    )
    view_bands: int = numerical(
        8,
        "bands",
        "slices of time and frequency in which a residual is shown",
    )
    hit_noise_sd: float = numerical(
        8.0,
        "sd of the noise",
        "force above which a sample belongs to a hit",
    )
    hit_share: float = numerical(
        3e-3,
        "of the peak",
        "force above which a sample belongs to a hit, in a quiet record",
    )


RESIDUALS = ResidualSettings()
