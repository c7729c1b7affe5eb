# SPDX-License-Identifier: MIT
"""HDF5 that netCDF-4 readers understand: dimension scales, units, flags, plain text.

Both the session file and the results file beside it are written through these
helpers. They keep to what every reader has: no compound types, no variable-length
data, no plug-in filters; complex numbers are two real variables, texts are character
arrays with an `_Encoding`, and an even axis is whole numbers with `scale_factor` and
`add_offset`, which readers that know CF turn into seconds or metres by themselves.

Source:
    netCDF-4 file format specification (Unidata), HDF5 dimension scales;
    CF conventions 1.11, sections 2.2 (text), 3.5 (flags), 8.1 (packed data).
"""

import math
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray
from jointbench.acquisition.basics.errors import BadData, ShapeError, UsageError
from jointbench.acquisition.file_access.text_files import named, shown

_CONVENTIONS = "CF-1.11"
# What netCDF-4 calls a dimension that has no coordinate variable.
NO_VARIABLE = "This is a netCDF dimension but not a netCDF variable."
_MAX_ATTRIBUTE_BYTES = 60_000  # HDF5 keeps at most 64 KiB beside an object
_GROWTH = 2**22  # bytes by which a file in memory grows
_IN_MEMORY: dict[str, Any] = {
    "driver": "core",
    "backing_store": False,
    "block_size": _GROWTH,
}
CHUNK_VALUES = 65_536
"""Values of a chunk; what is written piece by piece is written by so many columns."""
_COMPRESS_FROM = 256  # values; below, a chunk costs more than it saves

Attribute = str | int | float | bool


@contextmanager
def new_file(
    path: Path | str,
    *,
    schema: str,
    title: str,
    overwrite: bool = False,
    memory: bool = True,
) -> Iterator[h5py.File]:
    """Write a file that appears under its name only once it is whole.

    It is written to ``<name>.part`` beside it, forced to the disk and renamed.

    Args:
        path: of the file to be.
        schema: name and version of the layout, for example ``"jointbench-session/1"``.
        title: one line for people who open it elsewhere.
        overwrite: replace a file that is there.
        memory: make the whole file in memory first; whoever writes more than that
            holds writes to the disk, and sees to it that there is room (`DiskRoom`).

    Yields:
        The open file, with its root attributes set.

    Raises:
        UsageError: there is such a file and `overwrite` is off, or it cannot be
            written there.
    """
    path = Path(path)
    _require_free(path, overwrite)
    part = path.with_name(path.name + ".part")
    try:
        part.write_bytes(b"")  # a folder that takes no file says so before the work
        # HDF5 that meets a full disk crashes the process when it ends: it writes to
        # memory, and what it made goes to the disk in one piece.
        with h5py.File(part, "w", **(_IN_MEMORY if memory else {})) as file:
            attributes = {"Conventions": _CONVENTIONS, "title": title, "schema": schema}
            write_attributes(file, attributes)
            yield file
            file.flush()
            image = file.id.get_file_image() if memory else None
        if image is not None:
            part.write_bytes(image)
        _sync(part)
        _require_free(path, overwrite)
        part.replace(path)
        _sync(path.parent)
    except OSError as error:
        raise UsageError(
            f"{named(path)} cannot be written: {_reason(error)}; choose another place"
        ) from error
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)


def write_attributes(
    target: h5py.Group | h5py.Dataset, values: Mapping[str, Attribute | None]
) -> None:
    """Set attributes; texts get a fixed length, None is left out.

    Raises:
        BadData: a text cannot be stored without loss.
    """
    for name, value in values.items():
        if isinstance(value, str):
            data = _encode(value, name)
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
        units: SI unit, for example ``"m/s2"``; None where there is none to state.
        long_name: what it is, in words.
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
        long_name: what it is, in words.
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
    """Write an even axis as whole numbers, which costs next to nothing.

    Args:
        group: where.
        name: of the axis: dimension and coordinate at once.
        size: number of points.
        step: distance of neighbours [units].
        origin: value at index 0 [units].
        units: of `step` and `origin`.
        long_name: what it is, in words.
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


def write_flags(
    group: h5py.Group,
    name: str,
    codes: Any,
    dims: Sequence[str],
    *,
    meanings: Sequence[str],
    long_name: str,
) -> h5py.Dataset:
    """Write small whole numbers that each stand for a word (CF flags).

    Args:
        group: where.
        name: of the variable.
        codes: index into `meanings`, any shape.
        dims: one name for each axis.
        meanings: words without blanks, by code.
        long_name: what it is, in words.
    """
    values = np.asarray(codes, dtype=np.int8)
    dataset = write_variable(group, name, values, dims, long_name=long_name)
    dataset.attrs.create("flag_values", np.arange(len(meanings), dtype=np.int8))
    write_attributes(dataset, {"flag_meanings": " ".join(meanings)})
    return dataset


def write_texts(
    group: h5py.Group, name: str, texts: Sequence[str], dim: str, *, long_name: str
) -> h5py.Dataset:
    """Write one text for each index of a dimension, as UTF-8 characters.

    Raises:
        BadData: a text cannot be stored without loss.
        ShapeError: there are no texts.
    """
    coded = [_encode(text, name) for text in texts]
    width = max([1, *map(len, coded)])
    table = np.array(coded, dtype=f"S{width}").view("S1").reshape(len(coded), width)
    return write_variable(
        group,
        name,
        table,
        (dim, f"{name}_length"),
        long_name=long_name,
        attributes={"_Encoding": "utf-8"},
    )


def write_complex(
    group: h5py.Group,
    name: str,
    values: ComplexArray,
    dims: Sequence[str],
    *,
    units: str | None = None,
    long_name: str = "",
) -> None:
    """Write complex numbers as two variables, `name`_re and `name`_im."""
    for suffix, part in (("re", np.real(values)), ("im", np.imag(values))):
        words = (
            f"{'real' if suffix == 're' else 'imaginary'} part of {long_name or name}"
        )
        write_variable(
            group, f"{name}_{suffix}", part, dims, units=units, long_name=words
        )


def _encode(text: str, name: str) -> bytes:
    """Return UTF-8 without what a fixed-length text would lose."""
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


def _require_free(path: Path, overwrite: bool) -> None:
    if path.is_dir():
        raise UsageError(f"{named(path)} is a folder; name a file in it")
    if path.exists() and not path.is_file():
        raise UsageError(f"{named(path)} is no file; name one that may be written")
    if not overwrite and path.exists():
        raise UsageError(
            f"{named(path)} is there already; choose another name, or say that it may "
            "be overwritten"
        )


def _reason(error: OSError) -> str:
    """Return the system's word for an error, without HDF5's account of itself."""
    told = re.search(r"errno = (\d+)", str(error))
    code = error.errno or (int(told[1]) if told else 0)
    return os.strerror(code) if code else "the system refused"


def _sync(path: Path) -> None:
    """Force a file, or the entries of a folder where the system can, to the disk."""
    try:
        handle = os.open(path, os.O_RDONLY)
    except OSError:
        if path.is_dir():  # not on Windows
            return
        raise
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
