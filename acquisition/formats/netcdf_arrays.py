# SPDX-License-Identifier: MIT
"""Arrays with named axes and units, as xarray writes them into netCDF files.

Files of netCDF-4 are HDF5: the guards look at all of it before a value is read. Files
of netCDF-3 are read by SciPy, after their size is checked.
"""

import math
import re
import struct
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.errors import FormatError, HostileFile
from jointbench.acquisition.file_access.hdf5_guards import FileLimits, open_guarded
from jointbench.acquisition.file_access.memory_room import require_room
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.file_access.text_files import file_size
from jointbench.acquisition.formats.tables import read_head

NETCDF_SUFFIXES = (".nc", ".nc4", ".cdf")
_CLASSIC = (b"CDF\x01", b"CDF\x02", b"CDF\x05")
_MOST_TEXTS = 4096
_MOST_BYTES = 2**30
_LONGEST_TEXT = 1000
_NEEDED = 4.0
_LIMITS = FileLimits(variable_texts=_MOST_TEXTS, complex_pairs=True)
_PACKING = ("scale_factor", "add_offset", "_FillValue", "missing_value")
_POWER = re.compile(r"(?<![A-Za-z])([A-Za-z]+)\^?(-?\d)(?!\d)")
_WORDS = {
    "seconds": "s",
    "second": "s",
    "milliseconds": "ms",
    "microseconds": "us",
    "nanoseconds": "ns",
    "newton": "N",
    "hertz": "Hz",
    "hz": "Hz",
    "gravity": "g",
}


@dataclass(frozen=True, slots=True, eq=False)
class LabelledArray:
    """One variable of a netCDF file.

    Attributes:
        dims: names of its axes.
        values: numbers, or texts as Python strings.
        units: as stated, in the spelling of this project; empty if not stated.
        words: its long or standard name; empty if not stated.
    """

    dims: tuple[str, ...]
    values: NDArray[Any]
    units: str = ""
    words: str = ""


def read_labelled_arrays(path: Path) -> dict[str, LabelledArray]:
    """Return the variables of the root group of a netCDF file.

    Raises:
        FormatError: it is no netCDF file, or is damaged.
        HostileFile: it asks for more than a measurement would.
    """
    if read_head(path, 4) in _CLASSIC:
        return _classic(path)
    found: dict[str, LabelledArray] = {}
    try:
        with open_guarded(path, limits=_LIMITS) as file:
            for name, item in file.items():
                if isinstance(item, h5py.Dataset) and not _is_bare(item):
                    values = _values(path, name, item)
                    # Texts as tables of letters have an axis more than texts.
                    found[name] = LabelledArray(
                        tuple(_axes(item, name))[: values.ndim],
                        values,
                        plain_unit(_attribute(item, "units")),
                        _attribute(item, "long_name")
                        or _attribute(item, "standard_name"),
                    )
    except (OSError, KeyError, ValueError, TypeError, RuntimeError) as error:
        raise FormatError(
            f"{named(path)} is damaged inside ({shown(error)}); use another copy"
        ) from error
    return found


def plain_unit(text: str) -> str:
    """Return a unit in the spelling of this project.

    >>> plain_unit("m s-2"), plain_unit("seconds"), plain_unit("m/s**2")
    ('m/s^2', 's', 'm/s**2')
    """
    text = text.strip()
    if text.lower() in _WORDS:
        return _WORDS[text.lower()]
    parts = text.split()
    if len(parts) < 2 or not all(_POWER.fullmatch(p) or p.isalpha() for p in parts):
        return text
    above: list[str] = []
    below: list[str] = []
    for part in parts:
        match = _POWER.fullmatch(part)
        power = int(match[2]) if match else 1
        name = match[1] if match else part
        word = name if abs(power) == 1 else f"{name}^{abs(power)}"
        (above if power > 0 else below).append(word)
    return "/".join([" ".join(above) or "1", *below])


def _is_bare(item: h5py.Dataset) -> bool:
    """Return whether a dataset only marks an axis that has no coordinate."""
    name = item.attrs.get("NAME", b"")
    text = name.decode("utf-8", "replace") if isinstance(name, bytes) else str(name)
    return text.startswith("This is a netCDF dimension but not a netCDF variable")


def _axes(item: h5py.Dataset, name: str) -> list[str]:
    if item.ndim == 1 and item.attrs.get("CLASS") in (b"DIMENSION_SCALE",):
        return [name]
    found = []
    for number, axis in enumerate(item.dims):
        scales = list(axis.values())
        own = str(scales[0].name).rpartition("/")[2] if scales else f"axis {number}"
        found.append(own)
    return found


def _values(path: Path, name: str, item: h5py.Dataset) -> NDArray[Any]:
    if h5py.check_string_dtype(item.dtype) is None:
        values = item[()]
        if values.dtype.names is not None:
            real, imaginary = values.dtype.names
            values = values[real] + 1j * values[imaginary]
        return _unpacked(np.asarray(values), item.attrs)
    if item.dtype == np.dtype("S1") and item.ndim > 1:
        return _joined(path, name, item)
    if item.size is None or item.size > _MOST_TEXTS or item.ndim > 1:
        raise HostileFile(
            f"{named(path)}: {shown(name)} holds {item.size} texts in {item.ndim} "
            f"axes; at most {_MOST_TEXTS} in a row are read"
        )
    texts = []
    for index in np.ndindex(item.shape):
        value = item[index]
        text = value.decode("utf-8", "replace") if isinstance(value, bytes) else value
        if len(text) > _LONGEST_TEXT:
            raise HostileFile(f"{named(path)}: {shown(name)} holds {len(text)} signs")
        texts.append(text.strip("\0 "))
    return np.array(texts, dtype=str).reshape(item.shape)


