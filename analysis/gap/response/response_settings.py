# SPDX-License-Identifier: MIT
"""Settings of the predicted response: transforms, tables and time integration."""

from dataclasses import dataclass

from jointbench.analysis.gap.model.setting import numerical


@dataclass(frozen=True, slots=True)
class ResponseSettings:
    """Numbers of the algorithms; unit, purpose and basis are with each field."""

    step_effort: float = numerical(
        2.5,
        "samples",
        "cost of one step of the time integration, in samples of a linear response",
        "timed on a core of 2.3 GHz",
    )
    damping_exponent: float = numerical(
        16.0,
        "-",
        "damping of the transform times its length: the response that wraps "
        "around is reduced by exp(-16)",
        "a test with a transform of six record lengths",
    )
    transform_length: float = numerical(
        1.5,
        "of the record",
        "length of a transform",
        "nine campaigns: within 0.5 units of chi2 of six lengths, in two thirds of "
        "the time of length 2",
    )
    pass_band: float = numerical(
        0.42,
        "of the sample rate",
        "end of the pass band of an anti-alias filter, if unknown",
        "the filter assumed by the simulators; the end is estimated where it matters",
    )
    faded_band: float = numerical(
        0.01,
        "of the sample rate",
        "last part of the band, in which the force is tapered to zero",
        "nine campaigns; without it single 94001 (a low-pass) ended unknown",
    )
    table_points: int = numerical(
        8193,
        "points",
        "points of the table of a force curve",
        "tests against the curve itself",
    )
    table_grading: float = numerical(
        16.0,
        "-",
        "arc sinh of the largest motion over the finest spacing of a table",
        "tests against the curve itself",
    )
    table_motion: float = numerical(
        0.01,
        "m",
        "largest motion across a link that a table holds; the value is constant beyond",
        "above any motion of a machine joint under a hammer",
    )
    table_speed: float = numerical(
        100.0,
        "m/s",
        "largest speed across a link that a table holds; the value is constant beyond",
        "above any speed of a machine joint under a hammer",
    )
    lanes: int = numerical(
        8,
        "records",
        "records that are integrated side by side",
        "timed: 13 ns per record and step; 24 ns without",
    )
    real_pole_share: float = numerical(
        1e-9,
        "of the modulus",
        "imaginary part below which a pole is real",
        "rounding of double precision",
    )
    extrapolated_steps: int = numerical(
        4,
        "steps/sample",
        "steps from which the time integration is extrapolated to a step of zero",
        "convergence tests of the second method (tests/judges)",
    )
    friction_sweeps: int = numerical(
        30,
        "sweeps",
        "most sweeps over the ports in which dry friction is balanced within a step",
        "two bodies of a quarter of each other's mass need 8",
    )
    friction_tolerance: float = numerical(
        1e-6,
        "of the friction force",
        "change in a sweep below which dry friction is balanced",
        "ten times the tolerance of the solution for one port",
    )
    friction_switch: float = numerical(
        1e-4,
        "of the friction force",
        "change of dry friction in a step above which the step is followed in pieces",
        "30 pairs of joints drawn at random: with 0.01 a change at the edge of a "
        "switch left 1.2e-4 of the response; 7e-6 with 1e-4, in the same time",
    )
    friction_rigid: float = numerical(
        1e-3,
        "of the width",
        "change of the speed by dry friction in a step below which it is not stiff",
        "the force then follows the speed without being solved for",
    )
    friction_pieces: int = numerical(
        200,
        "pieces",
        "most pieces of such a step",
        "a speed that changes its sign needs 40",
    )
    friction_far: float = numerical(
        5.0,
        "widths",
        "speed above which dry friction is constant",
        "tanh(5) is 1 to 1e-4",
    )
    friction_layer: float = numerical(
        0.2,
        "of the width",
        "change of the speed in a piece near a speed of zero",
        "the same pairs: at most 3.5e-5 of the response with 0.3, 2.6e-5 with 0.1",
    )
    loop_points: int = numerical(
        200,
        "points",
        "points of a cycle of a force-deflection loop",
        "first harmonics of all laws within 0.1 % of those with 800 points",
    )
    still_speed: float = numerical(
        1e-5,
        "m/s",
        "speed below which a power law of damping is linear",
        "a thousandth of the speed at joints under soft hits; a power below 1 would "
        "have an infinite slope",
    )
    slider_table_points: int = numerical(
        4096,
        "points",
        "points of the table of a slider",
        "tests against the closed form",
    )
    slider_reach: float = numerical(
        12.0,
        "slips",
        "largest displacement of a slider that does not saturate at its slip",
        "more than twice that of the published Bouc-Wen benchmark",
    )
    long_table_points: int = numerical(
        32768,
        "points",
        "points of the table of such a slider",
        "each step looks up twice: with 4096 points the error grew with the number of "
        "steps",
    )
    slider_curve_points: tuple[int, int] = numerical(
        (3000, 60000),
        "points",
        "points at which the curve of a slider is integrated, up to a displacement of "
        "its slip and beyond it",
        "closed form, and the second method: 3000 points left 0.4 % of a response with "
        "a negative loading coefficient, 60,000 leave 3e-5",
    )
    slider_elastic_error: float = numerical(
        1e-7,
        "-",
        "departure of a slider from elasticity that is neglected",
        "tests against the closed form",
    )


RESPONSE = ResponseSettings()
