# SPDX-License-Identifier: MIT
"""Write campaigns as HDF5 of schema two-body-campaign/1, with the truth as JSON."""

import json
from dataclasses import asdict
from pathlib import Path

import h5py
import numpy as np

from jointbench.acquisition.basics.errors import FormatError
from jointbench.simulators.campaigns.campaign_records import SimulatedCampaign
from jointbench.simulators.hidden.campaign_design import NOMINAL_SIGMA
from jointbench.simulators.hidden.campaign_sampling import SAMPLE_RATE

SCHEMA = "two-body-campaign/1"


def truth_path(path: Path) -> Path:
    """Return the path of the truth about the campaign in `path`."""
    return path.with_name(f"{path.stem}.truth.json")


def write_campaign(campaign: SimulatedCampaign, path: Path) -> None:
    """Write a campaign, and its truth next to it.

    Args:
        campaign: the campaign.
        path: of the HDF5 file; the truth goes to `truth_path(path)`.
    """
    design = campaign.design
    with h5py.File(path, "w") as file:
        file.attrs["schema"] = SCHEMA
        file.attrs["fs_hz"] = SAMPLE_RATE
        file.attrs["nominal"] = json.dumps(dict(design.nominal))
        file.attrs["nominal_rel_sigma"] = json.dumps(dict(NOMINAL_SIGMA))
        file.attrs["preload_ref_N"] = design.preload_reference
        records = file.create_group("records")
        for i, condition in enumerate(design.conditions):
            record = records.create_group(f"r{i:02d}")
            record["force"] = campaign.force[i].astype(np.float32)
            record["accel"] = campaign.acceleration[i].astype(np.float32)
            record.attrs["level_N"] = condition.level
            record.attrs["hit_dof"] = condition.hit_dof
            record.attrs["preload_N"] = condition.preload
            record.attrs["order"] = condition.order
    truth_path(path).write_text(json.dumps(campaign_truth(campaign), indent=1))


def campaign_truth(campaign: SimulatedCampaign) -> dict[str, object]:
    """Return the truth about a campaign as JSON types.

    Args:
        campaign: the campaign.

    Returns:
        Keys `truth` (names to find), `effects` (parameters by true name), `sites`,
        `margins` (rho, correlation, rival, margin by name, where known), `noise_rms`,
        `physical`, `hit_scatter` and `seed`.
    """
    names = [effect.name for effect in campaign.effects]
    return {
        "truth": list(campaign.truth),
        "effects": {e.name: dict(e.parameters) for e in campaign.effects},
        "sites": {e.name: e.site for e in campaign.effects},
        "margins": {
            name: asdict(margin)
            for name, margin in zip(names, campaign.margins, strict=False)
        },
        "noise_rms": campaign.design.noise,
        "physical": dict(campaign.design.physical),
        "hit_scatter": campaign.design.hit_scatter,
        "seed": campaign.design.seed,
    }


def read_truth(path: Path) -> dict[str, object]:
    """Read the truth about a campaign.

    Args:
        path: of the campaign's HDF5 file.

    Returns:
        The content of `campaign_truth`.

    Raises:
        FormatError: there is none, or it is not JSON.
    """
    where = truth_path(path)
    try:
        truth = json.loads(where.read_text())
    except (OSError, ValueError) as error:
        raise FormatError(
            f"{where} holds no truth about {path.name}; write_campaign makes one"
        ) from error
    return dict(truth)
