# SPDX-License-Identifier: MIT
"""Scatter of the hits as the nominal parameters of a campaign state it."""

import math
from dataclasses import dataclass, fields

from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.gap.model.campaign_settings import CAMPAIGN

LONGEST_DELAY = CAMPAIGN.longest_stated_delay


@dataclass(frozen=True, slots=True)
class StatedScatter:
    """Expected sd from hit to hit by direction; None where nothing is stated.

    Attributes:
        force_gain: of the acting force over the measured one [-].
        joint_stiffness: of each joint [-].
        channel_gain: of each channel, as aim and tilt of a hammer change it [-].
        force_delay: of the force against the responses [s].
        channel_delay: of each channel [s].
    """

    force_gain: float | None = None
    joint_stiffness: float | None = None
    channel_gain: float | None = None
    force_delay: float | None = None
    channel_delay: float | None = None

    def __post_init__(self) -> None:
        """Refuse values that no hit can have."""
        for field in fields(self):
            value = getattr(self, field.name)
            most = LONGEST_DELAY if field.name.endswith("_delay") else 1.0
            if value is not None and not (math.isfinite(value) and 0.0 < value < most):
                raise BadData(
                    f"the scatter {field.name!r} is {value!r}, it must be above 0 and "
                    f"below {most:g}; state the sd from hit to hit, or leave it out"
                )


NOTHING_STATED = StatedScatter()
SCATTER_KEYS = tuple(field.name for field in fields(StatedScatter))
