# SPDX-License-Identifier: MIT
"""Streams of the vibration controller Rattlesnake: netCDF-4 with its channel table.

``time_data`` (channels x samples) and the attribute ``sample_rate``; the group
``channels`` holds one text a channel: ``node_number``, ``node_direction``, ``unit``.
Each further stream of a recording is a variable of its own: ``time_data_1``, ...

Its number of samples grows while it is written, so netCDF stores every moment as a
chunk: a minute at 10 kHz has 600,000. HDF5 takes 15 us for each, a look-up of where
they stand in the file less than one.
"""

import re
from array import array
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import h5py
import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import FormatError, HostileFile
from jointbench.acquisition.file_access.hdf5_guards import FileLimits, open_guarded
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.file_access.text_files import file_size
from jointbench.acquisition.formats.netcdf_arrays import NETCDF_SUFFIXES
from jointbench.acquisition.formats.samples.labelled_recording import (
    read_labelled_recordings,
)
from jointbench.acquisition.formats.samples.sample_format import (
    SampleFormat,
    SampleOptions,
)
from jointbench.acquisition.formats.stated_channels import (
    MOST_CHANNELS,
    StatedChannel,
    recording_of,
)
from jointbench.acquisition.records.recordings import Recording
from jointbench.acquisition.session_file.store import damage_named

# A chunk takes eight bytes of a sample and a key in the tree of chunks.
_LIMITS = FileLimits(variable_texts=MOST_CHANNELS, chunk_bytes=32)
_STREAM = re.compile(r"time_data(?:_(\d{1,6}))?")
_MOST_STREAMS = 1000
_PIECE = 2**18  # chunks that are copied at once
_COLUMNS = 10_000  # samples that HDF5 reads at once: it takes 4 kB a chunk
_LONGEST_TEXT = 1000
_MATRIX = 2


def read_rattlesnake(
    path: Path, *, columns: str | None, point: str
) -> tuple[Recording, ...]:
    """Read every stream of a Rattlesnake file as a recording of its own.

    Args:
        path: of the netCDF-4 file.
        columns: what the channels hold, where its units are unknown.
        point: where the hammer struck.

    Returns:
        The recordings in the order of the streams; the first has the name of the
        file, ``time_data_1`` that name and ``-1``. A stream without samples is none.

    Raises:
        FormatError: it is no such stream, or is damaged.
        HostileFile: it asks for more than a measurement would.
        UnitError: see `recording_of`.
    """
    with open_guarded(path, limits=_LIMITS) as file, damage_named(path):
        rate, table = file.attrs.get("sample_rate"), file.get("channels")
        streams = _streams(path, file)
        if not streams or not isinstance(table, h5py.Group) or rate is None:
            raise FormatError(
                f"{named(path)} is no Rattlesnake stream: it lacks time_data, channels "
                "or sample_rate"
            )
        count = next(iter(streams.values())).shape[0]
        texts = [
            _texts(path, table, name, count)
            for name in ("node_number", "node_direction", "unit")
        ]
        return tuple(
            recording_of(
                path,
                _stated(path, data, texts),
                sample_rate=float(np.asarray(rate).ravel()[0]),
                columns=columns,
                point=point,
                layout=f"Rattlesnake netCDF, {str(data.name).strip('/')}",
                name=path.stem + suffix,
            )
            for suffix, data in streams.items()
        )


def _streams(path: Path, file: h5py.File) -> dict[str, h5py.Dataset]:
    """Return the streams that hold samples, by what is added to the file's name.

    The first is there even without samples, where no other holds any.
    """
    numbered = {
        int(match[1] or 0): file[name]
        for name in file
        if (match := _STREAM.fullmatch(name))
    }
    if len(numbered) > _MOST_STREAMS:
        raise HostileFile(f"{named(path)} has {len(numbered)} streams; split it")
    found = {
        f"-{number}" if number else "": numbered[number] for number in sorted(numbered)
    }
    for data in found.values():
        if not isinstance(data, h5py.Dataset) or data.ndim != _MATRIX:
            raise FormatError(f"{named(path)}: {data.name} is no table of samples")
    if len({data.shape[0] for data in found.values()}) > 1:
        raise FormatError(
            f"{named(path)}: its streams have different numbers of channels; use "
            "another copy"
        )
    filled = {name: data for name, data in found.items() if data.shape[1]}
    return filled or dict(list(found.items())[:1])


