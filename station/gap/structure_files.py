# SPDX-License-Identifier: MIT
"""Hits on bolted bodies with their nominal parameters, examined."""

from collections.abc import Callable, Sequence
from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.file_access.quoting import visible
from jointbench.acquisition.records.recordings import Recording
from jointbench.analysis.gap.intake.read_hit_campaign import read_hit_campaign
from jointbench.analysis.gap.model.diagnosis_record import Diagnosis
from jointbench.analysis.gap.structure_search.structure_diagnosis import (
    StructureDiagnosis,
    diagnose_structure,
)
from jointbench.station.bolted.bolted_campaign import (
    BoltedCampaign,
    bolted_campaign,
    bolted_hits,
)
from jointbench.station.gap.meshed_plan import plan_of
from jointbench.station.gap.structure_plan import StructurePlan
from jointbench.station.schemas.nominal_bench_file import read_nominal

BESIDE = "sheet.json"
"""Nominal parameters beside a campaign: NAME.sheet.json, or this for the folder."""


def examine_structure(
    path: Path,
    nominal: Path,
    *,
    without: frozenset[str],
    progress: Callable[[str], None],
) -> tuple[Diagnosis, tuple[str, ...]]:
    """Read a campaign with its nominal parameters, and diagnose it.

    Args:
        path: file of schema ``campaign/1``.
        nominal: nominal parameters (JSON).
        without: names of effects to leave out of the catalogue.
        progress: receives one line for each step.

    Returns:
        Verdict and evidence, and what a reader should know of the hits.

    Raises:
        UsageError: `without` holds a name that no entry has.
        BadData: a file cannot be used as it is.
    """
    campaign = read_hit_campaign(path, *read_nominal(nominal))
    done = diagnose_structure(campaign, without=without, progress=progress)
    return done.found, _remarks(done)


def examine_recordings(
    title: str,
    recordings: Sequence[Recording],
    model: Path,
    *,
    without: frozenset[str],
    progress: Callable[[str], None],
) -> tuple[Diagnosis, tuple[str, ...], StructurePlan]:
    """Diagnose the hits of sessions with a model of meshed bodies.

    Args:
        title: of the campaign.
        recordings: with judged hits.
        model: file with [joints] and [gap].
        without: names of effects to leave out of the catalogue.
        progress: receives one line for each step.

    Returns:
        Verdict and evidence, what a reader should know of the hits, and the places of
        the structure.

    Raises:
        UsageError: the model lacks a table, or `without` holds an unknown name.
        BadData: model or hits cannot be used as they are.
    """
    progress("reducing the bodies")
    return _diagnosed(bolted_campaign(title, recordings, model), without, progress)


def examine_meshed(
    path: Path,
    model: Path,
    *,
    without: frozenset[str],
    progress: Callable[[str], None],
) -> tuple[Diagnosis, tuple[str, ...], StructurePlan]:
    """Diagnose the hits of a campaign file with a model of meshed bodies.

    Args:
        path: file of schema ``campaign/1``; its modal tables are not used.
        model: file with [joints] and [gap].
        without: names of effects to leave out of the catalogue.
        progress: receives one line for each step.

    Returns:
        As `examine_recordings`.

    Raises:
        UsageError: the model lacks a table, or `without` holds an unknown name.
        BadData: model or hits cannot be used as they are.
    """
    progress("reducing the bodies")
    return _diagnosed(bolted_hits(path, model), without, progress)


def _diagnosed(
    ready: BoltedCampaign, without: frozenset[str], progress: Callable[[str], None]
) -> tuple[Diagnosis, tuple[str, ...], StructurePlan]:
    done = diagnose_structure(ready.campaign, without=without, progress=progress)
    return done.found, _remarks(done), plan_of(ready.table, ready.model)


def _remarks(done: StructureDiagnosis) -> tuple[str, ...]:
    """Return what a reader should know of the hits, a line each."""
    return (
        f"hits landed {done.landing_mm:.2g} mm (rms) beside their points, tilted by "
        f"{done.tilt_degrees:.2g} degrees (rms)",
        *(f"left out {visible(hit.name)}: {hit.reason}" for hit in done.rejected),
    )


def nominal_beside(path: Path) -> Path:
    """Return the nominal parameters that stand beside a campaign.

    They are ``NAME.sheet.json`` or ``sheet.json`` beside the campaign ``NAME.h5``.

    Args:
        path: of the campaign.

    Raises:
        UsageError: there is no such file.
    """
    places = (path.with_suffix(f".{BESIDE}"), path.with_name(BESIDE))
    for place in places:
        if place.is_file():
            return place
    raise UsageError(
        f"'{path}' holds hits on bolted bodies but no nominal parameters, and there is "
        f"no '{places[0].name}' or '{BESIDE}' beside it; add --model SHEET.json"
    )
