# SPDX-License-Identifier: MIT
"""Write HDF5 for netCDF-4 readers: dimension scales, units, even axes.

Both session and results files are written with these functions and those of
`netcdf_encodings` and `create_netcdf`. They use only what every reader supports: no
compound types, no variable-length data, no plug-in filters; complex numbers are two
real variables, texts are character arrays with an `_Encoding`, and an even axis is
whole numbers with `scale_factor` and `add_offset`, which readers with CF support
convert to seconds or metres.

Source:
    netCDF-4 file format specification (Unidata), HDF5 dimension scales;
    CF conventions 1.11, sections 2.2 (text), 3.5 (flags), 8.1 (packed data).
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import h5py
import numpy as np

from jointbench.acquisition.basics.errors import BadData, ShapeError
from jointbench.acquisition.file_access.quoting import shown

# Name in netCDF-4 of a dimension without a coordinate variable.
NO_VARIABLE = "This is a netCDF dimension but not a netCDF variable."
_MAX_ATTRIBUTE_BYTES = 60_000  # HDF5 stores at most 64 KiB in an object header
CHUNK_VALUES = 65_536
"""Values of a chunk; data in pieces are written in as many columns."""
_COMPRESS_FROM = 256  # values; below, a chunk costs more than it saves

Attribute = str | int | float | bool


def write_attributes(
    target: h5py.Group | h5py.Dataset, values: Mapping[str, Attribute | None]
) -> None:
    """Set attributes; texts get a fixed length, None is left out.

    Raises:
        BadData: a text cannot be stored without loss.
    """
    for name, value in values.items():
        if isinstance(value, str):
            data = encode_text(value, name)
            if len(data) > _MAX_ATTRIBUTE_BYTES:
                raise BadData(
                    f"{name!r} has {len(data)} bytes of text, at most "
                    f"{_MAX_ATTRIBUTE_BYTES} are stored; shorten it"
                )
            kind = h5py.string_dtype("utf-8", max(1, len(data)))
            target.attrs.create(name, np.array(data, dtype=kind), dtype=kind)
        elif isinstance(value, bool):
            target.attrs.create(name, np.int8(value))
        elif isinstance(value, int):
            target.attrs.create(name, np.int64(value))
        elif value is not None:
            target.attrs.create(name, np.float64(value))


def write_variable(
    group: h5py.Group,
    name: str,
    values: Any,
    dims: Sequence[str],
    *,
    units: str | None = None,
    long_name: str = "",
    attributes: Mapping[str, Attribute | None] | None = None,
) -> h5py.Dataset:
    """Write real numbers with named dimensions.

    A variable of one dimension that carries the name of that dimension is its
    coordinate. Write coordinates first; a dimension without one is made on the way.

    Args:
        group: where.
        name: of the variable.
        values: real numbers or small integers of any shape, none of it zero.
        dims: one name for each axis; looked up in `group` and the groups above it.
        units: SI unit, for example ``"m/s2"``; None without one.
        long_name: description.
        attributes: anything else.

    Returns:
        The dataset, gzip 1 with shuffle and a checksum where it is not tiny.

    Raises:
        ShapeError: the values do not fit the dimensions, or there are none.
    """
    array = np.asarray(values)
    dataset = make_variable(
        group,
        name,
        (array.shape, array.dtype),
        dims,
        units=units,
        long_name=long_name,
        attributes=attributes,
    )
    dataset[...] = array
    return dataset


def make_variable(
    group: h5py.Group,
    name: str,
    kind: tuple[tuple[int, ...], np.typing.DTypeLike],
    dims: Sequence[str],
    *,
    units: str | None = None,
    long_name: str = "",
    attributes: Mapping[str, Attribute | None] | None = None,
) -> h5py.Dataset:
    """Make a variable whose values are written later; otherwise as `write_variable`.

    Args:
        group: where.
        name: of the variable.
        kind: shape and type of the values.
        dims: one name for each axis.
        units: SI unit, or None.
        long_name: description.
        attributes: anything else.

    Raises:
        ShapeError: the shape does not fit the dimensions, or holds no values.
    """
    shape, dtype = kind
    if len(shape) != len(dims) or 0 in shape:
        raise ShapeError(f"{name!r} has shape {shape} for dimensions {dims}")
    options: dict[str, Any] = {}
    if math.prod(shape) >= _COMPRESS_FROM:
        options = {
            "chunks": _chunks(shape),
            "compression": "gzip",
            "compression_opts": 1,
            "shuffle": True,
            "fletcher32": True,
        }
    dataset = group.create_dataset(name, shape=shape, dtype=dtype, **options)
    _attach(group, dataset, dims)
    write_attributes(dataset, {"long_name": long_name or None, "units": units})
    write_attributes(dataset, attributes or {})
    return dataset


def write_axis(
    group: h5py.Group,
    name: str,
    size: int,
    *,
    step: float,
    origin: float = 0.0,
    units: str,
    long_name: str,
) -> h5py.Dataset:
    """Write an even axis as whole numbers, which compress well.

    Args:
        group: where.
        name: of the axis: dimension and coordinate at once.
        size: number of points.
        step: distance of neighbours [units].
        origin: value at index 0 [units].
        units: of `step` and `origin`.
        long_name: description.
    """
    packing = {"scale_factor": float(step), "add_offset": float(origin)}
    dataset = make_variable(
        group,
        name,
        ((size,), np.int32),
        (name,),
        units=units,
        long_name=long_name,
        attributes=packing,
    )
    for first in range(0, size, CHUNK_VALUES):
        past = min(first + CHUNK_VALUES, size)
        dataset[first:past] = np.arange(first, past, dtype=np.int32)
    return dataset


def encode_text(text: str, name: str) -> bytes:
    """Return UTF-8 that a fixed-length text stores without loss."""
    try:
        data = text.encode("utf-8")
    except UnicodeEncodeError as error:
        raise BadData(f"{name!r} is {shown(text)}, which is no Unicode text") from error
    if b"\x00" in data:
        raise BadData(f"{name!r} is {shown(text)}; a zero character cannot be stored")
    return data


def _attach(group: h5py.Group, dataset: h5py.Dataset, dims: Sequence[str]) -> None:
    if tuple(dims) == (str(dataset.name).rsplit("/", 1)[-1],):
        dataset.make_scale(dims[0])
        return
    for axis, (dim, size) in enumerate(zip(dims, dataset.shape, strict=True)):
        dataset.dims[axis].attach_scale(_scale(group, dim, size))


def _scale(group: h5py.Group, dim: str, size: int) -> h5py.Dataset:
    """Return the scale of a dimension from here upwards, made here if there is none."""
    place = group
    while True:
        found = place.get(dim)
        if isinstance(found, h5py.Dataset) and found.is_scale:
            if found.shape != (size,):
                raise ShapeError(
                    f"dimension {dim!r} has {found.shape[0]} points, got {size}"
                )
            return found
        if place.name == "/":
            break
        place = place.parent
    scale = group.create_dataset(dim, shape=(size,), dtype=">f4")
    scale.make_scale(f"{NO_VARIABLE}{size:10d}")
    return scale


def _chunks(shape: tuple[int, ...]) -> tuple[int, ...]:
    """Return chunks of whole last axes, about half a megabyte of doubles."""
    chunks = []
    left = CHUNK_VALUES
    for length in reversed(shape):
        chunks.append(max(1, min(length, left)))
        left //= max(1, length)
    return tuple(reversed(chunks))
