# SPDX-License-Identifier: MIT
"""Settings of the contact bench: priors, starts and limits of its verdicts."""

from dataclasses import dataclass

from jointbench.analysis.gap.model.setting import decision, numerical

_SWEPT = "not measured"


@dataclass(frozen=True, slots=True)
class ContactBenchSettings:
    """Numbers of the algorithms; unit, purpose and basis are with each field."""

    null_chance: float = decision(
        3e-4,
        "-",
        "chance of the cost of the base under noise and priors below which something "
        "is missing",
        "the cost at the minimum is chi2 with as many degrees of freedom as rows, "
        "because every parameter has a prior",
        _SWEPT,
    )
    fit_chance: float = decision(
        3e-4,
        "-",
        "chance of the cost of a fit with an effect below which it does not explain "
        "the values",
        "as the null test",
        _SWEPT,
    )
    prior_limit: float = decision(
        4.5,
        "sd",
        "deviation of a base parameter above which a fit is rejected",
        "as for bolted bodies: a joint with 40 states has 50 base parameters",
        _SWEPT,
    )
    null_factor: float = decision(
        1.5,
        "-",
        "factor on the limit of the directed tests, above which something is missing",
        "the law of a surface is not its physics: 217 simulated joints without an "
        "effect (seeds 20000 to 20216), of which 1.3 called 4 other than none",
        _SWEPT,
    )
    amplitude_limit: float = decision(
        5.0,
        "sd",
        "root of the drop of the cost by an effect below which it is not named",
        "the same joints: two names with 4.0 and 4.7 sd",
        _SWEPT,
    )
    model_error: float = decision(
        0.005,
        "of the excess",
        "share of the excess cost of the base that a correct effect may leave",
        "campaigns of benchmarks/gap/contact_campaigns.py, seeds below 2000: the "
        "formula of an effect is not the physics of a joint",
        _SWEPT,
    )
    slip_error: float = decision(
        0.02,
        "of the excess",
        "the same of partial slip",
        "contacts of one height each on simulated surfaces, seeds 308, 60008, 60023",
        _SWEPT,
    )
    slip_exponent: float = numerical(
        0.6,
        "-",
        "median of the exponent of the tangential stiffness over the share of sliding",
        "1/3 for one contact (Mindlin 1949), near 1 for many of random height "
        "(Bjorklund 1997, J. Tribol. 119, 726)",
    )
    slip_exponent_sd: float = numerical(
        0.5, "-", "prior sd of its logarithm", "1/3 and 1 within about one sd"
    )
    least_slip: float = numerical(
        1e-3, "-", "share of the sliding force below which the loss grows with it"
    )
    near_one: float = numerical(
        1e-6, "-", "distance of an exponent from 1 within which its integral is a log"
    )
    flattening_error: float = decision(
        0.06,
        "of the excess",
        "the same of plastic flattening",
        "summits unloaded one by one leave 4 % (seed 60035): no power of the preload",
        _SWEPT,
    )
    least_levels: int = decision(
        3,
        "levels",
        "torques or preloads below which nothing can be determined",
        "a slope and its curvature need three",
        _SWEPT,
    )
    least_ratio: float = decision(
        1.5,
        "-",
        "highest over lowest preload below which nothing can be determined",
        "within it a compliance, an exponent and a factor of the law look alike",
        _SWEPT,
    )
    shown_chance: float = decision(
        1e-3,
        "-",
        "chance of the difference between two groups of assemblies below which the "
        "joint counts as changed",
        "one wrong alarm in a thousand comparisons",
        _SWEPT,
    )
    law_factor_sd: float = numerical(
        0.5,
        "-",
        "prior sd of ln(stiffness of the joint over that of the law)",
        "laws of one surface differ by a factor of 1.5 to 2 (docs/contact-oracle.md)",
    )
    applying_factor_sd: float = numerical(
        0.1,
        "-",
        "the same of a law of measured surfaces whose range holds every preload",
        "sd of ln ratio 0.083, mean ratio 0.959 (docs/contact-measured-surfaces.md)",
    )
    outside_factor_sd: float = numerical(
        0.3,
        "-",
        "the same where its range does not hold every preload",
        "Persson outside its range: 0.297 (docs/contact-measured-surfaces.md)",
    )
    bolts_sd: float = numerical(
        0.15,
        "-",
        "prior sd of ln of the stiffness of the bolts by their length and diameter",
        "head, nut and thread lengthen or thin a bolt by 10 to 20 %: VDI 2230, "
        "sec. 5.1",
    )
    wave_height: float = numerical(
        1.5e-6,
        "m",
        "nominal rms height of the waves of both surfaces that were not measured",
        "waviness of ground and milled surfaces: 0.4 to 6 um",
    )
    wave_sd: float = numerical(
        0.7,
        "-",
        "prior sd of ln of that height",
        "0.4 to 6 um within 2 sd",
    )
    wave_share: float = numerical(
        0.25,
        "of the side",
        "length over which surfaces must be measured to show their waves",
        "heights of waves grow with their length, so that the longest ones count",
    )
    law_power_sd: float = numerical(
        0.02,
        "-",
        "prior sd of the exponent of the preload beyond that of the law",
        "sums over simulated summits differ from the moments of the same surfaces by "
        "0.002 to 0.032 (benchmarks/gap/contact_physics.py, eight surfaces)",
    )
    ratio_sd: float = numerical(
        0.15,
        "-",
        "prior sd of ln of the ratio of tangential and rocking to normal stiffness",
        "Mindlin's ratio changes by 0.1 between Poisson ratios of 0.2 and 0.35",
    )
    loss_sd: float = numerical(
        1.0,
        "-",
        "prior sd of ln of the loss factor of the contacts",
        "joints of machines: 0.005 to 0.1",
    )
    loss_factor: float = numerical(
        0.02,
        "-",
        "nominal loss factor of the contacts",
        "joints of machines: 0.005 to 0.1",
    )
    assembly_share: float = numerical(
        0.3,
        "of the scatter",
        "sd of one quantity from assembly to assembly, apart from that common to all",
        "contacts change together; no campaign set it",
    )
    known_size_sd: float = numerical(
        0.3,
        "-",
        "prior sd of ln of the size of an effect that geometry and modulus give",
        "a square and a circle differ by 12 %; neighbours add 20 %",
    )
    known_ratio_sd: float = numerical(
        0.1,
        "-",
        "prior sd of ln of the tangential over the normal compliance of a constriction",
        "Mindlin's ratio between Poisson ratios of 0.2 and 0.35",
    )
    free_ratio_sd: float = numerical(
        0.5,
        "-",
        "the same of bodies and bolts",
        "bolts are softer in bending, bodies in shear; no campaign set it",
    )
    bound_sd: float = numerical(
        0.05,
        "-",
        "width of the likelihood of a value that is known from below only",
        "the profile falls from 0.9 to 0.1 within 15 % of the bound",
    )
    hurst: float = numerical(
        0.8,
        "-",
        "Hurst exponent by which slope and curvature depend on the instrument's cut",
        "machined surfaces: 0.7 to 0.9; a law may state its own",
    )
    law_margin: tuple[float, float] = numerical(
        (4.0, 5.0),
        "ln N",
        "range of the preload below and above that of the states in which a law is "
        "evaluated",
        "a prevailing torque may take 98 % of the preload, pressure cones 1 % of the "
        "area",
    )
    law_points: int = numerical(
        61, "points", "points of the preload at which a law is evaluated"
    )
    law_step: float = numerical(
        1e-3,
        "-",
        "difference step of the logarithm of a parameter of a law",
        "central differences: error below 1e-6 of the slope",
    )
    model_sd: float = numerical(
        0.015,
        "-",
        "sd of ln of the formulas of a law over the physics, at a torque of its own",
        "sums over single summits of eight surfaces depart by up to 2 % at the ends of "
        "the range from a law whose factor and exponent are fitted",
    )
    range_points: int = numerical(
        7, "points", "preloads at which the range of a law is tested"
    )
    surface_directions: int = numerical(
        3,
        "directions",
        "principal directions of the uncertainty of a measured surface",
        "two hold over 99 % of the scatter of ln k of the real surfaces",
    )
    least_surface_sd: float = numerical(
        1e-3, "-", "sd of ln k below which such a direction is left out"
    )
    law_reach: float = numerical(
        2.0,
        "sd",
        "distance from the nominal inputs within which a law is linearised",
        "a fit without the missing effect moves them by up to 8 sd",
    )
    slope_step: float = numerical(
        1e-6, "-", "difference step of a base coordinate", "as in a descent"
    )
    reach: float = numerical(
        8.0,
        "sd",
        "bound of a base coordinate",
        "far above the limit of a verdict",
    )
    descent_steps: int = numerical(
        40, "steps", "most steps of a fit", "the cost of a step is under 3 ms"
    )
    cut_sd: float = numerical(
        1.0,
        "-",
        "prior sd of ln of the true shortest wavelength over that of the instrument",
        "stylus tips of 2 to 10 um, pixels of 0.2 to 2 um",
    )
    first_steps: int = numerical(
        6,
        "steps",
        "steps of every start of an effect; the best one is then fitted to the end",
        "made joints",
    )
    starts: int = numerical(
        3, "starts", "starts of each effect that are fitted", "made joints"
    )
    close_fits: int = numerical(
        4,
        "fits",
        "best fits that are fitted again with the law linearised at the best one",
        "made joints",
    )
    gap_slope: float = numerical(
        0.18,
        "-",
        "relative fall of the gap between rough bodies per unit of ln preload",
        "Gaussian summits: u_0 of 0.4 h_rms at a gap of 2 to 3 h_rms",
    )
    most_ratio: float = numerical(
        0.999,
        "-",
        "largest tangential force over friction at which contacts still stick",
    )
    relaxation_start: float = numerical(
        60.0, "s", "time after which relaxation is counted", "re-tightening takes it"
    )
    interval_z: float = numerical(
        1.959964, "sd", "half width of an interval of 95 %", "closed form"
    )
    bound_z: float = numerical(1.644854, "sd", "one-sided limit of 95 %", "closed form")


CONTACT = ContactBenchSettings()
