# SPDX-License-Identifier: MIT
"""Modes of whatever files `identify` is given: sessions, hits or FRFs."""

from collections.abc import Sequence
from pathlib import Path

from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
from jointbench.station.files.frf_files import read_frf
from jointbench.station.files.input_files import read_recordings
from jointbench.station.pipeline.chain import (
    ChainSettings,
    ModalChain,
    frf_chain,
    run_chain,
)
from jointbench.station.pipeline.stage_store import StageRun


def modes_of_files(
    files: Sequence[Path], options: FrfOptions, settings: ChainSettings
) -> ModalChain:
    """Return the modes of files at one state of the joint.

    Args:
        files: all of samples, or all of FRFs, which are recognised by their content.
        options: what the user states about files that are no sessions.
        settings: of the chain; only those of the modes count for FRFs.

    Raises:
        BadData: a file cannot be read, or its units are missing.
        UsageError: some hold FRFs, and some samples.
    """
    frf = read_frf(files, options)
    if frf is not None:
        return frf_chain(frf, settings, StageRun())
    found = read_recordings(files, columns=options.columns, point=options.point)
    return run_chain(found, settings)
