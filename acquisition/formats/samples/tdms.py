# SPDX-License-Identifier: MIT
"""Samples from TDMS files by npTDMS, an extra; sizes checked before they are read."""

import logging
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import (
    FormatError,
    HostileFile,
    JointbenchError,
    SamplingError,
    UsageError,
)
from jointbench.acquisition.file_access.memory_room import require_room
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.file_access.text_files import file_size
from jointbench.acquisition.formats.samples.sample_format import (
    SampleFormat,
    SampleOptions,
)
from jointbench.acquisition.formats.stated_channels import StatedChannel, recording_of
from jointbench.acquisition.records.recordings import Recording

INSTALL = "pip install 'jointbench[tdms]'"
_MOST_BYTES = 8 * 2**30
_LEAD = 28
_MOST_SEGMENTS = 20_000
_MOST_SAID = 4_000_000


def read_tdms(path: Path, *, columns: str | None, point: str) -> Recording:
    """Read the channels of a TDMS file as one recording.

    Args:
        path: of the file.
        columns: what the channels hold, by their names, where the file states no unit.
        point: where the hammer struck.

    Raises:
        UsageError: npTDMS is not installed.
        FormatError: it is no TDMS file, or is damaged.
        HostileFile: it claims more samples than it has bytes.
        SamplingError: channels have no rate, or different ones.
        UnitError: see `recording_of`.
    """
    try:
        from nptdms import TdmsFile
    except ImportError as error:
        raise UsageError(f"TDMS needs npTDMS; type {INSTALL}") from error
    size = file_size(path)
    with path.open("rb") as opened:
        if opened.read(4) != b"TDSm":
            raise FormatError(f"{named(path)} is no TDMS file; export it again")
    if size > _MOST_BYTES:
        raise HostileFile(f"{named(path)} has {size} bytes; cut it")
    _require_few_segments(path, size)
    try:
        # Opened here, because npTDMS leaves files open that it cannot read.
        with (
            _complaints() as complaints,
            path.open("rb") as opened,
            TdmsFile.open(opened) as file,
        ):
            channels = [c for group in file.groups() for c in group.channels()]
            recording = _recording(path, size, channels, columns, point)
    except JointbenchError:
        raise
    except Exception as error:
        raise FormatError(
            f"{named(path)} cannot be read as TDMS ({shown(error)}); use another copy"
        ) from error
    if complaints:
        raise FormatError(
            f"{named(path)} is cut short or damaged ({shown(complaints[0])}); use "
            "another copy"
        )
    return recording


def _require_few_segments(path: Path, size: int) -> None:
    """Walk over the segments: npTDMS takes a tenth of a millisecond for each.

    Raises:
        HostileFile: there are more of them, or longer descriptions of channels, than in
            any measurement.
    """
    at = segments = said = 0
    with path.open("rb") as file:
        while at + _LEAD <= size:
            file.seek(at)
            lead = file.read(_LEAD)
            if lead[:4] != b"TDSm":
                return  # the reader reports the damage
            following, about = struct.unpack("<QQ", lead[12:])
            segments, said = segments + 1, said + min(about, size)
            if segments > _MOST_SEGMENTS or said > _MOST_SAID:
                raise HostileFile(
                    f"{named(path)} has more than {_MOST_SEGMENTS} segments, or "
                    f"{_MOST_SAID} bytes about its channels; defragment it in LabVIEW, "
                    "or split it"
                )
            at += _LEAD + following


@contextmanager
def _complaints() -> Iterator[list[str]]:
    """Collect what npTDMS only logs: it reads on where a file was cut."""
    found: list[str] = []

    class Collector(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            found.append(record.getMessage())

    loggers = [
        logger
        for name, logger in logging.root.manager.loggerDict.items()
        if name.startswith("nptdms.") and isinstance(logger, logging.Logger)
    ]
    before = [(logger.handlers, logger.propagate) for logger in loggers]
    for logger in loggers:
        logger.handlers, logger.propagate = [Collector(logging.WARNING)], False
    try:
        yield found
    finally:
        for logger, (handlers, propagates) in zip(loggers, before, strict=True):
            logger.handlers, logger.propagate = handlers, propagates


def _recording(
    path: Path, size: int, channels: list[Any], columns: str | None, point: str
) -> Recording:
    numeric = [
        c for c in channels if c.dtype is not None and c.dtype.kind in "fiu" and len(c)
    ]
    claimed = sum(len(channel) * channel.dtype.itemsize for channel in numeric)
    if claimed > 16 * size:  # raw data of a converter may be scaled up to doubles
        raise HostileFile(f"{named(path)} claims {claimed} bytes, it has {size}")
    sizes = [len(channel) for channel in numeric]
    require_room(path, 8 * sum(sizes) + 24 * max(sizes, default=0))
    steps = {float(c.properties.get("wf_increment", 0.0)) for c in numeric}
    if len(steps) != 1 or not min(steps) > 0:
        raise SamplingError(
            f"{named(path)}: channels must share one time step (wf_increment), theirs "
            f"are {', '.join(f'{s:g} s' for s in sorted(steps)[:5]) or 'none'}"
        )
    return recording_of(
        path,
        [_stated(channel) for channel in numeric],
        sample_rate=1.0 / steps.pop(),
        columns=columns,
        point=point,
        layout="TDMS",
    )


def _stated(channel: Any) -> StatedChannel:
    return StatedChannel(
        name=str(channel.name),
        unit=str(channel.properties.get("unit_string", "") or ""),
        size=len(channel),
        read=partial(_values, channel),
    )


def _values(channel: Any) -> FloatArray:
    return np.asarray(channel[:], dtype=np.float64)


def _read_format(path: Path, options: SampleOptions) -> tuple[Recording, ...]:
    return (read_tdms(path, columns=options.columns, point=options.point),)


FORMAT = SampleFormat("tdms", (".tdms",), _read_format)
