# SPDX-License-Identifier: MIT
"""Groups of an open HDF5 file, and the axes of its datasets."""

import h5py

from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.file_access.netcdf_write import NO_VARIABLE


def find_group(parent: h5py.Group, name: str) -> h5py.Group | None:
    """Return a group, or None if the name does not exist.

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
    """Return whether a dataset is a dimension without values."""
    label = dataset.attrs.get("NAME", b"")
    text = label.decode("utf-8", "ignore") if isinstance(label, bytes) else str(label)
    return bool(dataset.is_scale) and text.startswith(NO_VARIABLE)
