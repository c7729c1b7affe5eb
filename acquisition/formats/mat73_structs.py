# SPDX-License-Identifier: MIT
"""Structs and arrays of MAT files of version 7.3, which are HDF5, as dictionaries.

A struct is a group, an array of structs a dataset of references, a text an array of
character codes, a complex number a pair "real", "imag". The guards look at all of it
before a value is read.

Source:
    MathWorks, MAT-File Versions; the layout is as `save -v7.3` writes it.
"""

from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.errors import FormatError, HostileFile
from jointbench.acquisition.file_access.hdf5_guards import FileLimits, open_guarded
from jointbench.acquisition.file_access.quoting import named, shown

_DEEPEST = 12
_MOST_ITEMS = 100_000
_LIMITS = FileLimits(matlab=True, objects=_MOST_ITEMS)
_DAMAGE = (OSError, KeyError, ValueError, TypeError, RuntimeError, IndexError)


def read_mat73(path: Path) -> dict[str, Any]:
    """Return the variables of a MAT file of version 7.3; see `read_mat5`.

    Raises:
        FormatError: it is damaged.
        HostileFile: it points elsewhere, or asks for more than a measurement would.
    """
    try:
        with open_guarded(path, limits=_LIMITS) as file:
            reader = _Reader(path, file)
            return {
                name: reader.value(file[name], 0)
                for name in file
                if not name.startswith("#")
            }
    except _DAMAGE as error:  # closing a damaged file may fail as well
        raise FormatError(
            f"{named(path)} is damaged inside ({shown(error)}); save it again"
        ) from error


class _Reader:
    """Reads values once: references may lead to one array many times."""

    def __init__(self, path: Path, file: h5py.File) -> None:
        self._path, self._file, self._count = path, file, 0
        self._known: dict[int, Any] = {}

    def value(self, item: h5py.Group | h5py.Dataset, depth: int) -> Any:
        """Return one value, and what it holds."""
        self._count += 1
        if depth > _DEEPEST or self._count > _MOST_ITEMS:
            raise HostileFile(
                f"{named(self._path)} is nested {depth} deep with {self._count} values,"
                f" at most {_DEEPEST} and {_MOST_ITEMS} are read; save the FRFs alone"
            )
        if isinstance(item, h5py.Group):
            return {name: self.value(item[name], depth + 1) for name in item}
        if h5py.check_ref_dtype(item.dtype) is not None:
            references = np.atleast_1d(item[()]).ravel()
            found = [
                self.value(self._file[one], depth + 1) for one in references if one
            ]
            return found[0] if len(found) == 1 else found
        if item.attrs.get("MATLAB_empty"):
            return np.zeros(0)
        address = int(h5py.h5o.get_info(item.id).addr)
        if address not in self._known:
            self._known[address] = _numbers(item)
        return self._known[address]


def _numbers(item: h5py.Dataset) -> str | NDArray[Any]:
    """Return a text, or numbers with the axes as MATLAB shows them."""
    values = item[()]
    kind = item.attrs.get("MATLAB_class", b"")
    if kind in (b"char", "char") and values.dtype.kind == "u":
        return "".join(map(chr, np.ravel(values)))
    if values.dtype.names == ("real", "imag"):
        values = values["real"] + 1j * values["imag"]
    return np.asarray(values).T
