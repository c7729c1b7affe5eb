# SPDX-License-Identifier: MIT
"""Recordings and hits as groups of a session file; used by `store`.

Each recording is one group that xarray can open::

    /stream/<recording>   samples (channel, time), its coordinates time and channel
                          (names), and one row a channel of channel_name, quantity,
                          point, direction, unit, ...; attribute preload [N] where it
                          is this recording's own, preload_sd [N] where measured
    /hits/<recording>     start, trigger, stop, peak_force, verdict, reason (hit), and
                          temperature [degC] where one was measured

The time axis is a plain coordinate for readers, but stored as integers with
`scale_factor` and `add_offset`: a ramp of small integers compresses to almost nothing,
a ramp of doubles to a third of the size of the samples. The sample rate is read from
the attribute `sample_rate`. Samples are doubles, or single precision if that is
lossless. The attribute `units` of the samples is their unit, or one unit a channel
separated by commas (docs/decisions/0314-units-and-names-of-channels.md);
`export --to netcdf` writes a variable a channel.
"""

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, UnitError
from jointbench.acquisition.basics.units import example_unit
from jointbench.acquisition.file_access.hdf5_layout import find_group
from jointbench.acquisition.file_access.netcdf_encodings import (
    units_of_rows,
    write_flags,
    write_labels,
    write_texts,
)
from jointbench.acquisition.file_access.netcdf_read import (
    read_array,
    read_attribute,
    read_flags,
    read_integers,
    read_texts,
    require_rows,
)
from jointbench.acquisition.file_access.netcdf_write import (
    make_variable,
    write_attributes,
    write_axis,
    write_variable,
)
from jointbench.acquisition.file_access.quoting import shown
from jointbench.acquisition.records.provenance import Provenance
from jointbench.acquisition.records.recordings import (
    Channel,
    Hit,
    Quantity,
    Recording,
    Samples,
    Verdict,
)
from jointbench.acquisition.session_file.record_groups import (
    free_name,
    narrowest,
    number,
)


def write_recording(file: h5py.File, recording: Recording, position: int) -> None:
    """Write a recording and its hits.

    Raises:
        BadData: it holds no samples, or a text that cannot be stored.
    """
    if recording.samples.size == 0:
        raise BadData(f"recording {recording.name!r} holds no samples; leave it out")
    group = _begin_recording(file, recording, position, recording.samples.shape[1])
    values = narrowest(np.asarray(recording.samples))
    _make_samples(group, recording, values.shape, values.dtype)[...] = values
    _end_recording(file, group, recording)


def write_recording_in_pieces(
    file: h5py.File,
    recording: Recording,
    position: int,
    *,
    count: int,
    pieces: Iterable[NDArray[np.float32]],
) -> None:
    """Write a recording whose samples exceed the memory.

    Args:
        file: to write to, on the disk.
        recording: without its samples.
        position: among the recordings.
        count: samples per channel.
        pieces: the samples in single precision, each of shape (n_channels, n), finite.

    Raises:
        BadData: a text cannot be stored.
    """
    group = _begin_recording(file, recording, position, count)
    shape = (len(recording.channels), count)
    dataset = _make_samples(group, recording, shape, np.dtype(np.float32))
    done = 0
    for piece in pieces:
        dataset[:, done : done + piece.shape[1]] = piece
        file.flush()
        done += piece.shape[1]
    _end_recording(file, group, recording)


def _begin_recording(
    file: h5py.File, recording: Recording, position: int, count: int
) -> h5py.Group:
    streams = file.require_group("stream")
    group = streams.create_group(free_name(recording.name, streams))
    write_attributes(
        group,
        {
            "name": recording.name,
            "position": position,
            "sample_rate": float(recording.sample_rate),
            "start_time": float(recording.start_time),
            "preload": None if recording.preload is None else float(recording.preload),
            "preload_sd": (
                None if recording.preload_sd is None else float(recording.preload_sd)
            ),
        },
    )
    write_axis(
        group,
        "time",
        count,
        step=1 / recording.sample_rate,
        origin=recording.start_time,
        units="s",
        long_name="time since the session began",
    )
    return group


def _make_samples(
    group: h5py.Group,
    recording: Recording,
    shape: tuple[int, ...],
    dtype: np.dtype[Any],
) -> h5py.Dataset:
    names = [channel.name for channel in recording.channels]
    write_labels(group, "channel", names, long_name="name of the channel")
    return make_variable(
        group,
        "samples",
        (shape, dtype),
        ("channel", "time"),
        units=units_of_rows(_si_units(recording.channels)),
        long_name="samples, each channel in its si_unit",
        attributes={"coordinates": "channel_name quantity point direction si_unit"},
    )


def _end_recording(file: h5py.File, group: h5py.Group, recording: Recording) -> None:
    _write_channels(group, recording.channels)
    if recording.hits:
        _write_hits(file, group, recording)


def recording_from_group(
    file: h5py.File,
    group: h5py.Group,
    provenance: Provenance,
    samples: Callable[[h5py.Dataset], Samples] = read_array,
) -> Recording:
    """Read a recording and its hits, bit for bit as written."""
    return Recording(
        name=str(read_attribute(group, "name")),
        samples=samples(group["samples"]),
        sample_rate=float(number(group, "sample_rate")),
        channels=read_channels(group),
        start_time=float(number(group, "start_time")),
        hits=read_hits(file, group),
        provenance=provenance,
        preload=read_preload(group),
        preload_sd=read_preload(group, "preload_sd"),
    )


def read_preload(group: h5py.Group, name: str = "preload") -> float | None:
    """Return the preload of a recording [N], or its sd; None if it has no own one."""
    return float(number(group, name)) if name in group.attrs else None


