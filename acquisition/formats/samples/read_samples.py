# SPDX-License-Identifier: MIT
"""Samples from files of any registered format."""

from dataclasses import replace
from pathlib import Path

from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.basics.registry import Entry, Registry
from jointbench.acquisition.formats.package_formats import (
    added_by,
    matching_format,
)
from jointbench.acquisition.formats.refused_formats import refuse_known
from jointbench.acquisition.formats.samples import (
    mat_recording,
    numpy_recording,
    rattlesnake,
    tdms,
    universal,
    wave,
)
from jointbench.acquisition.formats.samples.array_recordings import require_rate
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
        numpy_recording.FORMAT,
    )


SAMPLE_FORMATS = Registry(
    "jointbench.sample_formats", "sample format", SampleFormat, _built_in
)


def read_samples(path: Path, options: SampleOptions) -> tuple[Recording, ...]:
    """Read a file of a format that holds samples by its nature.

    Formats of other packages take precedence over the built-in ones.

    Args:
        path: of the file.
        options: what the user says about it.

    Returns:
        The recordings of the file; none where no format takes it.

    Raises:
        BadData: the file is not what it should be, or its units are missing.
        UsageError: two packages take the file.
        SamplingError: the file states another rate than the user.
    """
    entry = matching_format(
        SAMPLE_FORMATS.entries(), lambda format_: format_.takes(path), path
    )
    if entry is None:
        refuse_known(path)
        return ()
    found = _read(entry, path, options)
    for one in found:
        require_rate(path, one.sample_rate, options.rate)
    return found


def _read(
    entry: Entry[SampleFormat], path: Path, options: SampleOptions
) -> tuple[Recording, ...]:
    with entry.running(FormatError):
        found = entry.value.read(path, options)
        if entry.built_in:
            return found
        if not found or not all(isinstance(one, Recording) for one in found):
            raise TypeError("read must return a tuple of at least one Recording")
    origin = added_by(entry, path)
    return tuple(replace(one, provenance=(origin, *one.provenance)) for one in found)
