# SPDX-License-Identifier: MIT
"""Settings of the next experiment: bench time, reach of candidates, draws."""

from dataclasses import dataclass

from jointbench.analysis.gap.model.setting import NO_CAMPAIGN, decision, numerical


@dataclass(frozen=True, slots=True)
class NextExperimentSettings:
    """Numbers of the algorithms; unit, purpose and basis are with each field."""

    assembly_minutes: float = decision(
        15.0,
        "min",
        "bench time to take a joint apart, clean it and put it together",
        "four bolts and two plates by one operator",
    )
    state_minutes: float = decision(
        4.0,
        "min",
        "bench time of one torque: tighten, hit five points three times",
        "sessions of `jointbench measure` on simulated plates",
    )
    washer_minutes: float = decision(
        20.0, "min", "bench time to put load washers under all bolts", NO_CAMPAIGN
    )
    setup_minutes: float = decision(
        5.0, "min", "bench time to put a surface under the instrument", NO_CAMPAIGN
    )
    trace_minutes: float = decision(
        2.0, "min", "bench time of one trace of the length of the first", NO_CAMPAIGN
    )
    higher: tuple[float, ...] = decision(
        (2.0, 4.0),
        "-",
        "highest torque of a candidate over the highest so far; whether the bolts "
        "allow it is for the operator to decide",
        NO_CAMPAIGN,
    )
    lower: tuple[float, ...] = decision(
        (0.5, 0.25),
        "-",
        "lowest torque of a candidate over the lowest so far",
        NO_CAMPAIGN,
    )
    decides: float = decision(
        0.8,
        "-",
        "expected share of decisions from which gain per hour ranks candidates; those "
        "below it follow by that share",
        "an experiment that leaves a verdict open costs another assembly",
    )
    assemblies: int = numerical(3, "assemblies", "assemblies of the longest candidates")
    washer_sd: float = numerical(0.02, "-", "relative sd of a washer's preload")
    waits: tuple[float, ...] = numerical(
        (60.0, 600.0, 6000.0), "s", "waiting times of a candidate that waits"
    )
    levels: int = numerical(5, "torques", "torques of a candidate series")
    new_sd: float = numerical(
        0.02, "-", "relative sd of new values whose quantity has no measured one"
    )
    draws: int = numerical(
        300, "draws", "simulated outcomes of a candidate; P(decided) within 3 %"
    )
    most_explanations: int = numerical(
        4, "explanations", "explanations that a candidate is to separate"
    )
    discrepancy_cells: int = numerical(
        2, "terms", "offset and slope over ln P of a free discrepancy"
    )


NEXT = NextExperimentSettings()
