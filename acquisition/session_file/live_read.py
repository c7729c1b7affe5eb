# SPDX-License-Identifier: MIT
"""Read the file of a recording block by block, each one checked."""

import json
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.arrays import IntArray
from jointbench.acquisition.basics.errors import FormatError, HostileFile
from jointbench.acquisition.file_access.memory_room import MAX_JSON, MAX_ROWS
from jointbench.acquisition.file_access.netcdf_read import read_attribute
from jointbench.acquisition.file_access.netcdf_write import CHUNK_VALUES

Samples = NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class LiveSpan:
    """Blocks that follow each other without a gap, each with a right checksum.

    Attributes:
        segment: uninterrupted segment of the stream.
        first: index of their first sample in that segment.
        stored: index of that sample in the file.
        count: samples per channel.
    """

    segment: int
    first: int
    stored: int
    count: int

    @property
    def past(self) -> int:
        """Index in the file one past the last sample."""
        return self.stored + self.count

    def cut(self, stored: int, past: int) -> "LiveSpan":
        """Return the part from one index in the file up to another."""
        return LiveSpan(
            self.segment, self.first + stored - self.stored, stored, past - stored
        )

    def joined(self, other: "LiveSpan") -> "LiveSpan | None":
        """Return both as one if `other` follows at once, otherwise None."""
        if (
            other.segment != self.segment
            or other.first != self.first + self.count
            or other.stored != self.past
        ):
            return None
        return LiveSpan(self.segment, self.first, self.stored, self.count + other.count)


@dataclass(frozen=True, slots=True, eq=False)
class LiveContent:
    """Valid content of a recording; its samples stay in the file.

    Attributes:
        meta: as known before the first sample.
        spans: valid blocks, in order; a span may cover several runs.
        log: entries with a valid checksum, in order.
        damaged: blocks that were left out.
    """

    meta: dict[str, Any]
    spans: tuple[LiveSpan, ...]
    log: tuple[dict[str, Any], ...]
    damaged: int

    @property
    def samples(self) -> int:
        """Number of valid samples per channel."""
        return sum(span.count for span in self.spans)


def read_live(file: h5py.File) -> LiveContent:
    """Read the file of a recording, finished or not, block by block.

    Args:
        file: open for reading.

    Raises:
        FormatError: the data before the first sample are damaged.
    """
    meta = json.loads(str(read_attribute(file, "meta")))
    if not isinstance(meta, dict) or "channels" not in meta:
        raise FormatError("the head of the recording does not name its channels")
    index = np.asarray(file["blocks"][...], dtype=np.int64)
    good = list(_good(file["samples"], index))
    return LiveContent(
        meta=meta,
        spans=tuple(_spans(index, good)),
        log=tuple(log_entries(file["log"][...].tobytes())),
        damaged=good.count(False),
    )


def read_pieces(file: h5py.File, stored: int, count: int) -> Iterator[Samples]:
    """Yield samples from an index in the file on, some columns at a time."""
    dataset = file["samples"]
    for first in range(stored, stored + count, CHUNK_VALUES):
        yield dataset[:, first : min(first + CHUNK_VALUES, stored + count)]


def _good(dataset: h5py.Dataset, index: IntArray) -> Iterator[bool]:
    """Yield for each block whether its checksum is valid."""
    stored = 0
    for _, _, count, crc in index.T.tolist():
        whole = count > 0 and stored + count <= dataset.shape[1]
        if whole:
            samples = np.ascontiguousarray(dataset[:, stored : stored + count])
            whole = zlib.crc32(samples.tobytes()) == crc
        yield whole
        stored += max(count, 0)


def _spans(index: IntArray, good: list[bool]) -> Iterator[LiveSpan]:
    span, stored = None, 0
    for (segment, first, count, _), whole in zip(index.T.tolist(), good, strict=True):
        block = LiveSpan(segment, first, stored, count)
        stored += max(count, 0)
        if not whole:
            continue
        joined = None if span is None else span.joined(block)
        if span is not None and joined is None:
            yield span
        span = joined or block
    if span is not None:
        yield span


def log_entries(text: bytes) -> Iterator[dict[str, Any]]:
    """Yield the entries of a log; the last line of a killed session may be cut.

    Args:
        text: of the log, with a checksum before each line.

    Raises:
        HostileFile: it has more entries than any recording.
    """
    if text.count(b"\n") > MAX_ROWS or text.count(b"[") > MAX_JSON:
        raise HostileFile("its log has more entries than any recording")
    for line in text.split(b"\n"):
        crc, _, body = line.partition(b" ")
        if body and f"{zlib.crc32(body):08x}".encode() == crc:
            entry = json.loads(body)
            if isinstance(entry, dict):
                yield entry
