# SPDX-License-Identifier: MIT
"""What a session holds, as tables for other programs: see `export_command`."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.units import example_unit
from jointbench.acquisition.file_access.netcdf_write import Attribute
from jointbench.acquisition.records.provenance import Provenance
from jointbench.acquisition.records.recordings import Recording
from jointbench.acquisition.records.session import Session
from jointbench.acquisition.records.surfaces import Surface
from jointbench.station.files.long_values import LongValues
from jointbench.station.files.table_files import ExportColumn, ExportTable

ELAPSED = "elapsed_time"
"""Time axis without a date: what is called ``time`` needs a date by CF 4.4."""


def session_tables(session: Session) -> Iterator[ExportTable]:
    """Yield a table of columns for each recording and surface."""
    for recording in session.recordings:
        yield ExportTable(recording.name, _samples(recording))
    for surface in session.surfaces:
        yield ExportTable(surface.name, _heights(surface))


def labelled_tables(session: Session) -> Iterator[tuple[ExportTable, Provenance]]:
    """Yield each recording with its hits, and each surface on its axes.

    Missing heights are NaN; with each table come the steps that made it.
    """
    for recording in session.recordings:
        columns = _samples(recording, ELAPSED) | _hits(recording)
        yield ExportTable(recording.name, columns), recording.provenance
    for surface in session.surfaces:
        yield ExportTable(surface.name, _grid(surface)), surface.provenance


def session_attributes(session: Session) -> dict[str, Attribute]:
    """Return what the session states of itself; what is not stated is left out."""
    stated: dict[str, Attribute] = {
        "session_uuid": session.uuid,
        "session_created": session.created,
        "session_software": session.software,
        "simulated": "true" if session.simulated else "false",
        "operator": session.operator,
        "comment": session.notes,
        "session_source": session.source,
    }
    return {name: value for name, value in stated.items() if value}


def _samples(recording: Recording, axis: str = "time") -> dict[str, ExportColumn]:
    """Return time and channels; samples are read as they are written."""
    count, along = recording.samples.shape[1], (axis,)

    def times(first: int, past: int) -> FloatArray:
        since = np.arange(first, past) / recording.sample_rate
        return np.asarray(recording.start_time + since)

    def samples(row: int, first: int, past: int) -> FloatArray:
        return recording.samples[row, first:past]

    rows = {
        channel.name: ExportColumn(
            example_unit(channel.quantity.value),
            LongValues(count, partial(samples, row)),
            along,
            " ".join(
                filter(None, (channel.quantity.value, channel.point, channel.direction))
            ),
        )
        for row, channel in enumerate(recording.channels)
    }
    words = "time since the session began"
    return {axis: ExportColumn("s", LongValues(count, times), along, words)} | rows


def _hits(recording: Recording) -> dict[str, ExportColumn]:
    """Return a column for each fact of the hits, along the dimension ``hit``."""
    hits, along = recording.hits, ("hit",)
    if not hits:
        return {}

    def seconds(name: str, words: str) -> ExportColumn:
        index = np.array([getattr(hit, name) for hit in hits], dtype=np.float64)
        time = recording.start_time + index / recording.sample_rate
        return ExportColumn("s", time, along, words)

    def texts(name: str, words: str) -> ExportColumn:
        found = [str(getattr(hit, name)) for hit in hits]
        return ExportColumn("", np.array(found, np.str_), along, words)

    peaks = np.array([hit.peak_force for hit in hits], dtype=np.float64)
    return {
        "hit_start": seconds("start", "time of the first sample of the hit"),
        "hit_trigger": seconds("trigger", "time at which the force passes the level"),
        "hit_stop": seconds("stop", "time after the last sample of the hit"),
        "hit_peak_force": ExportColumn("N", peaks, along, "largest force of the hit"),
        "hit_point": texts("point", "where the hammer struck"),
        "hit_verdict": texts("verdict", "what became of the hit"),
        "hit_reason": texts("reason", "rule met or broken"),
    }


def _axes(surface: Surface) -> dict[str, ExportColumn]:
    """Return the axes of a surface: x of a profile, y and x of a map."""
    steps = np.atleast_1d(surface.spacing)
    names = ("y", "x")[-surface.heights.ndim :]
    return {
        name: ExportColumn(
            "m", np.arange(size) * step, (name,), f"distance along {name}"
        )
        for name, size, step in zip(names, surface.heights.shape, steps, strict=True)
    }


def _grid(surface: Surface) -> dict[str, ExportColumn]:
    axes = _axes(surface)
    z = np.where(surface.valid, surface.heights, np.nan)
    return axes | {"z": ExportColumn("m", z, tuple(axes), "height")}


def _heights(surface: Surface) -> dict[str, ExportColumn]:
    """Return a row a point: coordinates and height, NaN where it is missing."""
    axes = _axes(surface)
    places = np.meshgrid(*(axis.values for axis in axes.values()), indexing="ij")
    columns = dict(zip(axes, places, strict=True))
    columns |= {"z": np.where(surface.valid, surface.heights, np.nan)}
    return {
        n: ExportColumn("m", values.ravel(), ("point",))
        for n, values in columns.items()
    }
