# SPDX-License-Identifier: MIT
"""Files of simulated campaigns with short records, so that tests stay fast."""

from pathlib import Path

import h5py

from jointbench.simulators.campaigns.campaign_records import SimulatedCampaign
from jointbench.simulators.campaigns.write_campaign import write_campaign

SHORT = 768
"""Samples of a record; the simulator writes 2,048, which take twice the time."""


def write_short(campaign: SimulatedCampaign, path: Path, samples: int = SHORT) -> None:
    """Write a campaign with the first samples of its records."""
    write_campaign(campaign, path)
    shorten(path, samples)


def shorten(path: Path, samples: int = SHORT) -> None:
    """Keep the first samples of the records of a campaign file."""
    with h5py.File(path, "r+") as file:
        for record in file["records"].values():
            for name in ("force", "accel"):
                first = record[name][..., :samples]
                del record[name]
                record[name] = first
