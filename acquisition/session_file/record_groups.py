# SPDX-License-Identifier: MIT
"""Groups of records in a session file: their names, order and numbers."""

import re

import h5py
import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.file_access.hdf5_layout import find_group
from jointbench.acquisition.file_access.netcdf_read import (
    read_attribute,
)

_LONGEST_NAME = 100


def free_name(name: str, parent: h5py.Group) -> str:
    """Return a group name for a record: its name, unless HDF5 or netCDF forbids it."""
    plain = re.sub(r"[/\x00-\x1f\x7f]", "_", name)[:_LONGEST_NAME].strip()
    if not plain or not (plain[0].isalnum() or plain[0] == "_" or ord(plain[0]) > 127):
        plain = f"_{plain}"
    candidate, count = plain, 1
    while candidate in parent:
        count += 1
        candidate = f"{plain}_{count}"
    return candidate


def in_order(file: h5py.File, name: str) -> list[h5py.Group]:
    """Return the groups of the records below group `name` in the order written."""
    parent = find_group(file, name)
    if parent is None:
        return []
    groups = [group for group in parent.values() if isinstance(group, h5py.Group)]
    return sorted(groups, key=lambda group: number(group, "position"))


def number(target: h5py.Group, name: str) -> float:
    """Return an attribute that must be a number.

    Raises:
        FormatError: it is not there, or is no number.
    """
    value = read_attribute(target, name)
    if not isinstance(value, int | float):
        raise FormatError(f"{target.name!r} lacks the number {name!r}")
    return value


def narrowest(values: FloatArray) -> NDArray[np.float64] | NDArray[np.float32]:
    """Return values in single precision if that is lossless."""
    with np.errstate(over="ignore"):
        single = values.astype(np.float32)
    return single if np.array_equal(single.astype(np.float64), values) else values
