# SPDX-License-Identifier: MIT
"""A session out of the file of its recording: block by block, each one checked."""

import json
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.arrays import IntArray
from jointbench.acquisition.errors import FormatError, HostileFile
from jointbench.acquisition.netcdf_read import read_attribute
from jointbench.acquisition.room import MAX_JSON, MAX_ROWS

Samples = NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class LiveBlock:
    """One block as stored.

    Attributes:
        segment: uninterrupted stretch that it belongs to.
        first: index of its first sample in that stretch.
        stored: index of its first sample in the file.
        samples: shape (n_channels, n).
    """

    segment: int
    first: int
    stored: int
    samples: Samples


@dataclass(frozen=True, slots=True, eq=False)
class LiveContent:
    """What is left of a recording.

    Attributes:
        meta: as known before the first sample.
        blocks: those whose checksum is right, in their order.
        log: entries whose checksum is right, in their order.
        damaged: blocks that were left out.
    """

    meta: dict[str, Any]
    blocks: tuple[LiveBlock, ...]
    log: tuple[dict[str, Any], ...]
    damaged: int

    @property
    def samples(self) -> int:
        """Samples per channel that are there and right."""
        return sum(block.samples.shape[1] for block in self.blocks)


def read_live(file: h5py.File) -> LiveContent:
    """Read the file of a recording, finished or not.

    Args:
        file: open for reading.

    Raises:
        FormatError: what was there before the first sample is damaged.
    """
    meta = json.loads(str(read_attribute(file, "meta")))
    if not isinstance(meta, dict) or "channels" not in meta:
        raise FormatError("the head of the recording does not name its channels")
    index = np.asarray(file["blocks"][...], dtype=np.int64)
    blocks = tuple(_blocks(file["samples"], index))
    return LiveContent(
        meta=meta,
        blocks=blocks,
        log=tuple(_entries(file["log"][...].tobytes())),
        damaged=index.shape[1] - len(blocks),
    )


def _blocks(dataset: h5py.Dataset, index: IntArray) -> Iterator[LiveBlock]:
    stored = 0
    for segment, first, count, crc in index.T.tolist():
        if count > 0 and stored + count <= dataset.shape[1]:
            samples = np.ascontiguousarray(dataset[:, stored : stored + count])
            if zlib.crc32(samples.tobytes()) == crc:
                yield LiveBlock(segment, first, stored, samples)
        stored += max(count, 0)


def _entries(text: bytes) -> Iterator[dict[str, Any]]:
    """Yield the lines that are whole; the last one of a killed session may not be."""
    if text.count(b"\n") > MAX_ROWS or text.count(b"[") > MAX_JSON:
        raise HostileFile("its log has more entries than any recording")
    for line in text.split(b"\n"):
        crc, _, body = line.partition(b" ")
        if body and f"{zlib.crc32(body):08x}".encode() == crc:
            entry = json.loads(body)
            if isinstance(entry, dict):
                yield entry