def read_channels(group: h5py.Group) -> tuple[Channel, ...]:
    """Read the channels of a recording, not its samples.

    Raises:
        UnitError: samples are stored in another unit than that of the quantity.
    """
    rows = zip(
        read_texts(group["channel_name"]),
        read_flags(group["quantity"]),
        read_texts(group["point"]),
        read_texts(group["direction"]),
        read_texts(group["unit"]),
        _known(group["sensitivity"]),
        _known(group["range"]),
        strict=True,
    )
    channels = tuple(
        Channel(name, Quantity(quantity), *rest) for name, quantity, *rest in rows
    )
    for channel, stored in zip(channels, read_texts(group["si_unit"]), strict=True):
        if stored != example_unit(channel.quantity):
            raise UnitError(
                f"channel {channel.name!r} is stored in {shown(stored)}, a session "
                f"keeps {channel.quantity.value} in {example_unit(channel.quantity)}"
            )
    return channels


def read_hits(file: h5py.File, group: h5py.Group) -> tuple[Hit, ...]:
    """Read the hits of the recording in `group`; empty if none are stored."""
    hits = find_group(file, "hits")
    name = str(group.name).rsplit("/", 1)[-1]
    stored = None if hits is None else find_group(hits, name)
    if stored is None:
        return ()
    require_rows(stored["start"])
    rows = zip(
        read_integers(stored["start"]).tolist(),
        read_integers(stored["trigger"]).tolist(),
        read_integers(stored["stop"]).tolist(),
        read_texts(stored["point"]),
        read_array(stored["peak_force"]).tolist(),
        [Verdict(word) for word in read_flags(stored["verdict"])],
        read_array(stored["measure"]).tolist(),
        read_texts(stored["reason"]),
        _temperatures(stored),
        strict=True,
    )
    return tuple(Hit(*row) for row in rows)


def _temperatures(stored: h5py.Group) -> list[float | None]:
    """Return the temperature of each hit; files without one have none."""
    if "temperature" not in stored:
        return [None] * int(stored["start"].shape[0])
    return _known(stored["temperature"])


def _write_channels(group: h5py.Group, channels: Sequence[Channel]) -> None:
    quantities = list(Quantity)
    write_flags(
        group,
        "quantity",
        [quantities.index(Quantity(c.quantity)) for c in channels],
        ("channel",),
        meanings=[quantity.value for quantity in quantities],
        long_name="what the channel measures",
    )
    texts = {
        "channel_name": ("name of the channel", [c.name for c in channels]),
        "point": ("where it sits on the structure", [c.point for c in channels]),
        "direction": ("direction it senses", [c.direction for c in channels]),
        "unit": ("unit it was recorded in", [c.unit for c in channels]),
        "si_unit": (
            "unit of the stored samples",
            _si_units(channels),
        ),
    }
    for name, (long_name, values) in texts.items():
        write_texts(group, name, values, "channel", long_name=long_name)
    units = _si_units(channels)
    for name, long_name, given, own in (
        (
            "sensitivity",
            "[V per SI unit], NaN if not stated",
            _sensitivities(channels),
            [f"V/({unit})" for unit in units],
        ),
        ("range", "largest value, NaN if unknown", _ranges(channels), units),
    ):
        unit = units_of_rows(own)
        write_variable(
            group, name, given, ("channel",), units=unit, long_name=long_name
        )


def _si_units(channels: Sequence[Channel]) -> list[str]:
    return [example_unit(channel.quantity) for channel in channels]


def _sensitivities(channels: Sequence[Channel]) -> FloatArray:
    return np.array([c.sensitivity for c in channels], dtype=np.float64)


def _ranges(channels: Sequence[Channel]) -> FloatArray:
    return np.array([c.range for c in channels], dtype=np.float64)


def _known(dataset: h5py.Dataset) -> list[float | None]:
    return [
        None if np.isnan(value) else value for value in read_array(dataset).tolist()
    ]


def _write_hits(file: h5py.File, stream: h5py.Group, recording: Recording) -> None:
    name = str(stream.name).rsplit("/", 1)[-1]
    group = file.require_group("hits").create_group(name)
    write_attributes(group, {"recording": recording.name})
    hits = recording.hits
    indices = {
        "start": ("first sample of the segment", [hit.start for hit in hits]),
        "trigger": ("sample at the trigger level", [hit.trigger for hit in hits]),
        "stop": ("one past the last sample", [hit.stop for hit in hits]),
    }
    for key, (long_name, values) in indices.items():
        array = np.array(values, dtype=np.int64)
        write_variable(group, key, array, ("hit",), units="1", long_name=long_name)
    write_variable(
        group,
        "peak_force",
        [float(hit.peak_force) for hit in hits],
        ("hit",),
        units="N",
        long_name="largest force of the hit",
    )
    verdicts = list(Verdict)
    write_flags(
        group,
        "verdict",
        [verdicts.index(Verdict(hit.verdict)) for hit in hits],
        ("hit",),
        meanings=[verdict.value for verdict in verdicts],
        long_name="what became of the hit",
    )
    measures = [float(hit.measure) for hit in hits]
    words = "number of the verdict, see reason"
    write_variable(group, "measure", measures, ("hit",), units="1", long_name=words)
    if any(hit.temperature is not None for hit in hits):
        found = [np.nan if h.temperature is None else h.temperature for h in hits]
        words = "mean temperature over the hit, NaN if unknown"
        write_variable(
            group, "temperature", found, ("hit",), units="degC", long_name=words
        )
    for key, long_name, texts in (
        ("point", "where the hammer struck", [hit.point for hit in hits]),
        ("reason", "rule met or broken", [hit.reason for hit in hits]),
    ):
        write_texts(group, key, texts, "hit", long_name=long_name)
