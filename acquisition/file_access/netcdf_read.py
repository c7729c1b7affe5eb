# SPDX-License-Identifier: MIT
"""Read back what `netcdf_write` writes, from a file that `hdf5_guards` opened."""

import h5py
import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, IntArray
from jointbench.acquisition.basics.errors import FormatError, HostileFile
from jointbench.acquisition.file_access.memory_room import MAX_ROWS
from jointbench.acquisition.file_access.netcdf_write import NO_VARIABLE, Attribute

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
    """Raise `HostileFile` where a table has more rows than any measurement.

    For tables of which every row becomes a record: that takes far more memory than
    the numbers.
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


def find_group(parent: h5py.Group, name: str) -> h5py.Group | None:
    """Return a group, or None where there is nothing of that name.

    Raises:
        FormatError: it is a dataset.
    """
    found = parent.get(name)
    if found is not None and not isinstance(found, h5py.Group):
        raise FormatError(f"{found.name!r} must be a group, it is a dataset")
    return found


def dimension_names(dataset: h5py.Dataset) -> tuple[str, ...]:
    """Return the name of each axis, empty where it has none."""
    names = []
    for axis in dataset.dims:
        scale = axis[0] if len(axis) else None
        names.append("" if scale is None else str(scale.name).rsplit("/", 1)[-1])
    if dataset.is_scale and names == [""]:
        return (str(dataset.name).rsplit("/", 1)[-1],)
    return tuple(names)


def is_dimension_only(dataset: h5py.Dataset) -> bool:
    """Tell whether a dataset stands for a dimension and holds no values."""
    label = dataset.attrs.get("NAME", b"")
    text = label.decode("utf-8", "ignore") if isinstance(label, bytes) else str(label)
    return bool(dataset.is_scale) and text.startswith(NO_VARIABLE)
