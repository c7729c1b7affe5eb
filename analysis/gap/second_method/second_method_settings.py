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


SECOND_METHOD = SecondMethodSettings()
