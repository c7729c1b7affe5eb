# SPDX-License-Identifier: MIT
"""Settings of the records: which samples count, and when a gap is significant."""

from dataclasses import dataclass

from jointbench.analysis.gap.model.setting import numerical


@dataclass(frozen=True, slots=True)
class CampaignSettings:
    """Numbers of the algorithms; unit, purpose and basis are with each field."""

    tail_samples: int = numerical(
        64,
        "samples",
        "last samples of a record that are not compared: the anti-alias filter "
        "has no data after them",
    )
    longest_stated_delay: float = numerical(
        1e-3,
        "s",
        "stated scatter of a delay from which it is refused",
        "a hit that is late by a millisecond is another hit",
    )
    seen_gap: float = numerical(
        1.0,
        "-",
        "held-out gap below which its reduction is not evaluated",
    )
    unpredicted_share: float = numerical(
        0.5,
        "-",
        "share of the held-out gap that a named effect may leave before the "
        "reason says that other conditions do not predict it",
    )


CAMPAIGN = CampaignSettings()
