# SPDX-License-Identifier: MIT
"""Read the content of `netcdf_write`; `hdf5_guards.open_guarded` opens the file."""

import h5py
import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, IntArray
from jointbench.acquisition.basics.errors import FormatError, HostileFile
from jointbench.acquisition.file_access.memory_room import MAX_ROWS
from jointbench.acquisition.file_access.netcdf_write import Attribute

_CHARACTER_AXES = 2


def read_attribute(target: h5py.Group | h5py.Dataset, name: str) -> Attribute | None:
    """Return a text or a number, or None where there is no such attribute."""
    value = target.attrs.get(name)
    if isinstance(value, bytes):
        return value.decode("utf-8")
    if isinstance(value, np.ndarray):
        value = value.reshape(-1)[0] if value.size == 1 else None
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, bytes):
        return value.decode("utf-8")
    return value if isinstance(value, str | int | float | bool) else None


def read_flags(dataset: h5py.Dataset) -> tuple[str, ...]:
    """Return the words of a flag variable of one dimension.

    Raises:
        FormatError: a code has no word.
    """
    words = str(read_attribute(dataset, "flag_meanings") or "").split()
    codes = np.asarray(dataset[...], dtype=np.int64).ravel()
    if codes.size and not (0 <= codes.min() and codes.max() < len(words)):
        raise FormatError(
            f"{dataset.name!r} holds code {codes.max()}, it has {len(words)} meanings"
        )
    return tuple(words[code] for code in codes)


def read_texts(dataset: h5py.Dataset) -> tuple[str, ...]:
    """Return the texts of a character array, see `write_texts`."""
    table = np.ascontiguousarray(dataset[...])
    if table.ndim != _CHARACTER_AXES or table.dtype != np.dtype("S1"):
        raise FormatError(f"{dataset.name!r} is no table of characters")
    rows = table.view(f"S{table.shape[1]}").ravel()
    return tuple(row.decode("utf-8") for row in rows.tolist())


def require_rows(dataset: h5py.Dataset) -> None:
    """Raise `HostileFile` where a table has too many rows.

    For tables with one record per row, which take far more memory than the numbers.
    """
    if dataset.size > MAX_ROWS:
        raise HostileFile(
            f"{dataset.name!r} has {dataset.size} rows, at most {MAX_ROWS} are read"
        )


def read_complex(group: h5py.Group, name: str) -> ComplexArray:
    """Return complex numbers written by `write_complex`, bit for bit."""
    real = np.asarray(group[f"{name}_re"][...], dtype=np.float64)
    values = np.empty(real.shape, dtype=np.complex128)
    values.real = real
    values.imag = group[f"{name}_im"][...]
    return values


def read_array(dataset: h5py.Dataset) -> FloatArray:
    """Return real numbers as stored, as doubles."""
    return np.asarray(dataset[...], dtype=np.float64)


def read_integers(dataset: h5py.Dataset) -> IntArray:
    """Return whole numbers as stored."""
    return np.asarray(dataset[...], dtype=np.int64)
