# SPDX-License-Identifier: MIT
"""Settings of the bench of bolted bodies and of its search."""

from dataclasses import dataclass

from jointbench.analysis.gap.model.setting import numerical


@dataclass(frozen=True, slots=True)
class StructureSettings:
    """Numbers of the algorithms; unit, purpose and basis are with each field."""

    line_damping: float = numerical(
        10.0,
        "-",
        "decay of the damped line over a transform: what wraps around is reduced by "
        "exp(-10), and errors at its end grow by as much",
        "5e-5 of the first response is below every floor",
    )
    padding: tuple[float, int] = numerical(
        (0.4, 240),
        "of the window, samples",
        "samples of a transform beyond its window; what a band-limited response has "
        "before the hit wraps into them",
        "with 64 samples a window at 2 kHz was wrong by 8 % at its end, with 240 by "
        "less than the floor",
    )
    slider_steps: tuple[int, int] = numerical(
        (1, 2),
        "steps/sample",
        "steps of the time integration per raw sample where all laws are friction: in "
        "fits, and in what is judged",
        "errors over the peak: 9e-5 and 2e-5 for slip of whole bolts, 2e-5 and 4e-6 "
        "for micro-slip",
    )
    law_steps: tuple[int, int] = numerical(
        (2, 8),
        "steps/sample",
        "the same with a stop or another law",
        "errors over the peak: 4e-4 and 2e-5 for a stop, 1.2e-3 and 2e-5 for a cubic "
        "spring that makes 80 % of the response",
    )
    slider_corrections: int = numerical(
        1,
        "-",
        "corrections of the forces of sliders in one step, from a guess that continues "
        "a straight line",
        "responses with 1 and 4 differ by less than 2e-5 of the peak",
    )
    law_corrections: int = numerical(
        6,
        "-",
        "the same where a law is not friction: a stop is several times stiffer than "
        "its bolt",
        "each reduces the error of a stop by 3 or more",
    )
    rest_steps: int = numerical(
        32,
        "samples",
        "samples between two questions whether a slider can slip again",
        "a question takes as long as a step",
    )
    hits_at_once: int = numerical(
        24,
        "hits",
        "hits that are integrated side by side",
        "one product moves all ports and modes of them; soft hits end sooner",
    )
    sliders: int = numerical(
        32,
        "sliders",
        "sharp sliders of friction at a port",
        "with 16, micro-slip of twice the slip displacement and share was 5,000 units "
        "of chi2 worse than the half of both, with 40 as good (seed 492402)",
    )
    outer_sliders: tuple[float, float] = numerical(
        (0.002, 0.015),
        "of the stiffness",
        "what the weakest and the strongest of them have",
        "soft hits move by a thirtieth of hard ones",
    )
    least_slip: float = numerical(
        0.003,
        "of the slip displacement",
        "least end of the cell of the weakest one",
        "a motion of 0.3 % slips little of a wide spread",
    )
    shapes: tuple[float, float] = numerical(
        (0.06, 30.0),
        "-",
        "least and largest shape of the strengths of sliders",
        "wider than a joint: Coulomb's friction, and sliders without a mean strength",
    )
    least_tail: float = numerical(
        1e-3, "-", "tail of the strengths below which they are those of Weibull"
    )
    micro_share: float = numerical(
        0.165,
        "of the stiffness",
        "stiffness that slips below half of the slip displacement above which friction "
        "is micro-slip, and below which it is macro-slip",
        "0.145 of a Richard-Abbott law with n = 3, which slips as a whole, 0.184 "
        "of Mindlin's contact, of which a ring slips at any motion",
    )
    law_slope_step: float = numerical(
        1e-5,
        "-",
        "difference step of a coordinate for slopes of the forces of laws",
        "above the rounding of a time integration, below the width of a slip",
    )
    least_law_value: float = numerical(
        1e-2,
        "-",
        "value of a coordinate of a law below which this step does not shrink with it",
        "as in other fits",
    )
    landing_step: float = numerical(
        1e-4, "sd", "difference step of a direction of a hit for them"
    )
    coarse_floor: float = numerical(
        0.01,
        "of the peak",
        "error of the model assumed while the base is fitted from its nominal values",
        "a prototype on 24 campaigns",
    )
    table_floor: float = numerical(
        0.001,
        "of the peak",
        "error of the modal table, as a share of the peak of a record and channel",
        "exact tables: above what is left of second-order aim, which is 0.03 %",
    )
    shape_floor: float = numerical(
        0.1,
        "of the sd",
        "floor as a multiple of the stated sd of the shapes of the modal table",
        "of the errors of a table those of first order are whitened",
    )
    free_rank: float = numerical(
        1e-8,
        "of the largest",
        "eigenvalue below which errors of residues depend on each other",
        "square root of rounding",
    )
    least_phase: float = numerical(
        0.01,
        "rad",
        "sd of the phase of a closed mode at the end of a record below which its "
        "frequency is no coordinate",
        "bodies that move as rigid ones on their feet: 1e-4",
    )
    close_mixing: float = numerical(
        0.05,
        "-",
        "sd of the share of a closed mode in another one above which their coupling "
        "is a coordinate where the modal table is uncertain",
        "what first order leaves is half of its square, 0.1 % of the residues",
    )
    least_pairs: int = numerical(
        2,
        "couplings",
        "fewest such coordinates, for the modes that mix most",
        "an effect brings other modes together than the nominal joint",
    )
    least_tuning: float = numerical(
        1e-9,
        "-",
        "least sd of a frequency or coupling of closed modes",
        "errors of a table reach no rigid motion: far below the width of any mode",
    )
    sought_turn: float = numerical(
        0.25,
        "cycles",
        "step of a closed frequency that is sought, at the end of the first window of "
        "the approach",
        "a descent follows half a cycle",
    )
    sought_reach: float = numerical(
        0.04,
        "-",
        "how far it is sought to either side",
        "tables that are off by 1 % have one of twenty modes off by 3",
    )
    sought_share: float = numerical(
        0.02,
        "of the cost",
        "drop of the cost there by which it is found elsewhere",
        "a mode of twenty carries 5 % of it",
    )
    sought_chi2: float = numerical(
        0.5,
        "of the limit",
        "chi2/dof of the base in one record of each condition from which frequencies "
        "are sought",
        "complete benches leave 0.1 to 0.4, the limit is 1.3",
    )
    open_frequency: float = numerical(
        1e-3,
        "-",
        "sd of the logarithm of a closed frequency from which it shows how large the "
        "errors of a table are",
        "modes of rigid bodies on their joints have a hundredth of it",
    )
    largest_size: float = numerical(
        2.5,
        "of the stated sd",
        "most by which deviations of the base raise the sd of all frequencies",
        "tables are off by 0.2 to 1 %, so a middle value is half of the largest",
    )
    rigid_share: float = numerical(
        1e-3, "of the band", "frequency below which a free mode is a rigid motion"
    )
    gain_sd: float = numerical(
        0.001,
        "-",
        "sd of the gain from hit to hit, which a tilt causes in second order",
        "1 - cos of two sd of a tilt of 1.5 degrees is 0.0014",
    )
    base_windows: tuple[float, float, float] = numerical(
        (0.002, 0.006, 0.02),
        "s",
        "windows in which the base is fitted from its nominal values",
        "a prototype on 24 campaigns",
    )
    search_reach: float = numerical(
        4.0,
        "sd",
        "largest deviation of a base parameter during the search",
        "a base that is free takes over the missing effect: deviations of 30 to 100 sd",
    )
    final_reach: float = numerical(
        12.0,
        "sd",
        "largest deviation of a base parameter in fits that are judged",
        "far above the limit of a verdict",
    )
    settling_rounds: int = numerical(
        6, "rounds", "most rounds of a fit with where the hits landed"
    )
    settled_share: float = numerical(
        0.01, "of the cost", "change of the cost below which these rounds end"
    )
    approach_share: float = numerical(
        0.5, "of the cost", "the same while the fit is far from the records"
    )
    near_chi2: float = numerical(
        300.0,
        "-",
        "chi2/dof above which hits are not expanded about where they landed",
        "1.7 % of the peak: hits at their points leave 0.5 to 1 % in whole records, "
        "and a stop at a bolt was left there, at 31.6, with a limit of 30",
    )
    explaining_chi2: float = numerical(
        10.0,
        "-",
        "chi2/dof of the base in one record of each condition, each met where it "
        "landed, above which it is not fitted to all records",
        "far above the limit of a verdict",
    )
    approach_windows: tuple[float, ...] = numerical(
        (0.02, 0.06),
        "s",
        "windows in which a fit approaches whole records, on one record of each "
        "condition",
        "a step in all whole records costs twenty times as much as one in 20 ms",
    )
    landing_windows: tuple[float, float] = numerical(
        (0.02, 0.06),
        "s",
        "windows in which it then meets all hits where they landed, one after the "
        "other, before it is fitted to all whole records",
        "hits beside their point slip other sliders, so the second is more exact",
    )
    approach_rounds: int = numerical(
        3, "rounds", "most rounds of such a fit with where the hits landed"
    )
    approach_iterations: int = numerical(
        12, "steps", "most steps of such a fit in one window"
    )
    fine_iterations: int = numerical(
        2,
        "steps",
        "steps of such a fit at the end, with the time integration that is judged",
        "the coarser one moves parameters by a part of their sd",
    )
    law_drop: float = numerical(
        3e-4,
        "chi2 per sample",
        "drop of the cost below which a fit with an integrated law ends before it is "
        "fitted with the time integration that is judged",
        "30 units of chi2 of twelve hits: the steps that follow, on all hits, separate "
        "rivals",
    )
    table_drop: float = numerical(
        0.3,
        "chi2",
        "drop of the cost below which a fit ends where the modal table is uncertain",
        "smaller steps and their slopes took a quarter of the time of a base (540009); "
        "chance alone reaches 14 to 17",
    )
    counted_band: float = numerical(
        1.3,
        "of the band",
        "elastic modes up to there count as those that a record shows",
        "hits hardly move modes above",
    )
    weighed_sd: float = numerical(
        0.01,
        "-",
        "sd of a base parameter below which friction may not move it far",
        "masses are known to 0.1 to 0.5 %, all else to 2 % and more",
    )
    whole_iterations: int = numerical(
        8, "steps", "most steps of a fit to whole records in one round"
    )
    short_iterations: int = numerical(
        5, "steps", "steps of a candidate in a short window", "a prototype"
    )
    longer_iterations: int = numerical(
        8, "steps", "steps of a candidate in a longer window"
    )
    starts_kept: int = numerical(
        2, "starts", "starts of a candidate that are fitted in a short window"
    )
    leaders: int = numerical(
        6,
        "effects",
        "effects that are fitted by the drop of their directed tests",
        "four of a prototype with ten effects; the catalogue has twenty-two",
    )
    far_ratio: float = numerical(
        1.5,
        "-",
        "ratio of starts of a strong effect",
        "fits in 6 ms reached springs, joints and clearances from two thirds to one "
        "and a half times their value (seeds 514528, 514710, 493221, 515014)",
    )
    strong_sites: int = numerical(
        2,
        "effects",
        "most effects that are fitted because they are nearer to the records when "
        "strong than the fit without them",
        "where a spring of 6 to 40 times a bolt holds a point, one at that point is "
        "nearest",
    )
    leading_sites: int = numerical(
        2, "sites", "most sites at which one effect is fitted for its directed tests"
    )
    first_effects: int = numerical(
        2,
        "effects",
        "best single effects to which a second one is added where none of them "
        "explains the hits",
        "a pair of effects of one size leads by one of them",
    )
    law_pairs: int = numerical(
        1,
        "pairs",
        "pairs with an integrated law that are fitted to whole records",
        "about sixty integrations of twelve hits and as many of all hits: half a "
        "minute to a minute each",
    )
    longer_fits: int = numerical(
        5, "fits", "fits carried to a longer window", "a prototype on 24 campaigns"
    )
    whole_fits: int = numerical(
        3, "fits", "most fits carried to whole records", "a prototype on 24 campaigns"
    )
    cost_above_best: float = numerical(
        200.0,
        "chi2",
        "cost above the best one, in one record of each condition, above which a fit "
        "is not carried to all records",
        "far above the difference of rivals, which grows with the records",
    )
    plain_amplitude: float = numerical(
        10.0,
        "sd",
        "size of the best effect below which the base is fitted again from its start",
        "effects that are named are 50 sd and more",
    )
    taken_share: float = numerical(
        0.2,
        "of chi2",
        "share of what an accepted base leaves above which one effect is sought",
        "effects take 0.04 and less of complete benches with exact tables (seeds "
        "481101 to 481104), a hidden one took 0.86 (492514)",
    )
    uncertain_drop: float = numerical(
        60.0,
        "chi2",
        "drop of the cost of an accepted base from which one effect is named where the "
        "modal table is uncertain, for sensors in units of chi2/dof",
        "chance reaches 17 in 0.5 % of cases, but errors of a table are not normal: "
        "masses of grams were named at 54 and 45 (seeds 504100 and 520000), where "
        "nothing was missing; right effects had 48 to 1048",
    )
    test_share: float = numerical(
        0.4,
        "of the largest",
        "drop of a directed test beside an accepted base, relative to the largest, "
        "from which the effect is fitted to all records",
        "rivals at the channel at fault had the same drop, others 0.1 and 0.3 of it "
        "(526001, 526002)",
    )
    difference_drop: float = numerical(
        3.0,
        "chi2",
        "drop by an effect, with errors of an uncertain modal table of any size, from "
        "which it is sought and named beside an accepted base: of what differs between "
        "hits of a point",
        "14 complete benches: at most 0.17; a preload exponent of damping had 16 "
        "(536000), a damping law 134 (551002)",
    )
    again_ratio: float = numerical(
        10.0,
        "of its cost",
        "cost of the base beside an effect above which it is not fitted again from "
        "there",
        "a base that explained the hits began near them; at 73 times its cost one "
        "crept for more than 300 s (571002)",
    )
    least_move: float = numerical(
        3e-3,
        "m",
        "distance of a sensor from where it should be below which its place is not "
        "named where the modal table is uncertain",
        "the base of an accelerometer is 10 mm wide; 1.4 +- 0.5 mm was named where "
        "nothing was missing (570009)",
    )
    least_turn: float = numerical(
        0.05,
        "rad",
        "angle of a sensor below which its direction is not named there",
        "sensors are aligned by eye",
    )
    least_gain: float = numerical(
        0.03,
        "-",
        "error of a gain below which it is not named there",
        "calibrations in the field are good to 2 or 3 %",
    )
    least_cross_axis: float = numerical(
        0.05,
        "-",
        "share of a cross axis below which it is not named there",
        "data sheets",
    )
    any_error: float = numerical(
        1e3,
        "of the sd",
        "factor by which errors of a modal table are of any size",
        "far above what a table can be off by, far below the inverse of rounding",
    )
    outstanding_channel: float = numerical(
        3.0,
        "-",
        "chi2 of a channel over that of a typical one above which, beyond the limit of "
        "chi2, the channel is unexplained where the modal table is uncertain",
        "28 complete benches whose base explains: two have a channel beyond 1.3, of at "
        "most 2.3 typical ones; faulty sensors beyond 1.3 had 3.1 to 40",
    )
    whole_cost_ratio: float = numerical(
        3.0,
        "of the best cost",
        "cost in a longer window above which a fit is not carried to whole records",
    )
    explained_cost_ratio: float = numerical(
        1.5,
        "of the best cost",
        "the same once another fit explains one record of each condition",
        "fits that no record separates differ by far less",
    )
    least_arm: float = numerical(
        0.01,
        "m",
        "extent of the bolts below which the joint cannot rock about an axis",
        "bolts in a row",
    )
    least_direction: float = numerical(
        1e-30,
        "-",
        "squared length below which a direction of a hit reaches no row",
        "far below the rounding of a direction",
    )
    least_variance: float = numerical(
        1e-4,
        "of the noise",
        "variance of a direction below which whitening leaves it",
        "it changes a residual by 5e-5 of its part along the direction",
    )
    lines_at_once: int = numerical(
        512,
        "lines",
        "lines at which closed rows and columns are computed at once",
        "all of 60 hits with 12 channels took 0.6 GB beside the slopes",
    )
    columns_at_once: int = numerical(
        8,
        "columns",
        "columns of slopes that are whitened at once for errors of a table",
        "all of them would be a second copy of the slopes",
    )
    surface_radius: float = numerical(
        0.065,
        "m",
        "distance of the nodes that show the surface around a sensor or hammer point",
        "sensors and marks are misplaced by up to 5 cm; a polynomial of degree 8 "
        "follows a wave of 14 cm to 1e-4 there",
    )
    surface_degree: int = numerical(
        8, "-", "highest degree of the polynomial of a mode shape on it"
    )
    surface_nodes: int = numerical(
        20,
        "nodes",
        "fewest nodes on it: with two for each term, the shape is cubic",
        "fewer show no more than the derivatives do",
    )
    surface_apart: float = numerical(
        5e-4,
        "m",
        "distance of a node from the surface, and least extent of it",
        "places are stated in whole millimetres",
    )
    surface_rank: float = numerical(
        1e-8,
        "of the largest",
        "singular value below which terms of the polynomial depend on each other",
        "square root of rounding",
    )
    mark_sd: float = numerical(
        2.5,
        "sd of the aim",
        "mean offset of the hits of a point from which its mark may be misplaced",
        "the mean of a dozen hits has a third of the sd of one",
    )
    mark_starts: tuple[float, ...] = numerical(
        (1.0, 1.5, 2.5),
        "of the mean offset",
        "distances of the mark from which fits start",
        "the prior of the aim draws the offsets found to the mark",
    )
    constraint_rank: float = numerical(
        1e-9,
        "of the largest",
        "singular value below which rigid directions at bolts depend on each other",
        "square root of rounding",
    )


STRUCTURE = StructureSettings()