def _stated(
    path: Path, data: h5py.Dataset, texts: list[list[str]]
) -> Iterator[StatedChannel]:
    """Yield the channels of a stream, of which no sample is read so far."""
    rows: list[FloatArray] = []

    def read(row: int) -> FloatArray:
        if not rows:
            rows.append(_samples(path, data))
        return np.asarray(rows[0][row])

    for row, (node, way, unit) in enumerate(zip(*texts, strict=True)):
        yield StatedChannel(
            name=f"{node}{way}" if node else f"{row + 1}",
            unit=unit,
            size=data.shape[1],
            read=partial(read, row),
            point=node,
            direction=_direction(way),
        )


def _samples(path: Path, data: h5py.Dataset) -> FloatArray:
    """Return a stream, shape (n_channels, n_samples)."""
    plain = data.dtype.kind == "f" and not data.compression and not data.shuffle
    if data.chunks != (data.shape[0], 1) or not plain or data.fletcher32:
        found = np.empty(data.shape)
        for first in range(0, data.shape[1], _COLUMNS):
            some = slice(first, first + _COLUMNS)
            found[:, some] = data[:, some]
        return found
    places = array("q")
    data.id.chunk_iter(
        lambda chunk: places.extend((chunk.chunk_offset[1], chunk.byte_offset))
    )
    moment, begin = np.frombuffer(places, np.int64).reshape(-1, 2).T
    width = data.shape[0] * data.dtype.itemsize
    whole = np.array_equal(np.sort(moment), np.arange(data.shape[1]))
    if not whole or begin.min() < 0 or begin.max() + width > file_size(path):
        raise FormatError(
            f"{named(path)}: {data.name} holds {moment.size} of {data.shape[1]} "
            "samples; it is cut short: use another copy"
        )
    stored = np.memmap(path, mode="r")
    found = np.empty(data.shape)
    for first in range(0, moment.size, _PIECE):
        some = slice(first, first + _PIECE)
        taken = stored[begin[some, None] + np.arange(width)].view(data.dtype)
        found[:, moment[some]] = taken.T
    return found


def _direction(text: str) -> str:
    """Return ``"Z+"`` as ``"+z"``, whatever else as it stands."""
    axis, sign = text[:1].lower(), text[1:] or "+"
    return f"{sign}{axis}" if axis in {"x", "y", "z"} and sign in "+-" else text


def _texts(path: Path, table: h5py.Group, name: str, count: int) -> list[str]:
    """Return the texts of a column, one by one: many may be one long one."""
    column = table.get(name)
    if not isinstance(column, h5py.Dataset) or column.shape != (count,):
        return [""] * count
    texts = []
    for row in range(count):
        value = column[row]
        text = value.decode("utf-8", "replace") if isinstance(value, bytes) else value
        if not isinstance(text, str) or len(text) > _LONGEST_TEXT:
            raise HostileFile(
                f"{named(path)}: {name} of channel {row + 1} is {shown(text)}; "
                "no text of a channel is that long"
            )
        texts.append(text.strip())
    return texts


def _is_stream(path: Path) -> bool:
    """Return whether a file is one of Rattlesnake, or no file of labelled arrays."""
    try:
        with h5py.File(path, "r") as file:
            return "channels" in file and any(map(_STREAM.fullmatch, file))
    except (OSError, RuntimeError, ValueError):
        return False


def _read_format(path: Path, options: SampleOptions) -> tuple[Recording, ...]:
    if not _is_stream(path):
        return read_labelled_recordings(path, options)
    return read_rattlesnake(path, columns=options.columns, point=options.point)


FORMAT = SampleFormat("netcdf", NETCDF_SUFFIXES, _read_format)
