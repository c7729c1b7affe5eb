# SPDX-License-Identifier: MIT
"""Recordings from MAT files of any version from 5 on; never objects.

Structs of Simcenter Testlab state their channels; plain variables, also those inside
structs, are named by ``--columns``: a variable a channel, one for the time.
"""

from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.errors import SamplingError, UnitError
from jointbench.acquisition.basics.units import is_unit, to_si
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.file_access.text_files import file_size
from jointbench.acquisition.formats.even_steps import roundest
from jointbench.acquisition.formats.mat_contents import (
    plain_arrays,
    read_mat,
)
from jointbench.acquisition.formats.samples.array_recordings import (
    recordings_of_arrays,
)
from jointbench.acquisition.formats.samples.repeated_channels import hits_of_channels
from jointbench.acquisition.formats.samples.sample_format import (
    SampleFormat,
    SampleOptions,
)
from jointbench.acquisition.formats.stated_channels import (
    StatedChannel,
    quantity_of_unit,
    recording_of,
)
from jointbench.acquisition.formats.testlab_structs import (
    Struct,
    struct_axis,
    struct_labels,
    struct_unit,
    struct_values,
    testlab_structs,
)
from jointbench.acquisition.records.recordings import Recording

_DIGITS = 1e-9
"""Relative difference of increments that is rounding."""
_TESTLAB = "MAT, structs of Simcenter Testlab"


def read_mat_recordings(path: Path, options: SampleOptions) -> tuple[Recording, ...]:
    """Read the recordings of a MAT file, one for each hit.

    Args:
        path: of the file.
        options: `columns` names plain variables by label,
            ``time.t:s,force.F:N,acceleration.a1:m/s^2``; variables in structs are
            ``struct.field``. Structs of Testlab need none.

    Raises:
        UnitError: units are missing; the message lists the variables.
        UsageError: `columns` names no time and no rate is given.
        SamplingError: the time is not in even steps.
        FormatError: the file is damaged, or holds no rows of numbers.
        HostileFile: it asks for more than a measurement would.
    """
    file_size(path)
    content = read_mat(path)
    structs = [
        (name, one)
        for name, one in testlab_structs(content)
        if not np.iscomplexobj(struct_values(one)) and _over_time(path, name, one)
    ]
    if structs and not _names_variables(options.columns, plain_arrays(content)):
        return _of_structs(path, structs, options)
    return recordings_of_arrays(path, plain_arrays(content), options, "MAT")


def _names_variables(
    columns: str | None, arrays: dict[str, NDArray[np.float64]]
) -> bool:
    return columns is not None and any(f".{name}:" in columns for name in arrays)


def _over_time(path: Path, name: str, struct: Struct) -> bool:
    label = struct_axis(path, f"struct {shown(name)}", struct)[2]
    return is_unit(label, "time") if label else False


def _of_structs(
    path: Path, structs: list[tuple[str, Struct]], options: SampleOptions
) -> tuple[Recording, ...]:
    """Return the time histories of Testlab, one recording for each hit."""
    channels: list[StatedChannel] = []
    keys: list[str] = []
    steps: list[float] = []
    for name, struct in structs:
        where = f"struct {shown(name)}"
        _, increment, label = struct_axis(path, where, struct)
        unit = _unit(path, where, struct, options.columns)
        values = np.asarray(struct_values(struct), np.float64)
        for column in range(values.shape[1]):
            key = struct_labels(struct, column)[0]
            number = f" {column + 1}" if values.shape[1] > 1 else ""
            row = values[:, column]
            channels.append(
                StatedChannel(
                    key or f"{name}{number}",
                    unit,
                    row.size,
                    partial(np.asarray, row),
                    quantity=quantity_of_unit(unit),
                )
            )
            keys.append(key)
            steps.append(increment * to_si(label, "time"))
    hits = hits_of_channels(channels, keys)
    found = []
    for count, hit in enumerate(hits, 1):
        rate = _rate(path, [steps[i] for i in hit])
        found.append(
            recording_of(
                path,
                [channels[i] for i in hit],
                sample_rate=rate,
                columns=options.columns,
                point=options.point,
                layout=_TESTLAB,
                name=path.stem + (f"-{count}" if len(hits) > 1 else ""),
            )
        )
    return tuple(found)


def _unit(path: Path, where: str, struct: Struct, columns: str | None) -> str:
    """Return the stated unit of a struct, empty where the user states it.

    Raises:
        UnitError: a factor beside the label leaves open which unit the values have.
    """
    label, factor = struct_unit(struct)
    if np.isclose(factor, 1.0):
        return label
    if columns is None:
        raise UnitError(
            f"{named(path)}: {where} has the label {shown(label)} and a factor of "
            f"{factor:g} beside it; state which units its channels have, for example "
            "--columns 'force:N,acceleration:m/s^2'"
        )
    return ""


def _rate(path: Path, steps: list[float]) -> float:
    """Return the common rate of channels [Hz], without the noise of a division."""
    if max(steps) - min(steps) > _DIGITS * max(steps):
        raise SamplingError(
            f"{named(path)}: channels must share one time step, theirs are "
            f"{', '.join(f'{s:g} s' for s in sorted(set(steps))[:5])}"
        )
    return roundest((1.0 - _DIGITS) / steps[0], (1.0 + _DIGITS) / steps[0])


FORMAT = SampleFormat("mat", (".mat",), read_mat_recordings)
