# SPDX-License-Identifier: MIT
"""Record everything a source delivers; hits are judged later, none is thrown away."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.errors import InstrumentError
from jointbench.acquisition.records.provenance import step
from jointbench.acquisition.records.recordings import Recording
from jointbench.acquisition.records.session import JointSetup, Session, new_session
from jointbench.acquisition.records.source import Source
from jointbench.signal.hits.find_hits import HitCriteria
from jointbench.station.sources.open_source import RunSequence
from jointbench.station.sources.record_live import with_hits


def record(
    source: Source,
    *,
    name: str = "stream",
    on_block: Callable[[float], object] | None = None,
) -> Recording:
    """Record a source until it ends.

    Args:
        source: an opened source.
        name: of the recording.
        on_block: called after every block with the time recorded so far [s].

    Returns:
        One recording of the whole stream, hits not yet searched.

    Raises:
        InstrumentError: the source delivered nothing.
    """
    blocks = []
    count = 0
    for block in source.blocks():
        blocks.append(block)
        count += block.shape[1]
        if on_block is not None:
            on_block(count / source.sample_rate)
    if not blocks:
        raise InstrumentError(f"source {source.name!r} delivered no sample; check it")
    return Recording(
        name=name,
        samples=np.concatenate(blocks, axis=1),
        sample_rate=source.sample_rate,
        channels=source.channels,
        provenance=(step("record", source=source.name, samples=count),),
    )


def record_runs(
    sequence: RunSequence, *, criteria: HitCriteria | None = None
) -> Session:
    """Record all runs into a session, each with its preload.

    Args:
        sequence: an opened source.
        criteria: how hits are found and judged; None for the defaults.

    Returns:
        One recording per run, its hits judged; a run without hits has none. It
        is in memory alone: a bench is recorded by `record_live`.

    Raises:
        InstrumentError: a run delivered nothing.
    """
    recordings = []
    for run in sequence.runs:
        recorded = record(run, name=run.name)
        recordings.append(
            replace(recorded, start_time=run.start_time, preload=run.preload)
        )
    preloads = {recording.preload for recording in recordings}
    session = new_session(
        source=sequence.source,
        simulated=sequence.simulated,
        recordings=recordings,
        joint=JointSetup(preload=preloads.pop()) if len(preloads) == 1 else None,
    )
    return with_hits(session, criteria)
