# SPDX-License-Identifier: MIT
"""Samples of a session as a universal file: data sets 151 (header) and 58, SI units.

Source:
    Structural Dynamics Research Laboratory, University of Cincinnati, Universal File
    Formats, data sets 151 (header) and 58 (function at nodal degree of freedom).
"""

from collections.abc import Iterator
from datetime import datetime
from pathlib import Path

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.units import example_unit
from jointbench.acquisition.records.recordings import Channel, Quantity, Recording
from jointbench.acquisition.records.session import Session
from jointbench.station.files.output_paths import whole_file
from jointbench.station.files.universal_frf import axis_line, printable

_EDGE = "    -1"
_TIME_RESPONSE = 1
_REAL_DOUBLE = 4
_EVEN = 1
_TIME = 17
_WORDS = {
    Quantity.DISPLACEMENT: (8, "Displacement"),
    Quantity.VELOCITY: (11, "Velocity"),
    Quantity.ACCELERATION: (12, "Acceleration"),
    Quantity.FORCE: (13, "Force"),
    Quantity.PRESSURE: (15, "Pressure"),
    Quantity.STRAIN: (3, "Strain"),
    Quantity.TEMPERATURE: (5, "Temperature"),
    Quantity.VOLTAGE: (1, "Voltage"),
    Quantity.TACHO: (1, "Tacho"),
}
"""Code of each quantity in data set 58; 1 stands for any other."""
_DIRECTIONS = {"x": 1, "y": 2, "z": 3}
_ROW = 4
_PIECE = 2**16  # samples that are formatted at a time


def write_universal_samples(path: Path, session: Session) -> None:
    """Write a header and one data set 58 for each channel of each recording.

    Args:
        path: file to write.
        session: its recordings go in; surfaces have no place there.
    """
    with whole_file(path) as part, part.open("w", encoding="utf-8", newline="\n") as to:
        to.writelines(f"{line}\n" for line in _lines(session))


def _lines(session: Session) -> Iterator[str]:
    yield from _header(session)
    for recording in session.recordings:
        for row, channel in enumerate(recording.channels):
            yield from _samples(recording, row, channel)


def _header(session: Session) -> Iterator[str]:
    """Yield data set 151: what made the file, and when."""
    try:
        moment = datetime.fromisoformat(session.created)
    except ValueError:
        moment = datetime(1970, 1, 1)
    date = moment.strftime("%d-%b-%y"), moment.strftime("%H:%M:%S")
    yield from (_EDGE, "   151")
    for text in (session.uuid, session.source or "session", session.software):
        yield printable(text)
    yield f"{date[0]:10s}{date[1]:10s}{0:10d}{0:10d}{0:10d}"
    yield f"{date[0]:10s}{date[1]:10s}"
    yield printable(session.software)
    yield f"{date[0]:10s}{date[1]:10s}"
    yield _EDGE


def _samples(recording: Recording, row: int, channel: Channel) -> Iterator[str]:
    code, word = _WORDS[channel.quantity]
    count = recording.samples.shape[1]
    step = 1.0 / recording.sample_rate
    yield from (_EDGE, "    58")
    for text in (f"{recording.name} {channel.name}", "jointbench", "", "", "NONE"):
        yield printable(text)
    node = int(channel.point) if channel.point.isdecimal() else 0
    entity = printable(channel.name)[:10]
    yield (
        f"{_TIME_RESPONSE:5d}{0:10d}{0:5d}{0:10d} {entity:10s}{node % 10**10:10d}"
        f"{_direction(channel):4d} {'NONE':10s}{0:10d}{0:4d}"
    )
    start = recording.start_time
    yield (
        f"{_REAL_DOUBLE:10d}{count:10d}{_EVEN:10d}{start:13.5e}{step:13.5e}{0.0:13.5e}"
    )
    yield axis_line(_TIME, "Time", "s")
    yield axis_line(code, word, example_unit(channel.quantity.value))
    yield from (axis_line(0, "NONE", "NONE"),) * 2
    for begin in range(0, count, _PIECE):
        yield from _rows(recording.samples[row, begin : begin + _PIECE])
    yield _EDGE


def _rows(values: FloatArray) -> Iterator[str]:
    """Yield rows of four numbers, as one text: a call for each takes twice as long."""
    whole = values.size // _ROW * _ROW
    if whole:
        row = "%20.11e" * _ROW
        numbers = tuple(values[:whole].tolist())
        yield "\n".join([row] * (whole // _ROW)) % numbers
    if whole < values.size:
        yield "".join(f"{value:20.11e}" for value in values[whole:].tolist())


def _direction(channel: Channel) -> int:
    sign = -1 if channel.direction.startswith("-") else 1
    return sign * _DIRECTIONS.get(channel.direction[-1:].lower(), 0)
