# SPDX-License-Identifier: MIT
"""Samples from files of any registered format."""

from dataclasses import replace
from pathlib import Path

from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.basics.registry import Entry, Registry
from jointbench.acquisition.formats.package_formats import (
    added_by,
    single_taker,
)
from jointbench.acquisition.formats.samples import (
    mat_recording,
    rattlesnake,
    tdms,
    universal,
    wave,
)
from jointbench.acquisition.formats.samples.sample_format import (
    SampleFormat,
    SampleOptions,
)
from jointbench.acquisition.records.recordings import Recording


def _built_in() -> tuple[SampleFormat, ...]:
    return (
        universal.FORMAT,
        tdms.FORMAT,
        mat_recording.FORMAT,
        wave.FORMAT,
        rattlesnake.FORMAT,
    )


SAMPLE_FORMATS = Registry(
    "jointbench.sample_formats", "sample format", SampleFormat, _built_in
)


def read_samples(path: Path, options: SampleOptions) -> tuple[Recording, ...]:
    """Read a file of a format that holds samples by its nature.

    Formats of other packages are asked first: who installs one wants it.

    Args:
        path: of the file.
        options: what the user says about it.

    Returns:
        The recordings of the file; none where no format takes it.

    Raises:
        BadData: the file is not what it should be, or its units are missing.
        UsageError: two packages take the file.
    """
    taker = single_taker(
        SAMPLE_FORMATS.entries(), lambda format_: format_.takes(path), path
    )
    return () if taker is None else _read(taker, path, options)


def _read(
    taker: Entry[SampleFormat], path: Path, options: SampleOptions
) -> tuple[Recording, ...]:
    with taker.running(FormatError):
        found = taker.value.read(path, options)
        if taker.built_in:
            return found
        if not found or not all(isinstance(one, Recording) for one in found):
            raise TypeError("read must return a tuple of at least one Recording")
    origin = added_by(taker, path)
    return tuple(replace(one, provenance=(origin, *one.provenance)) for one in found)
