# SPDX-License-Identifier: MIT
"""Numbers, arrays and groups of HDF5 files, each checked, with one line if wrong."""

from typing import Any

import h5py
import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, FormatError
from jointbench.acquisition.file_access.netcdf_read import read_array
from jointbench.acquisition.file_access.quoting import shown


def require_group(place: str, parent: h5py.Group, name: str) -> h5py.Group:
    """Return a group of a file.

    Raises:
        FormatError: there is none of that name.
    """
    found = parent.get(name)
    if not isinstance(found, h5py.Group):
        raise FormatError(
            f"{place} has no group {name!r}; give a complete campaign file"
        )
    return found


def finite_number(place: str, name: str, value: Any) -> float:
    """Return a value as a finite number.

    Raises:
        FormatError: it is missing, no number, or not finite.
    """
    if value is None or isinstance(value, bool):
        raise FormatError(
            f"{place} lacks {name!r}, one number is required; "
            "give a complete campaign file"
        )
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise FormatError(
            f"{place} has {name!r} of {shown(value)}, a number is required; "
            "write it without a unit"
        ) from error
    if not np.isfinite(number):
        raise FormatError(
            f"{place} has {name!r} of {number:g}, it must be finite; "
            "write the right one"
        )
    return number


def positive_number(place: str, name: str, value: Any) -> float:
    """Return a value as a finite number above zero.

    Raises:
        FormatError: it is not.
    """
    number = finite_number(place, name, value)
    if number <= 0:
        raise FormatError(
            f"{place} has {name!r} of {number:g}, it must be above zero; "
            "write the right one"
        )
    return number


def finite_array(
    place: str,
    group: h5py.Group,
    name: str,
    shape: tuple[int, ...] | None = None,
) -> FloatArray:
    """Return a dataset as finite numbers.

    Args:
        place: of the group, for messages.
        group: that holds it.
        name: of the dataset.
        shape: that it must have, or None for any.

    Raises:
        FormatError: it is missing, has no numbers, or another shape.
        BadData: a number is not finite.
    """
    found = group.get(name)
    if not isinstance(found, h5py.Dataset) or found.dtype.kind not in "iuf":
        raise FormatError(
            f"{place} has no dataset {name!r} of numbers; give a complete campaign file"
        )
    if shape is not None and found.shape != shape:
        raise FormatError(
            f"{place} has {name!r} of shape {found.shape}, {shape} is required; "
            "store one row for each point and one column for each mode"
        )
    values = read_array(found)
    if not np.all(np.isfinite(values)):
        raise BadData(
            f"{place} has NaN or infinite numbers in {name!r}; leave it out or record "
            "it again"
        )
    return values
