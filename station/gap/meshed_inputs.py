# SPDX-License-Identifier: MIT
"""Hits on bolted bodies, examined by `gap` with a model of meshed bodies."""

from pathlib import Path

from jointbench.analysis.gap.structure_search.structure_diagnosis import (
    diagnose_structure,
)
from jointbench.station.bolted.bolted_campaign import (
    BoltedCampaign,
    bolted_campaign,
    bolted_hits,
)
from jointbench.station.bolted.free_bodies import gap_table
from jointbench.station.files.toml_file import read_toml
from jointbench.station.gap.gap_request import Examined, GapRequest, Progress
from jointbench.station.gap.meshed_plan import plan_of
from jointbench.station.gap.session_hits import hits_of_sessions
from jointbench.station.gap.structure_files import remarks_on
from jointbench.station.joints.structure_model import StructureModel


def sessions_of(model: Path) -> tuple[str, ...]:
    """Return the sessions that a model of meshed bodies names.

    Args:
        model: file with [joints] and [gap].

    Raises:
        UsageError: it has no table [gap].
        BadData: it cannot be used as it is.
    """
    return gap_table(read_toml(model, StructureModel)).sessions


def examine_meshed_sessions(
    paths: list[Path], model: Path, wanted: GapRequest, progress: Progress
) -> Examined:
    """Examine the hits of sessions.

    Args:
        paths: of the sessions.
        model: file with [joints] and [gap].
        wanted: options.
        progress: receives one line for each step.

    Raises:
        UsageError: the model lacks a table.
        BadData: model or hits cannot be used as they are.
    """
    hits = hits_of_sessions(paths, wanted.preload)
    progress("reducing the bodies")
    ready = bolted_campaign(hits.title, hits.recordings, model)
    return _diagnosed(hits.title, ready, wanted, progress, hits.remarks, hits.simulated)


def examine_meshed_campaign(
    path: Path, model: Path, wanted: GapRequest, progress: Progress
) -> Examined:
    """Examine the hits of a campaign file; its modal tables are not used.

    Args:
        path: file of schema ``campaign/1``.
        model: file with [joints] and [gap].
        wanted: options.
        progress: receives one line for each step.

    Raises:
        UsageError: the model lacks a table.
        BadData: model or hits cannot be used as they are.
    """
    progress("reducing the bodies")
    return _diagnosed(path.stem, bolted_hits(path, model), wanted, progress)


def _diagnosed(
    title: str,
    ready: BoltedCampaign,
    wanted: GapRequest,
    progress: Progress,
    remarks: tuple[str, ...] = (),
    simulated: bool = False,
) -> Examined:
    """Diagnose hits, and place them on the structure."""
    done = diagnose_structure(ready.campaign, without=wanted.without, progress=progress)
    return Examined(
        title,
        done.found,
        remarks=(*remarks, *remarks_on(done)),
        plan=plan_of(ready.table, ready.model),
        simulated=simulated,
    )
