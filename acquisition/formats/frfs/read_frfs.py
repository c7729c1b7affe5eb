# SPDX-License-Identifier: MIT
"""FRFs from files of any registered format."""

from dataclasses import replace
from pathlib import Path

from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.basics.registry import Entry, Registry
from jointbench.acquisition.file_access.text_files import file_size
from jointbench.acquisition.formats.frfs import (
    mat_frfs,
    netcdf_frfs,
    numpy_frfs,
    table_frfs,
    universal_frfs,
)
from jointbench.acquisition.formats.frfs.frf_format import FrfFormat, FrfOptions
from jointbench.acquisition.formats.package_formats import added_by, matching_format
from jointbench.acquisition.records.frf_functions import FrfFunction


def _built_in() -> tuple[FrfFormat, ...]:
    return (
        universal_frfs.FORMAT,
        mat_frfs.FORMAT,
        numpy_frfs.FORMAT,
        netcdf_frfs.FORMAT,
        table_frfs.FORMAT,
    )


FRF_FORMATS = Registry("jointbench.frf_formats", "FRF format", FrfFormat, _built_in)


def read_frfs(path: Path, options: FrfOptions) -> tuple[FrfFunction, ...]:
    """Read the FRFs of a file, if it holds some.

    Formats of other packages take precedence over the built-in ones.

    Args:
        path: of the file.
        options: what the user states about it.

    Returns:
        The FRFs of the file; none where no format recognises it.

    Raises:
        BadData: the file is not what it should be, or its units are missing.
        UsageError: two packages take the file.
    """
    file_size(path)
    entry = matching_format(
        FRF_FORMATS.entries(), lambda format_: format_.recognise(path, options), path
    )
    return () if entry is None else _read(entry, path, options)


def _read(
    entry: Entry[FrfFormat], path: Path, options: FrfOptions
) -> tuple[FrfFunction, ...]:
    with entry.running(FormatError):
        found = entry.value.read(path, options)
        if entry.built_in:
            return found
        if not found or not all(isinstance(one, FrfFunction) for one in found):
            raise TypeError("read must return a tuple of at least one FrfFunction")
    origin = added_by(entry, path)
    return tuple(replace(one, provenance=(origin, *one.provenance)) for one in found)
