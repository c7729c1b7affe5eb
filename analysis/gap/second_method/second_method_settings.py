# SPDX-License-Identifier: MIT
"""Numbers of the second method, which predicts every winner once more."""

from dataclasses import dataclass

from jointbench.analysis.gap.model.setting import numerical


@dataclass(frozen=True, slots=True)
class SecondMethodSettings:
    """Steps and tolerances of the second method."""

    state_tolerance: float = numerical(
        1e-9,
        "of the state",
        "local error of the integration in tests of the first method",
        "chosen by judgement; no campaign set it",
    )
    samples_beyond: int = numerical(
        64,
        "samples",
        "samples integrated after the record, for leads and for the filter to end in",
        "chosen by judgement; no campaign set it",
    )
    iwan_sliders: int = numerical(
        14,
        "sliders",
        "sliders of an Iwan law: equal steps of slip displacement",
        "the bank of the catalogue",
    )
    force_points: int = numerical(
        16,
        "points/sample",
        "points between which a cubic spline carries the force",
        "2e-6 of a line at 0.4 of the sample rate, 1e-8 of a hit",
    )
    least_force: float = numerical(
        1e-5,
        "of the largest force",
        "force below which no hit acts any more",
        "what rings on in the band-limited force of a hit is less",
    )
    free_steps: float = numerical(
        2.0,
        "samples",
        "longest step of the integration after the hits; 1 sample while a force acts",
        "computing time: half; with 4 samples the methods differ by 4e-7 of the peak, "
        "with 2 by 3e-8",
    )


SECOND_METHOD = SecondMethodSettings()
