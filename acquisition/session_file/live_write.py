# SPDX-License-Identifier: MIT
"""The file of a session during recording: written data survive a crash.

Layout, version 1; every dataset exists before the first sample, and HDF5's
single-writer mode keeps the file readable at any moment::

    /            schema, meta (JSON: uuid, source, channels, ...)
    /samples     (channel, time), single precision, one chunk a block
    /blocks      (block, 4): segment, first sample in it, count, CRC-32 of the samples
    /log         bytes: one JSON object a line, each with a CRC-32

A separate thread writes and flushes every block, and syncs the disk once a second.
"""

import json
import os
import queue
import threading
import time
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import IO

import h5py
import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import InstrumentError, UsageError
from jointbench.acquisition.file_access.disk_room import DiskRoom
from jointbench.acquisition.file_access.file_lock import drop_lock, hold_lock
from jointbench.acquisition.file_access.netcdf_write import write_attributes
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.records.recordings import Channel

LIVE_SCHEMA = "jointbench-live/1"
_SYNC_EVERY = 1.0  # [s]
_LOG_CHUNK = 4096
_BLOCKS_CHUNK = 256

Entry = Mapping[str, object]


def channel_rows(channels: Sequence[Channel]) -> list[dict[str, object]]:
    """Return channels as rows for the head of a recording."""
    return [
        {
            "name": channel.name,
            "quantity": channel.quantity.value,
            "point": channel.point,
            "direction": channel.direction,
            "unit": channel.unit,
            "sensitivity": channel.sensitivity,
            "range": channel.range,
        }
        for channel in channels
    ]


class LiveSession:
    """Append blocks and log entries; nothing that was flushed is lost."""

    def __init__(self, path: Path, meta: Entry, *, channels: int, block: int) -> None:
        """Create the file and start its writer.

        Args:
            path: of a new file.
            meta: data known before the first sample, as JSON types.
            channels: rows of every block.
            block: usual samples of a block.

        Raises:
            UsageError: the file is there, is being recorded, or cannot be written.
        """
        if path.exists():
            raise UsageError(f"{named(path)} is there already; choose another name")
        self.path = path
        self.samples = 0
        self._lock: IO[bytes] = hold_lock(path)
        try:
            self._file = _create(path, meta, channels, block)
        except OSError as error:
            drop_lock(path, self._lock)
            raise UsageError(
                f"{named(path)} cannot be written: {error.strerror or 'refused'}; "
                "choose another place"
            ) from error
        self._queue: queue.Queue[tuple[int, int, FloatArray] | bytes | None]
        self._queue = queue.Queue()
        self._failure: BaseException | None = None
        self._thread = threading.Thread(target=self._write_all, name="session writer")
        self._thread.daemon = True
        self._thread.start()

    def __enter__(self) -> "LiveSession":
        """Return the session."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close; an earlier error is raised unless another is being raised."""
        try:
            self.close()
        except InstrumentError:
            if error is None:
                raise

    def append(self, samples: FloatArray, *, segment: int, first: int) -> None:
        """Queue a block for writing.

        Args:
            samples: SI units, shape (n_channels, n).
            segment: uninterrupted segment of the samples.
            first: index of the first of them in that segment.

        Raises:
            InstrumentError: the disk refused an earlier block.
        """
        # At most this one block is queued: a slow disk delays the reader, for whom the
        # driver buffers seconds of samples.
        self._queue.join()
        self._put((segment, first, samples))
        self.samples += samples.shape[1]

    def written(self) -> None:
        """Return once everything queued is in the file, where any process can read it.

        Raises:
            InstrumentError: the disk refused something.
        """
        self._queue.join()
        self._raise_failure()

    def log(self, entry: Entry) -> None:
        """Queue an entry of the log; samples stored and the time are added.

        Raises:
            InstrumentError: the disk refused something earlier.
        """
        line = {**entry}
        line.setdefault("stored", self.samples)
        line.setdefault("time", round(time.time(), 3))
        text = json.dumps(line, ensure_ascii=True)
        self._put(f"{zlib.crc32(text.encode()):08x} {text}\n".encode())

    def close(self) -> None:
        """Write the queue, sync the disk, close the file and release the lock.

        Raises:
            InstrumentError: the disk refused something.
        """
        if self._thread.is_alive():
            self._queue.put(None)
            self._thread.join()
        if self._lock.closed:
            return
        try:
            self._file.close()
        except (OSError, RuntimeError) as error:
            self._failure = self._failure or error
        drop_lock(self.path, self._lock)
        self._raise_failure()

    def _put(self, item: tuple[int, int, FloatArray] | bytes) -> None:
        self._raise_failure()
        self._queue.put(item)

    def _raise_failure(self) -> None:
        if self._failure is not None:
            reason = getattr(self._failure, "strerror", None) or self._failure
            raise InstrumentError(
                f"{named(self.path)}: the disk refuses more ({reason}); what was "
                "written is safe; make room, and measure the rest into another file"
            ) from self._failure

    def _write_all(self) -> None:
        with self.path.open("rb+") as handle:
            room = DiskRoom(handle, self._file)
            synced = time.monotonic()
            while (item := self._queue.get()) is not None:
                try:
                    # After a failure the caller gets the error at the next call.
                    if self._failure is None:
                        room.make(
                            len(item) if isinstance(item, bytes) else item[2].nbytes
                        )
                        self._write(item)
                    if time.monotonic() - synced > _SYNC_EVERY:
                        os.fsync(handle.fileno())
                        synced = time.monotonic()
                except (OSError, RuntimeError) as error:
                    self._failure = error
                finally:
                    self._queue.task_done()
            if self._failure is None:
                os.fsync(handle.fileno())

    def _write(self, item: tuple[int, int, FloatArray] | bytes) -> None:
        if isinstance(item, bytes):
            _extend(self._file["log"], np.frombuffer(item, dtype=np.uint8))
            return
        segment, first, samples = item
        single = np.ascontiguousarray(samples, dtype=np.float32)
        crc = zlib.crc32(single.tobytes())
        _extend(self._file["samples"], single)
        row = np.array([[segment, first, single.shape[1], crc]], dtype=np.int64)
        _extend(self._file["blocks"], row.T)


def _create(path: Path, meta: Entry, channels: int, block: int) -> h5py.File:
    file = h5py.File(path, "x", libver="latest")
    write_attributes(file, {"schema": LIVE_SCHEMA, "meta": json.dumps(dict(meta))})
    for name, rows, chunk, kind in (
        ("samples", (channels,), block, np.float32),
        ("blocks", (4,), _BLOCKS_CHUNK, np.int64),
        ("log", (), _LOG_CHUNK, np.uint8),
    ):
        file.create_dataset(
            name,
            shape=(*rows, 0),
            maxshape=(*rows, None),
            chunks=(*rows, chunk),
            dtype=kind,
        )
    file.swmr_mode = True
    return file


def _extend(dataset: h5py.Dataset, values: np.typing.NDArray[np.generic]) -> None:
    """Append along the last axis and flush."""
    old = dataset.shape[-1]
    dataset.resize(old + values.shape[-1], axis=dataset.ndim - 1)
    dataset[..., old:] = values
    dataset.flush()
