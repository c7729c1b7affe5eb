# SPDX-License-Identifier: MIT
"""Columns of a file before it is stated what they hold."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.basics.units import is_unit, to_si
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.formats.header_units import header_names, stated_units
from jointbench.acquisition.formats.mat_contents import plain_arrays, read_mat
from jointbench.acquisition.formats.netcdf_arrays import (
    NETCDF_SUFFIXES,
    read_labelled_arrays,
)
from jointbench.acquisition.formats.numpy_archives import (
    is_numpy_archive,
    read_numpy_archive,
)
from jointbench.acquisition.formats.tables import Table, load_table

_RATE_WORDS = re.compile(
    r"(?:sampl\w*[ _]?(?:rate|freq\w*)|abtast\w*|\bf_?s\b)\W{0,4}"
    r"(?P<number>\d+(?:[.,]\d+)?(?:[eE][+-]?\d+)?)\s*(?P<unit>[kM]?Hz)?",
    re.I,
)
_STEP_WORDS = re.compile(
    r"(?:\bdt\b|delta[ _]?[tx]|time[ _]?step|increment)\W{0,4}"
    r"(?P<number>\d+(?:[.,]\d+)?(?:[eE][+-]?\d+)?)\s*(?P<unit>[mun]?s)?",
    re.I,
)
_RATE_NAMES = ("fs", "rate", "samplerate", "fsamp", "samplingrate", "samplefrequency")
_STEP_NAMES = ("dt", "deltat", "timestep", "ts")


@dataclass(frozen=True, slots=True, eq=False)
class RawColumn:
    """One column, or one array, of a file.

    Attributes:
        name: by the header or the archive; empty where it has none.
        unit: as stated; empty where not.
        values: of the first hit, shape (n_samples,).
    """

    name: str
    unit: str
    values: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class RawFile:
    """All columns of a file.

    Attributes:
        path: of the file.
        columns: in order.
        named: whether columns are chosen by label, as in archives.
        rate: that the file states apart from its columns [Hz], or None.
        rate_words: where that stands.
    """

    path: Path
    columns: tuple[RawColumn, ...]
    named: bool
    rate: float | None = None
    rate_words: str = ""


def read_raw_columns(path: Path) -> RawFile:
    """Return the columns of a table, or the arrays of an archive.

    Args:
        path: of a text table, .npy, .npz, MAT or netCDF file.

    Raises:
        BadData: the file cannot be read.
        UsageError: it holds no columns to choose from.
    """
    if path.suffix.lower() in NETCDF_SUFFIXES:
        labelled = read_labelled_arrays(path)
        units = {name: one.units for name, one in labelled.items()}
        return _of_arrays(path, {n: a.values for n, a in labelled.items()}, units)
    if path.suffix.lower() == ".mat":
        return _of_arrays(path, plain_arrays(read_mat(path)), {})
    if is_numpy_archive(path):
        return _of_arrays(path, read_numpy_archive(path), {})
    return _of_table(load_table(path))


def _of_table(table: Table) -> RawFile:
    pairs = stated_units(table) or tuple((name, "") for name in header_names(table))
    count = table.values.shape[0]
    pairs = pairs if len(pairs) == count else (("", ""),) * count
    columns = tuple(
        RawColumn(name, unit, np.asarray(values))
        for (name, unit), values in zip(pairs, table.values, strict=True)
    )
    rate, words = _rate_of_header(table.header)
    return RawFile(table.path, columns, False, rate, words)


def _rate_of_header(header: tuple[str, ...]) -> tuple[float | None, str]:
    for line in header:
        for pattern, kind in ((_RATE_WORDS, "frequency"), (_STEP_WORDS, "time")):
            match = pattern.search(line)
            if match is None:
                continue
            default = "Hz" if kind == "frequency" else "s"
            unit = match["unit"] or default
            value = float(match["number"].replace(",", "."))
            value *= to_si(unit, kind) if is_unit(unit, kind) else 1.0
            if value > 0.0:
                rate = value if kind == "frequency" else 1.0 / value
                return rate, f"header: {line.strip()[:60]}"
    return None, ""


def _of_arrays(
    path: Path, arrays: Mapping[str, NDArray[Any]], units: Mapping[str, str]
) -> RawFile:
    columns: list[RawColumn] = []
    rate: float | None = None
    words = ""
    for name, array in arrays.items():
        if array.dtype.kind not in "fiu" or not array.size:
            continue
        whole = np.squeeze(array)
        if whole.ndim == 0:
            plain = re.sub(r"[^a-z]", "", name.rpartition(".")[2].lower())
            value = float(whole)
            if value > 0.0 and plain in (*_RATE_NAMES, *_STEP_NAMES):
                rate = value if plain in _RATE_NAMES else 1.0 / value
                words = f"variable {name} = {value:g}"
        elif whole.ndim <= 2:
            table = np.atleast_2d(whole)
            rows = table if table.shape[1] >= table.shape[0] else table.T
            row = np.asarray(rows[0], np.float64)
            columns.append(RawColumn(name, units.get(name, ""), row))
    if not columns:
        raise UsageError(f"{named(path)} holds no rows of numbers to choose from")
    return RawFile(path, tuple(columns), True, rate, words)
