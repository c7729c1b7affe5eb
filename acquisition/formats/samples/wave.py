# SPDX-License-Identifier: MIT
"""Samples from WAV files: their numbers have no unit, which the user must give."""

import math
import struct
import warnings
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.errors import (
    FormatError,
    HostileFile,
    UnitError,
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

_MOST_BYTES = 2**31
_MOST_CHUNKS = 1000
_HEADER = 12
_HEADS = {b"RIFF": "<", b"RIFX": ">"}


def read_wave(
    path: Path, *, columns: str | None, point: str, full_scale: float | None = None
) -> Recording:
    """Read a WAV file as a recording.

    Args:
        path: of the file.
        columns: what its channels hold, in their order; always needed.
        point: where the hammer struck.
        full_scale: what the largest number of the file stands for, in the unit of
            `columns`; needed for whole numbers, 1 for floating point if None.

    Raises:
        UnitError: `columns`, or `full_scale` of whole numbers, is missing.
        FormatError: it is no WAV file, or is cut short.
        HostileFile: it claims more than it holds.
    """
    _require_whole(path)
    rate, values = _read(path)
    values = values.reshape(len(values), -1)
    if columns is None:
        raise UnitError(
            f"{named(path)} has {values.shape[1]} channels; WAV states no units: "
            "describe them, for example --columns 'force:V@2.25mV/N,acceleration:"
            "V@10mV/g' --full-scale 10"
        )
    scale = _scale(path, values, full_scale)
    require_room(path, values.nbytes + 8 * values.size + 16 * len(values))
    stated = [
        StatedChannel(
            name=str(index + 1),
            unit="",
            size=values.shape[0],
            read=partial(np.multiply, values[:, index], scale, dtype=np.float64),
        )
        for index in range(values.shape[1])
    ]
    return recording_of(
        path,
        stated,
        sample_rate=float(rate),
        columns=columns,
        point=point,
        layout="WAV",
    )


def _scale(path: Path, values: NDArray[Any], full_scale: float | None) -> float:
    """Return what a step of the numbers stands for.

    Raises:
        UnitError: the numbers are integers and the full scale is not given.
        UsageError: the full scale is not above zero.
    """
    if full_scale is not None and not 0.0 < full_scale < math.inf:
        raise UsageError(
            f"--full-scale is {full_scale:g}; write what the largest number of the "
            "file stands for, above zero"
        )
    if values.dtype.kind == "f":
        return 1.0 if full_scale is None else full_scale
    if full_scale is None:
        raise UnitError(
            f"{named(path)} holds whole numbers; give the value of the largest "
            "in the unit of --columns, for example --full-scale 10"
        )
    return full_scale / (np.iinfo(values.dtype).max + 1.0)


def _require_whole(path: Path) -> None:
    """Walk over the chunks: none may claim more than the file has."""
    size = file_size(path)
    if size > _MOST_BYTES:
        raise HostileFile(f"{named(path)} has {size} bytes, at most {_MOST_BYTES}")
    with path.open("rb") as file:
        head = file.read(_HEADER)
        order = _HEADS.get(head[:4])
        if order is None or head[8:12] != b"WAVE":
            raise FormatError(f"{named(path)} is no WAV file; export it again")
        at, count = _HEADER, 0
        while at + 8 <= size:
            count += 1
            if count > _MOST_CHUNKS:
                raise HostileFile(
                    f"{named(path)} has more than {_MOST_CHUNKS} chunks; save its "
                    "samples alone"
                )
            file.seek(at)
            tag = file.read(8)
            length = struct.unpack(f"{order}I", tag[4:])[0]
            if at + 8 + length > size:
                raise FormatError(
                    f"{named(path)}: a chunk claims {length} bytes, {size - at - 8} "
                    "are left; it is cut short: use another copy"
                )
            at += 8 + length + length % 2


def _read(path: Path) -> tuple[int, NDArray[Any]]:
    from scipy.io import wavfile

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", wavfile.WavFileWarning)
            rate, values = wavfile.read(path)
    except Exception as error:
        raise FormatError(
            f"{named(path)} cannot be read as WAV ({shown(error)}); use another copy"
        ) from error
    if values.dtype.kind == "u":  # 8 bits are stored about 128
        values = (values ^ 0x80).view(np.int8)
    if values.size == 0:
        raise FormatError(f"{named(path)} holds no samples")
    return int(rate), values


def _read_format(path: Path, options: SampleOptions) -> tuple[Recording, ...]:
    return (
        read_wave(
            path,
            columns=options.columns,
            point=options.point,
            full_scale=options.full_scale,
        ),
    )


FORMAT = SampleFormat("wave", (".wav",), _read_format)
