# SPDX-License-Identifier: MIT
"""Read the chain of a joint: its surfaces, its sessions, and the model of the bench."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.acquisition.records.recordings import Recording
from jointbench.acquisition.session_file.store import read_session
from jointbench.analysis.gap.chain.chain_settings import CHAIN
from jointbench.analysis.gap.chain.joint_over_preload import BoltedStates
from jointbench.analysis.gap.contact_bench.joint_states import ContactQuantity
from jointbench.analysis.gap.intake.session_campaign import session_campaign
from jointbench.analysis.gap.model.campaign import Campaign
from jointbench.analysis.gap.model.nominal import NominalParameters
from jointbench.station.gap.session_hits import judged_recordings, with_preloads
from jointbench.station.joint_states.joint_state_files import joint_facts
from jointbench.station.joints.structure_model import StructureModel
from jointbench.station.schemas.bench_model import BenchModel
from jointbench.station.schemas.bolted_joint_table import BoltedLinkTable
from jointbench.station.schemas.gap_model import nominal_parameters

_WAY_OUT = (
    "add a table [bolted_joint] with link, bolts, diameter, area, modulus, poisson and "
    "hardness (docs/gap-chain.md)"
)
QUANTITY = {
    "normal": ContactQuantity.NORMAL,
    "tangential": ContactQuantity.TANGENTIAL,
}


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredStates:
    """Hits of the states of a joint in the order in which they were measured.

    Attributes:
        campaigns: the hits of each state.
        states: preloads and facts.
        link: index of the joint among the links of the model.
        remarks: what was left out, and why, a line each.
    """

    campaigns: tuple[Campaign, ...]
    states: BoltedStates
    link: int
    remarks: tuple[str, ...]


def bolted_joint(model: BenchModel | StructureModel, path: Path) -> BoltedLinkTable:
    """Return the bolted joint of a model.

    Args:
        model: of the bench.
        path: of its file, for the message.

    Raises:
        UsageError: it has none.
    """
    if model.bolted_joint is None:
        raise UsageError(
            f"'{path}' names no link as the joint of these surfaces; {_WAY_OUT}"
        )
    return model.bolted_joint


def read_states(
    paths: Sequence[Path],
    model: BenchModel,
    table: BoltedLinkTable,
    preload: float | None,
) -> MeasuredStates:
    """Read the states of a joint from sessions; each session is one assembly.

    Args:
        paths: of the sessions.
        model: of the bench.
        table: its bolted joint.
        preload: where a session states none [N], or None.

    Raises:
        BadData: no state has enough hits, or a recording has no preload.
    """
    nominal = nominal_parameters(model)
    sessions = sorted((read_session(path) for path in paths), key=lambda s: s.created)
    remarks: list[str] = []
    campaigns: list[Campaign] = []
    assembly: list[int] = []
    for number, session in enumerate(sessions):
        judged = judged_recordings(with_preloads(session, preload), remarks)
        for group in _runs(judged):
            campaign = _campaign(paths[0].stem, group, nominal, remarks)
            if campaign is not None:
                campaigns.append(campaign)
                assembly.append(number)
    if not campaigns:
        raise BadData(
            f"no preload in {', '.join(p.name for p in paths)} has "
            f"{CHAIN.least_hits} accepted hits; see `jointbench inspect`"
        )
    links = list(model.links)
    states = BoltedStates(
        ", ".join(path.stem for path in paths),
        joint_facts(table, table),
        np.array([float(c.preload[0]) for c in campaigns]),
        np.array(assembly, dtype=np.int64),
        QUANTITY[table.direction],
    )
    return MeasuredStates(
        tuple(campaigns), states, links.index(table.link), tuple(remarks)
    )


def _runs(recordings: Sequence[Recording]) -> list[list[Recording]]:
    """Return consecutive recordings of one preload together."""
    found: list[list[Recording]] = []
    for one in recordings:
        if found and found[-1][-1].preload == one.preload:
            found[-1].append(one)
        else:
            found.append([one])
    return found


def _campaign(
    name: str,
    recordings: Sequence[Recording],
    nominal: NominalParameters,
    remarks: list[str],
) -> Campaign | None:
    """Return the hits of one state; None where they are too few."""
    own = replace(nominal, preload_reference=recordings[0].preload)
    campaign, left_out = session_campaign(name, recordings, own)
    remarks += left_out
    if len(campaign.hit) < CHAIN.least_hits:
        remarks.append(
            f"{len(campaign.hit)} hit at {campaign.preload[0]:.4g} N is too few for a "
            "stiffness; left out"
        )
        return None
    return campaign