def _joined(path: Path, name: str, item: h5py.Dataset) -> NDArray[Any]:
    """Return the texts of a table of characters, whose last axis runs along them."""
    count = math.prod(item.shape[:-1])
    if count > _MOST_TEXTS or item.shape[-1] > _LONGEST_TEXT:
        raise HostileFile(
            f"{named(path)}: {shown(name)} holds {count} texts of {item.shape[-1]} "
            f"letters; at most {_MOST_TEXTS} of {_LONGEST_TEXT} are read"
        )
    return _texts(item[()])


def _texts(letters: NDArray[Any]) -> NDArray[Any]:
    """Join letters along the last axis."""
    rows = letters.reshape(math.prod(letters.shape[:-1]), letters.shape[-1])
    texts = [b"".join(row).decode("utf-8", "replace").strip("\0 ") for row in rows]
    return np.array(texts, dtype=str).reshape(letters.shape[:-1])


def _unpacked(values: NDArray[Any], attributes: Mapping[str, Any]) -> NDArray[Any]:
    """Return the numbers that packed ones stand for; missing ones are NaN.

    Source:
        CF conventions 1.11, sections 2.5.1 and 8.1.
    """
    if values.dtype.kind not in "fiu":
        return values
    scale, offset = (attributes.get(n) for n in ("scale_factor", "add_offset"))
    gaps = [
        values == np.asarray(attributes[name]).ravel()[0]
        for name in ("_FillValue", "missing_value")
        if name in attributes
    ]
    missing = np.logical_or.reduce(gaps) if gaps else np.zeros(1, dtype=bool)
    if scale is not None or offset is not None or missing.any():
        values = values.astype(np.float64)
        values = values * (1.0 if scale is None else float(np.ravel(scale)[0]))
        values = values + (0.0 if offset is None else float(np.ravel(offset)[0]))
    return np.where(missing, np.nan, values) if missing.any() else values


def _attribute(item: h5py.Dataset, name: str) -> str:
    value = item.attrs.get(name, "")
    if isinstance(value, np.ndarray):
        value = value.ravel()[0] if value.size == 1 else ""
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


def _classic(path: Path) -> dict[str, LabelledArray]:
    """Read a netCDF-3 file; its reader raises whatever damage makes it raise."""
    from scipy.io import netcdf_file

    size = file_size(path)
    if size > _MOST_BYTES:
        raise HostileFile(f"{named(path)} has {size} bytes; cut it")
    require_room(path, _NEEDED * size)
    try:
        with netcdf_file(path, "r", mmap=False) as file:
            return {
                str(name): _classic_array(variable)
                for name, variable in file.variables.items()
            }
    except (
        *(ValueError, TypeError, KeyError, IndexError, OSError, AttributeError),
        *(OverflowError, MemoryError, RuntimeError, EOFError, struct.error),
        *(AssertionError, UnboundLocalError, ZeroDivisionError),
    ) as error:
        raise FormatError(
            f"{named(path)} cannot be read as netCDF ({shown(error)}); use another copy"
        ) from error


def _classic_array(variable: Any) -> LabelledArray:
    values = np.array(variable[...] if variable.shape else variable.getValue())
    dims = tuple(variable.dimensions)
    if values.dtype.kind == "S":
        values = _texts(np.atleast_1d(values))
        dims = dims[:-1]
    else:
        values = values.astype(values.dtype.newbyteorder("="))
        stated = {n: getattr(variable, n) for n in _PACKING if hasattr(variable, n)}
        values = _unpacked(values, stated)
    words = {name: getattr(variable, name, b"") for name in ("units", "long_name")}
    plain = {
        name: value.decode("utf-8", "replace") if isinstance(value, bytes) else ""
        for name, value in words.items()
    }
    return LabelledArray(dims, values, plain_unit(plain["units"]), plain["long_name"])


def complex_pairs(
    arrays: Mapping[str, LabelledArray],
) -> dict[str, LabelledArray]:
    """Join pairs ``name_re``, ``name_im`` (or ``real``, ``imag``) into complex arrays.

    Args:
        arrays: of a file, by name.

    Returns:
        The same arrays, pairs replaced by their sum.
    """
    found = dict(arrays)
    for ends in (("re", "im"), ("real", "imag"), ("r", "i")):
        for name in list(found):
            match = re.fullmatch(rf"(?:(.+)[_.])?{ends[0]}", name)
            other = name[: len(name) - len(ends[0])] + ends[1] if match else ""
            if not match or other not in found:
                continue
            one, two = found[name], found[other]
            if one.dims == two.dims and one.values.shape == two.values.shape:
                whole = np.asarray(one.values) + 1j * np.asarray(two.values)
                del found[name], found[other]
                found[match[1] or "frf"] = LabelledArray(
                    one.dims, whole, one.units, one.words
                )
    return found
