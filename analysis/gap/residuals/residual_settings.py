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
        "steps of a final fit that differs from the usual by more than the "
        "integration error allowed",
        "a stop of 75,000 times the noise (test_converter_edge.py): chi2/dof 1.19 "
        "at four steps, 1.003 at eight",
    )
    window_reach: float = numerical(
        3.5,
        "decay times",
        "length at which a windowed record is cut",
        "exp(-3.5) of the window is left",
    )
    force_padding: int = numerical(
        48,
        "samples",
        "samples kept on each side of a hit",
        "the anti-alias filter rings that far",
    )
    noise_band: tuple[float, float] = numerical(
        (0.30, 0.497),
        "of the sample rate",
        "band in which the noise is estimated, above any response to a hammer",
        "the tip of a hammer cuts off far below",
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
    largest_scatter: float = numerical(
        0.004,
        "-",
        "largest relative scatter between hits that is tried",
        "five times that of a poor operator",
    )
    smallest_scatter: float = numerical(
        2e-7,
        "-",
        "smallest relative scatter between hits that is tried",
        "loosening 95054: a coarser grid took a rest of 1e-6 for 2e-5",
    )
    uninformative_share: float = numerical(
        0.3,
        "of the response",
        "residual above which a fit is not used to estimate the settling of hits",
    )
    least_stiffness_factor: float = numerical(
        1e-3,
        "-",
        "smallest share of a stiffness that a settling may leave",
        "keeps the logarithm finite",
    )
    settling_reach: float = numerical(
        40.0,
        "sd of the scatter",
        "largest settling about which the model is expanded: a joint that loosens "
        "by 17 sd is met at the stiffness of each hit",
        "105020, 106030, 106052, 106076, 106096, 106164; eight draws of 3 to 9 % "
        "loosening, all named",
    )
    diverged_reach: float = numerical(
        4.0,
        "sd of the scatter",
        "the same where the fit is far from the records",
        "scale of all parameters off by 40 % when a trend passed for scatter",
    )
    scatter_step: float = numerical(
        1e-6,
        "-",
        "difference step of the ways to scatter",
        "at 1e-4 the late record departs from its slope by 1 %",
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
        "prior sd of the filter about its usual end: anything from open to shut",
        "case 48, and a test with another filter",
    )
    edge_chi2: float = numerical(
        10.0,
        "chi2",
        "chi2 that a law must make up at the end of the pass band for the end to "
        "be estimated",
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
