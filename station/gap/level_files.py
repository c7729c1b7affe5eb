# SPDX-License-Identifier: MIT
"""Read the records at several levels that a TOML file lists."""

from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, SamplingError, UsageError
from jointbench.acquisition.records.recordings import (
    Quantity,
    Recording,
    common_response,
    response_rows,
)
from jointbench.analysis.gap.modal_bench.base_from_records import BaseRequest
from jointbench.analysis.gap.modal_bench.level_records import (
    LevelRecord,
    Port,
    RecordSet,
)
from jointbench.analysis.gap.modal_bench.periods import one_period
from jointbench.analysis.lumped.lumped_model import Output
from jointbench.station.files.input_files import read_recordings
from jointbench.station.files.toml_file import read_toml
from jointbench.station.files.toml_text import load_toml
from jointbench.station.gap.line_files import LineRequest, read_lines
from jointbench.station.schemas.levels_model import LevelsModel, LevelTable

_OUTPUTS = {
    Quantity.DISPLACEMENT: Output.DISPLACEMENT,
    Quantity.VELOCITY: Output.VELOCITY,
    Quantity.ACCELERATION: Output.ACCELERATION,
}


def names_levels(path: Path) -> bool:
    """Return whether a TOML file describes records at several levels."""
    try:
        return "levels" in load_toml(path)
    except (OSError, ValueError, RecursionError):
        return False  # the reader of the model reports the fault


def read_levels(path: Path) -> tuple[RecordSet, BaseRequest]:
    """Read the records that a TOML file names, and how their base is found.

    Args:
        path: of the TOML file; the files are beside it.

    Raises:
        BadData: the TOML file breaks a rule, or a file has other channels than the
            first one.
        SamplingError: a file has another sample rate than the first one, or is too
            short for its lead.
    """
    model = read_toml(path, LevelsModel)
    read: list[tuple[LevelTable, Recording]] = []
    for level in model.levels:
        recordings = _recordings(model, level, path.parent)
        read += [(level, _decimated(r, model.records.decimate)) for r in recordings]
    first = read[0][1]
    for _, recording in read[1:]:
        _require_alike(first, recording)
    given = RecordSet(
        name=path.stem,
        sample_rate=first.sample_rate,
        sensors=tuple(first.channels[i].name for i in response_rows(first)),
        inputs=_inputs(first),
        ports=tuple(Port(name, p.between) for name, p in model.ports.items()),
        records=tuple(_record(model, level, r) for level, r in read),
        output=_OUTPUTS[common_response(first.channels)],
        repeatability=model.records.repeatability,
    )
    _require_linear_frf(model, given)
    base = model.base
    return given, BaseRequest(base.band, base.modes, base.beyond)


def _recordings(
    model: LevelsModel, level: LevelTable, folder: Path
) -> tuple[Recording, ...]:
    """Return the recordings of a level, one period of each file of complex lines."""
    files = [folder / name for name in level.files]
    table = model.records
    if table.lines is None or table.rate is None:
        return read_recordings(files, columns=table.columns, point="")
    request = LineRequest(table.lines, table.rate, level.frf_force, level.frf_columns)
    return tuple(read_lines(path, request) for path in files)


def _require_linear_frf(model: LevelsModel, given: RecordSet) -> None:
    """Raise unless an FRF is of the lowest level, whose records count as linear."""
    lowest = given.lowest[0].level
    for level in model.levels:
        if level.frf_force is not None and level.name != lowest:
            raise UsageError(
                f"level {level.name!r} is an FRF at {level.frf_force:g} N and "
                f"{lowest!r} has less force; an FRF stands for the lowest level, as a "
                "linear one: leave it out or give its samples"
            )


def _inputs(recording: Recording) -> tuple[str, ...]:
    """Return the sensor at the point of each force, or the name of the force."""
    at = {recording.channels[i].point: i for i in reversed(response_rows(recording))}
    forces = recording.rows(Quantity.FORCE)
    if not forces:
        raise BadData(
            f"'{recording.name}' has no force; name its column, for example "
            "columns = 'time:s,force.shaker@tip:N,acceleration.a1@tip:m/s^2'"
        )
    found = []
    for row in forces:
        force = recording.channels[row]
        here = at.get(force.point) if force.point else None
        found.append(force.name if here is None else recording.channels[here].name)
    return tuple(found)


def _require_alike(first: Recording, other: Recording) -> None:
    if not np.isclose(first.sample_rate, other.sample_rate, rtol=1e-6):
        raise SamplingError(
            f"'{other.name}' is sampled at {other.sample_rate:g} Hz and "
            f"'{first.name}' at {first.sample_rate:g} Hz; resample one of them"
        )
    names = [[(c.name, c.quantity) for c in r.channels] for r in (first, other)]
    if names[0] != names[1]:
        words = [", ".join(name for name, _ in row) for row in names]
        raise BadData(
            f"'{other.name}' has the channels {words[1]} and '{first.name}' {words[0]};"
            " give every file the same columns"
        )


def _decimated(recording: Recording, factor: int) -> Recording:
    """Keep one sample in `factor`, forces and responses through the same filter."""
    if factor == 1:
        return recording
    from scipy.signal import decimate  # slow to import

    samples = decimate(recording.samples, factor, ftype="fir", axis=1, zero_phase=True)
    return Recording(
        recording.name,
        np.ascontiguousarray(samples),
        recording.sample_rate / factor,
        recording.channels,
    )


def _record(model: LevelsModel, level: LevelTable, recording: Recording) -> LevelRecord:
    table = model.records
    samples: FloatArray = np.asarray(recording.samples)
    if table.remove_mean:
        samples = samples - samples.mean(axis=1, keepdims=True)
    record = LevelRecord(
        name=recording.name,
        level=level.name,
        force=np.array(samples[list(recording.rows(Quantity.FORCE))]),
        response=np.array(samples[list(response_rows(recording))]),
        lead=_scaled(table.lead if level.lead is None else level.lead, table.decimate),
        held_out=level.held_out,
        excitation=level.excitation or table.excitation,
        linear=level.frf_force is not None,
        offset=table.remove_mean or table.lines is not None,
    )
    if table.lines is not None:
        return one_period(record, record.force.shape[1])
    period = level.period or table.period
    if period is None or record.excitation != "multisine":
        return record
    if period % table.decimate:
        raise SamplingError(
            f"a period of {period} samples is no multiple of decimate = "
            f"{table.decimate}; choose a factor of the period"
        )
    return one_period(record, period // table.decimate)


def _scaled(samples: int, factor: int) -> int:
    return -(-samples // factor)
