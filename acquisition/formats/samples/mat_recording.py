# SPDX-License-Identifier: MIT
"""Recordings from MAT files: a variable a channel, one for the time; never objects."""

from functools import partial
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.errors import SamplingError, UnitError, UsageError
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.formats.columns import Column, parse_columns
from jointbench.acquisition.formats.even_steps import fit_even_steps, roundest
from jointbench.acquisition.formats.samples.mat_file import (
    list_mat_variables,
    read_mat_rows,
)
from jointbench.acquisition.formats.samples.sample_format import (
    SampleFormat,
    SampleOptions,
)
from jointbench.acquisition.formats.stated_channels import StatedChannel, recording_of
from jointbench.acquisition.records.recordings import Recording

_TIME = "time"


def read_mat_recording(path: Path, *, columns: str | None, point: str) -> Recording:
    """Read variables of a MAT file as a recording.

    Args:
        path: of a file of MATLAB 7 or older (``save -v7``).
        columns: the variables by label, ``time.t:s,force.F:N,acceleration.a1:m/s^2``.
        point: where the hammer struck.

    Raises:
        UnitError: `columns` is missing; the message lists the variables.
        UsageError: it names no time, or a variable without a label.
        SamplingError: the time is not in even steps.
        BadData: see `read_mat_rows`.
    """
    if columns is None:
        found = ", ".join(list_mat_variables(path)[:12]) or "none"
        raise UnitError(
            f"{named(path)} holds the variables {found} and no units; describe them, "
            "for example --columns 'time.t:s,force.F:N,acceleration.a1:m/s^2'"
        )
    time, rest = _parted(columns)
    channels = parse_columns(rest)
    names = [column.label for column in channels]
    stamps, *rows = read_mat_rows(path, [time.label, *names])
    try:
        steps = fit_even_steps(
            stamps, what="time", unit=time.unit, where=lambda i: f"sample {i + 1}"
        )
    except SamplingError as error:
        raise SamplingError(f"{named(path)}: {error}") from error
    for name, row in zip(names, rows, strict=True):
        if row.size != stamps.size:
            raise SamplingError(
                f"{named(path)}: variable {name!r} has {row.size} samples, the time "
                f"{stamps.size}; save them at the same moments"
            )
    second = time.factor
    return recording_of(
        path,
        [
            StatedChannel(name, "", row.size, partial(np.asarray, row))
            for name, row in zip(names, rows, strict=True)
        ],
        sample_rate=roundest(1 / (steps.high * second), 1 / (steps.low * second)),
        columns=rest,
        point=point,
        layout="MAT",
    )


def _parted(columns: str) -> tuple[Column, str]:
    """Return the column of the time, and the others as typed."""
    items = [item.strip() for item in columns.split(",")]
    times = [i for i in items if parse_columns(i)[0].role == _TIME]
    rest = [i for i in items if i not in times]
    if len(times) != 1 or not rest:
        raise UsageError(
            f"--columns {columns!r} must name one time and some channels of the MAT "
            "file, for example 'time.t:s,force.F:N,acceleration.a1:m/s^2'"
        )
    for item in items:
        if not parse_columns(item)[0].label:
            raise UsageError(
                f"--columns: {item!r} names no variable; write it after the role, for "
                "example force.F:N"
            )
    return parse_columns(times[0])[0], ",".join(rest)


def _read_format(path: Path, options: SampleOptions) -> tuple[Recording, ...]:
    return (read_mat_recording(path, columns=options.columns, point=options.point),)


FORMAT = SampleFormat("mat", (".mat",), _read_format)
