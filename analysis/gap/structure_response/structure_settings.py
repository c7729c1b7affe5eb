# SPDX-License-Identifier: MIT
"""Settings of the responses of bolted bodies and of the bench of their hits."""

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
    short_padding: int = numerical(
        128,
        "samples",
        "samples of a transform beyond a window that is shorter, for filtered records; "
        "up to those of `padding`, as many as the window has",
        "errors over the peak of 20 benches: in 6 ms 1.4e-4 (median; worst 1.1e-3), in "
        "20 ms 2e-4 (7e-4), where 240 had 3e-5 (2e-4) and 9e-5 (7e-4); in 60 ms they "
        "are 5e-4 (3e-3) with both",
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
    rigid_share: float = numerical(
        1e-3, "of the band", "frequency below which a free mode is a rigid motion"
    )
    gain_sd: float = numerical(
        0.001,
        "-",
        "sd of the gain from hit to hit, which a tilt causes in second order",
        "1 - cos of two sd of a tilt of 1.5 degrees is 0.0014",
    )
    search_reach: float = numerical(
        4.0,
        "sd",
        "largest deviation of a base parameter during the search",
        "a base that is free takes over the missing effect: deviations of 30 to 100 sd",
    )
    counted_band: float = numerical(
        1.3,
        "of the band",
        "elastic modes up to there count as those that a record shows",
        "hits hardly move modes above",
    )
    far_ratio: float = numerical(
        1.5,
        "-",
        "ratio of starts of a strong effect",
        "fits in 6 ms reached springs, joints and clearances from two thirds to one "
        "and a half times their value (seeds 514528, 514710, 493221, 515014)",
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
    sums_at_once: int = numerical(
        2_000_000,
        "-",
        "sums over modes that are computed at once, for as many lines as they are of",
        "640 lines of 12 channels and 41 hits, 32 MB; a flexibility of 200 modes has "
        "70,000 sums at each line",
    )
    filtered_at_once: int = numerical(
        64,
        "samples",
        "kept samples of one product of matrices that filters forces of laws",
        "three times as fast as a sum over the taps, with as many zeros as taps",
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
