# SPDX-License-Identifier: MIT
"""Streams of the vibration controller Rattlesnake: netCDF-4 with its channel table.

``time_data`` (channels x samples) and the attribute ``sample_rate``; the group
``channels`` holds one text a channel: ``node_number``, ``node_direction``, ``unit``.
"""

from functools import partial
from pathlib import Path

import h5py
import numpy as np

from jointbench.acquisition.arrays import FloatArray
from jointbench.acquisition.errors import FormatError, HostileFile
from jointbench.acquisition.guards import Limits, open_guarded
from jointbench.acquisition.records import Recording
from jointbench.acquisition.session_file import damage_named
from jointbench.acquisition.stated_channels import (
    MOST_CHANNELS,
    StatedChannel,
    recording_of,
)
from jointbench.acquisition.text_files import named, shown

SUFFIXES = (".nc", ".nc4")
_LIMITS = Limits(variable_texts=MOST_CHANNELS)
_LONGEST_TEXT = 1000
_MATRIX = 2


def read_rattlesnake(path: Path, *, columns: str | None, point: str) -> Recording:
    """Read a Rattlesnake stream as a recording.

    Args:
        path: of the netCDF-4 file.
        columns: what the channels hold, where its units are none of ours.
        point: where the hammer struck.

    Raises:
        FormatError: it is no such stream, or is damaged.
        HostileFile: it asks for more than a measurement would.
        UnitError: see `recording_of`.
    """
    with open_guarded(path, limits=_LIMITS) as file, damage_named(path):
        data, rate = file.get("time_data"), file.attrs.get("sample_rate")
        table = file.get("channels")
        if (
            not isinstance(data, h5py.Dataset)
            or data.ndim != _MATRIX
            or not isinstance(table, h5py.Group)
            or rate is None
        ):
            raise FormatError(
                f"{named(path)} is no Rattlesnake stream: it lacks time_data, channels "
                "or sample_rate"
            )
        count, size = data.shape
        units = _texts(path, table, "unit", count)
        nodes = _texts(path, table, "node_number", count)
        directions = _texts(path, table, "node_direction", count)
        stated = [
            StatedChannel(
                name=f"{nodes[row]}{directions[row]}" if nodes[row] else f"{row + 1}",
                unit=units[row],
                size=size,
                read=partial(_row, data, row),
                point=nodes[row],
                direction=_direction(directions[row]),
            )
            for row in range(count)
        ]
        return recording_of(
            path,
            stated,
            sample_rate=float(np.asarray(rate).ravel()[0]),
            columns=columns,
            point=point,
            layout="Rattlesnake netCDF",
        )


def _row(data: h5py.Dataset, row: int) -> FloatArray:
    return np.asarray(data[row], dtype=np.float64)


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
