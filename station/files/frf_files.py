# SPDX-License-Identifier: MIT
"""Files of FRFs as input of a command: one FRF record of all of them."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
from jointbench.acquisition.formats.frfs.read_frfs import read_frfs
from jointbench.acquisition.records.frf_functions import FrfFunction
from jointbench.signal.frf.frf import Frf
from jointbench.signal.frf.frf_of_functions import frf_of_functions
from jointbench.station.files.input_files import is_session_name, refuse_twice


def read_frf(files: Sequence[Path], options: FrfOptions) -> Frf | None:
    """Return the FRFs of files as one record.

    Args:
        files: of a command; sessions hold no FRFs.
        options: what the user states about them.

    Returns:
        The FRF, or None where the files hold samples.

    Raises:
        UsageError: some hold FRFs, and some samples.
        BadData: a file cannot be read, or the FRFs do not fit each other.
    """
    found = {
        path: () if is_session_name(path) else read_frfs(path, options)
        for path in files
    }
    without = [path for path, functions in found.items() if not functions]
    if len(without) == len(found):
        return None
    if without:
        other = next(path for path in found if path not in without)
        raise UsageError(
            f"{named(other)} holds FRFs and {named(without[0])} none; give files of "
            "FRFs, or files of samples"
        )
    refuse_twice(files)
    several = len(files) > 1
    return frf_of_functions(
        [
            _labelled(one, path.stem) if several else one
            for path, functions in found.items()
            for one in functions
        ]
    )


def _labelled(one: FrfFunction, name: str) -> FrfFunction:
    """Return a function named after its file where the file names none."""
    return one if one.output else replace(one, output=name)
