# SPDX-License-Identifier: MIT
"""Open a session whose samples are read from the file when they are needed.

What was unpacked last is kept, up to some megabytes, so that the stages which look at
one hit after the other unpack it once.
"""

import weakref
from collections import OrderedDict
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.array_checks import require_finite
from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.steady_memory import keep_memory_steady
from jointbench.acquisition.file_access.hdf5_guards import open_guarded
from jointbench.acquisition.file_access.netcdf_read import read_attribute
from jointbench.acquisition.file_access.netcdf_write import CHUNK_VALUES
from jointbench.acquisition.records.session import Session
from jointbench.acquisition.records.stored_samples import StoredSamples
from jointbench.acquisition.session_file.live_read import read_live
from jointbench.acquisition.session_file.live_write import LIVE_SCHEMA
from jointbench.acquisition.session_file.record_groups import in_order
from jointbench.acquisition.session_file.recovery import outline_live
from jointbench.acquisition.session_file.session_limits import SESSION_LIMITS
from jointbench.acquisition.session_file.store import (
    SESSION_SCHEMA,
    damage_named,
    read_content,
    read_session,
)

MOST_WHOLE = 2**26
"""Size of the samples up to which a session is read at once [bytes]: it is faster, and
a few times as much fits into any memory."""
_MOST_KEPT = 2**25
"""Size of the unpacked samples that are kept [bytes]: one hit of 64 channels and 2 s at
51.2 kS/s in single precision."""
_SAMPLES = 2**19
"""Samples of each channel that are kept at most: 10 s at 51.2 kS/s. Few channels need
less than `_MOST_KEPT`."""
_LARGE_BLOCK = 2**22
"""Blocks below this size are used again [bytes]: those of a hit, hundreds of times a
second, cost half the time of `modal` when each goes back to the system."""
_DOUBLE = 8


@dataclass(slots=True, eq=False, weakref_slot=True)
class _OpenFile:
    """An open session, and the chunks that were unpacked last."""

    path: Path
    file: h5py.File
    chunks: OrderedDict[tuple[str, int, int], NDArray[Any]] = field(
        default_factory=OrderedDict
    )
    kept: int = 0
    last: h5py.Dataset | None = None

    def chunk(self, name: str, rows: slice, columns: slice) -> NDArray[Any]:
        """Return a chunk as stored, by the name of its dataset and its place in it."""
        key = (name, rows.start, columns.start)
        if key in self.chunks:
            self.chunks.move_to_end(key)
            return self.chunks[key]
        with damage_named(self.path):
            dataset = self._dataset(name)
            values = dataset[rows, columns]
            require_finite("samples", values)
        self.chunks[key] = values
        self.kept += values.nbytes
        most = min(_MOST_KEPT, _SAMPLES * dataset.shape[0] * values.itemsize)
        while self.kept > most and len(self.chunks) > 1:
            self.kept -= self.chunks.popitem(last=False)[1].nbytes
        return np.asarray(values)

    def _dataset(self, name: str) -> h5py.Dataset:
        """Return a dataset; one alone stays open, as HDF5 keeps a megabyte for each."""
        if self.last is None or self.last.name != name:
            self.last = self.file[name]
        return self.last


@dataclass(frozen=True, slots=True, eq=False)
class _Rows:
    """The samples of one recording in an open session.

    Attributes:
        file: an open one.
        name: of the dataset.
        shape: channels and samples of each.
        chunk: of the dataset.
        origin: index of the first sample in the dataset.
    """

    file: _OpenFile
    name: str
    shape: tuple[int, int]
    chunk: tuple[int, int]
    origin: int = 0

    def read(self, row: int, first: int, past: int) -> FloatArray:
        height, width = self.chunk
        first, past = first + self.origin, past + self.origin
        top = row - row % height
        found = np.empty(past - first)
        for left in range(first - first % width, past, width):
            place = slice(top, top + height), slice(left, left + width)
            values = self.file.chunk(self.name, *place)[row - top]
            begin, end = max(first, left), min(past, left + width)
            found[begin - first : end - first] = values[begin - left : end - left]
        return found


def _stored(
    file: _OpenFile, dataset: h5py.Dataset, span: tuple[int, int] | None = None
) -> StoredSamples:
    """Return samples that stay in the file; a file of others may have no chunks.

    Args:
        file: an open one.
        dataset: in it.
        span: first of the samples and their number; None for all.
    """
    height, width = dataset.chunks or (1, CHUNK_VALUES)
    rows, columns = dataset.shape
    first, count = span or (0, int(columns))
    shape, chunk = (int(rows), count), (int(height), int(width))
    return StoredSamples(_Rows(file, str(dataset.name), shape, chunk, first))


def _live_session(file: h5py.File, opened: _OpenFile) -> Session:
    """Return the session of a recording, its samples in its file."""
    outline, spans = outline_live(read_live(file))
    recordings = (
        replace(
            recording,
            samples=_stored(opened, file["samples"], (span.stored, span.count)),
        )
        for recording, span in zip(outline.recordings, spans, strict=True)
    )
    return replace(outline, recordings=tuple(recordings))


def open_session(path: Path | str, *, most_whole: int = MOST_WHOLE) -> Session:
    """Read a session; large samples stay in the file until they are asked for.

    Args:
        path: of a session, or of a recording that was cut off.
        most_whole: size of samples up to which all are read now [bytes].

    Returns:
        The session. Its file stays open as long as a recording of it is used.

    Raises:
        BadData: as `read_session`; for samples that are read later, on access.
    """
    with ExitStack() as stack:
        file = stack.enter_context(open_guarded(path, limits=SESSION_LIMITS))
        if not _is_large(file, path, most_whole):
            return read_session(path)
        # Blocks of many sizes are read in turn, over hours of samples.
        keep_memory_steady(_LARGE_BLOCK)
        opened = _OpenFile(Path(path), file)
        with damage_named(path):
            if read_attribute(file, "schema") == LIVE_SCHEMA:
                session = _live_session(file, opened)
            else:
                session = read_content(file, partial(_stored, opened))
        weakref.finalize(opened, stack.pop_all().close)
    return session


def _is_large(file: h5py.File, path: Path | str, most: int) -> bool:
    with damage_named(path):
        schema = read_attribute(file, "schema")
        if schema == LIVE_SCHEMA:
            return _DOUBLE * int(file["samples"].size) > most
        if schema != SESSION_SCHEMA:
            return False
        groups = in_order(file, "stream")
        return sum(_DOUBLE * int(group["samples"].size) for group in groups) > most


def read_all_samples(path: Path) -> None:
    """Read every sample of a finished session once, some columns at a time.

    Raises:
        BadData: a sample cannot be read, or is not finite.
    """
    with open_guarded(path, limits=SESSION_LIMITS) as file, damage_named(path):
        for group in in_order(file, "stream"):
            dataset = group["samples"]
            for first in range(0, dataset.shape[1], CHUNK_VALUES):
                require_finite("samples", dataset[:, first : first + CHUNK_VALUES])
