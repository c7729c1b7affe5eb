# SPDX-License-Identifier: MIT
"""Hits on bolted bodies with their nominal parameters, examined."""

from collections.abc import Callable
from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.file_access.quoting import visible
from jointbench.analysis.gap.intake.read_hit_campaign import read_hit_campaign
from jointbench.analysis.gap.model.diagnosis_record import Diagnosis
from jointbench.analysis.gap.structure_search.structure_diagnosis import (
    StructureDiagnosis,
    diagnose_structure,
)
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
    return done.found, remarks_on(done)


def remarks_on(done: StructureDiagnosis) -> tuple[str, ...]:
    """Return what a reader should know of the hits, a line each.

    Args:
        done: diagnosis of the hits.
    """
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
