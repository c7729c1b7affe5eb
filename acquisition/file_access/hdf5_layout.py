# SPDX-License-Identifier: MIT
"""Groups of an open HDF5 file, and the axes of its datasets."""

import h5py
from h5py import h5ds, h5i, h5o

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


def dimension_names(
    dataset: h5py.Dataset, known: dict[int, str] | None = None
) -> tuple[str, ...]:
    """Return the name of each axis, empty where it has none.

    Args:
        dataset: of an open file.
        known: names by address of the scale, for many datasets of that file; those that
            are looked up are added.
    """
    names = {} if known is None else known
    found = [_first_scale(dataset.id, axis, names) for axis in range(dataset.id.rank)]
    if found == [""] and h5ds.is_scale(dataset.id):
        return (_last_part(dataset.id, names),)
    return tuple(found)


def _first_scale(dataset: h5py.h5d.DatasetID, axis: int, known: dict[int, str]) -> str:
    """Return the name of the first scale of an axis, empty without one.

    Without the objects that `Dataset.dims` makes for each axis and scale: a result has
    hundreds of axes, and all are named when its digest is computed.
    """
    if h5ds.get_num_scales(dataset, axis) < 1:
        return ""
    return _last_part(h5ds.iterate(dataset, axis, lambda scale: scale), known)


def _last_part(place: h5py.h5d.DatasetID, known: dict[int, str]) -> str:
    """Return the last part of the path of a dataset; "None" if it has none.

    For the path HDF5 searches the file, and few scales serve all axes.
    """
    address = int(h5o.get_info(place).addr)
    if address not in known:
        path = h5i.get_name(place) or b"None"
        known[address] = path.decode("utf-8", "surrogateescape").rsplit("/", 1)[-1]
    return known[address]


def is_dimension_only(dataset: h5py.Dataset) -> bool:
    """Return whether a dataset is a dimension without values."""
    label = dataset.attrs.get("NAME", b"")
    text = label.decode("utf-8", "ignore") if isinstance(label, bytes) else str(label)
    return bool(dataset.is_scale) and text.startswith(NO_VARIABLE)
