# SPDX-License-Identifier: MIT
"""Campaigns, sessions and long records of lumped benches, examined by `gap`."""

from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.gap.diagnosis.diagnose import diagnose
from jointbench.analysis.gap.diagnosis.single_record import diagnose_record
from jointbench.analysis.gap.intake.read_campaign import read_campaign
from jointbench.station.gap.gap_request import (
    Examined,
    GapRequest,
    Progress,
    bench_of,
    refuse_curves,
)
from jointbench.station.gap.measured_curves import (
    curves_of_campaign,
    curves_of_recordings,
)
from jointbench.station.gap.record_campaign import read_record
from jointbench.station.gap.session_hits import ANY_LEVEL, hits_of_sessions
from jointbench.station.pipeline.joint_stages import gap_of
from jointbench.station.schemas.gap_model import nominal_parameters


def examine_campaign(
    paths: list[Path], wanted: GapRequest, progress: Progress
) -> Examined:
    """Examine a campaign file, which brings its own model.

    Raises:
        UsageError: other files or options are given with it.
    """
    if len(paths) > 1 or wanted.model is not None or wanted.preload is not None:
        raise UsageError(
            f"'{paths[0]}' is no session: a campaign file is given alone, it brings "
            "its own model and preloads"
        )
    campaign = read_campaign(paths[0])
    curves = (
        curves_of_campaign(campaign, ANY_LEVEL, progress) if wanted.curves else None
    )
    found = diagnose(
        campaign,
        without=wanted.without,
        entries=wanted.entries,
        curves=curves,
        progress=progress,
    )
    return Examined(paths[0].stem, found)


def examine_record(
    paths: list[Path], wanted: GapRequest, progress: Progress
) -> Examined:
    """Examine a long record (MAT file) with the model of its bench.

    Raises:
        UsageError: a model is missing, or an option does not apply to records.
    """
    if len(paths) > 1:
        raise UsageError("a record is examined alone; give one MAT file")
    bench = bench_of(paths[0], wanted)
    refuse_curves(wanted)
    if wanted.preload is not None:
        raise UsageError("--preload belongs to sessions; a record has none")
    record = read_record(paths[0], bench)
    found, scores = diagnose_record(
        record.record,
        record.training,
        record.scored,
        record.nominal,
        without=wanted.without,
        entries=wanted.entries,
        progress=progress,
    )
    return Examined(
        paths[0].stem,
        record.in_stand_ins(found),
        record.in_unit(scores),
        record.unit,
        record.remarks,
    )


def examine_sessions(
    paths: list[Path], wanted: GapRequest, progress: Progress
) -> Examined:
    """Examine the hits of sessions with the model of their bench.

    Raises:
        UsageError: a model is missing.
        BadData: no session holds a hit.
    """
    nominal = nominal_parameters(bench_of(paths[0], wanted))
    hits = hits_of_sessions(paths, wanted.preload)
    curves = None
    if wanted.curves:
        curves = curves_of_recordings(
            hits.recordings, nominal.preload_reference, ANY_LEVEL, progress
        )
    found, left_out = gap_of(
        hits.title,
        hits.recordings,
        nominal,
        without=wanted.without,
        entries=wanted.entries,
        curves=curves,
        progress=progress,
    )
    return Examined(
        hits.title,
        found,
        remarks=(*hits.remarks, *left_out),
        simulated=hits.simulated,
    )
