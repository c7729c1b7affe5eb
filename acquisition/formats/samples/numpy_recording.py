# SPDX-License-Identifier: MIT
"""Recordings from .npz archives, and from .npy arrays with an axis of hits."""

from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.errors import BadData, FormatError
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.file_access.text_files import file_size
from jointbench.acquisition.formats.columns import SKIP, parse_columns
from jointbench.acquisition.formats.numpy_archives import (
    NPY_MAGIC,
    is_numpy_archive,
    read_array_header,
    read_numpy_archive,
    read_numpy_array,
)
from jointbench.acquisition.formats.samples.array_recordings import (
    recordings_of_arrays,
)
from jointbench.acquisition.formats.samples.sample_format import (
    SampleFormat,
    SampleOptions,
)
from jointbench.acquisition.formats.tables import read_head
from jointbench.acquisition.records.recordings import Recording

_CUBE = 3


def read_numpy_recordings(path: Path, options: SampleOptions) -> tuple[Recording, ...]:
    """Read the recordings of an archive, or of an array with three axes.

    Args:
        path: of a .npz archive of named arrays, or of a .npy array of hits, channels
            and samples.
        options: `columns` names the arrays of an archive by label; those of a .npy
            array stand in the order of its channels.

    Raises:
        BadData: see `recordings_of_arrays`.
        FormatError: no axis of the array has as many entries as there are channels.
    """
    file_size(path)
    if is_numpy_archive(path):
        return recordings_of_arrays(path, read_numpy_archive(path), options, "npz")
    array = read_numpy_array(path)
    items = [item.strip() for item in (options.columns or "").split(",") if item]
    count = len(parse_columns(options.columns)) if options.columns else 0
    short = [axis for axis in range(_CUBE) if axis != int(np.argmax(array.shape))]
    fits = [axis for axis in short if array.shape[axis] == count]
    if len(fits) != 1 and fits != short:
        raise FormatError(
            f"{named(path)} has the shape {array.shape}; an array of three axes holds "
            "hits, channels and samples: name as many --columns as there are channels, "
            "for example 'force:N,acceleration:m/s^2'"
        )
    # Of two axes of one length the later one is that of the channels.
    cube = np.moveaxis(array, (fits[-1], int(np.argmax(array.shape))), (0, 2))
    named_items, arrays = [], {}
    for row, (item, column) in enumerate(
        zip(items, parse_columns(",".join(items)), strict=True)
    ):
        if column.role == SKIP:
            continue
        head, _, unit = item.partition(":")
        name = column.label or f"{column.role}_{row + 1}"
        role, _, point = head.partition("@")
        place = f"@{point}" if point else ""
        named_items.append(f"{role.partition('.')[0]}.{name}{place}:{unit}")
        arrays[name] = cube[row]
    given = SampleOptions(
        ",".join(named_items), options.point, options.full_scale, options.rate
    )
    return recordings_of_arrays(path, arrays, given, f"npy, shape {array.shape}")


def recognise_numpy_recordings(path: Path) -> bool:
    """Return whether a file is an archive, or an array with three axes."""
    try:
        if is_numpy_archive(path):
            return True
        if path.suffix.lower() != ".npy" or not read_head(path, 6) == NPY_MAGIC:
            return False
        with path.open("rb") as file:
            shape, kind = read_array_header(file)
            return len(shape) == _CUBE and kind.kind in "fiu"
    except (BadData, OSError, ValueError, SyntaxError, TypeError, EOFError):
        return False  # the reader of tables reports the fault


FORMAT = SampleFormat(
    "numpy", (".npz", ".npy"), read_numpy_recordings, recognise_numpy_recordings
)
