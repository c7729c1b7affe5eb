# SPDX-License-Identifier: MIT
"""FRFs from NumPy files: .npz archives of named arrays, and complex .npy arrays.

An archive that SDynPy saved names its functions itself; see `nodal_arrays`.

An archive is a zip: a few bytes may claim gigabytes, and an array may hold pickled
objects, which run code. So sizes are compared with what is there before an array is
made, and objects are refused.
"""

import io
import math
import tokenize
import zipfile
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.errors import (
    BadData,
    FormatError,
    HostileFile,
    UnitError,
)
from jointbench.acquisition.file_access.memory_room import require_room
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.file_access.text_files import file_size
from jointbench.acquisition.formats.frfs.frf_arrays import (
    frfs_of_arrays,
    no_units_words,
)
from jointbench.acquisition.formats.frfs.frf_columns import names_frequency, names_frfs
from jointbench.acquisition.formats.frfs.frf_format import FrfFormat, FrfOptions
from jointbench.acquisition.formats.frfs.nodal_arrays import nodal_arrays, nodal_frfs
from jointbench.acquisition.formats.tables import read_head
from jointbench.acquisition.records.frf_functions import FrfFunction

_ZIP, _NPY = b"PK\x03\x04", b"\x93NUMPY"
_SUFFIX = ".npy"
_MOST_ARRAYS = 100
_MOST_BYTES = 2**30
_NEEDED = 4.0
"""Of each byte of an array: as it is stored, as it is read, and in its unit [-]."""
_DAMAGE = (
    *(ValueError, EOFError, OSError, OverflowError, TypeError),
    *(SyntaxError, tokenize.TokenError, RecursionError),  # of a header in Python
)
_ZIP_DAMAGE = (zipfile.BadZipFile, NotImplementedError, RuntimeError, zlib.error)


def recognise_numpy_frfs(path: Path, options: FrfOptions) -> bool:
    """Return whether a file is an archive of arrays, or one complex array."""
    try:
        head = read_head(path, 200)
    except BadData:
        return False
    if head.startswith(_ZIP):
        return path.suffix.lower() == ".npz"
    # A type of complex numbers in the header: hits and heights are real.
    kinds = (b"<c", b">c", b"|O") if names_frfs(options.columns) else (b"<c", b">c")
    return head.startswith(_NPY) and any(kind in head for kind in kinds)


def read_numpy_frfs(path: Path, options: FrfOptions) -> tuple[FrfFunction, ...]:
    """Read the FRFs of a NumPy file; see `frfs_of_arrays` and `nodal_frfs`.

    Raises:
        UnitError: `columns` is missing; the message lists the arrays.
        FormatError: it is damaged, or holds objects.
        HostileFile: it claims more than a measurement would hold.
        BadData: see `frfs_of_arrays`.
    """
    file_size(path)
    archive = read_head(path, 4) == _ZIP
    arrays = _archive(path) if archive else {"frf": _single(path)}
    nodal = None if names_frequency(options.columns) else nodal_arrays(arrays)
    if nodal is not None:
        return nodal_frfs(path, nodal, options, "npz of SDynPy")
    if not names_frfs(options.columns):
        raise UnitError(no_units_words(path, list(arrays)))
    return frfs_of_arrays(path, arrays, options, "npz" if archive else "npy")


def _single(path: Path) -> NDArray[Any]:
    require_room(path, _NEEDED * file_size(path))
    return _parsed(path, path.name, path.read_bytes())


def _archive(path: Path) -> dict[str, NDArray[Any]]:
    """Read all arrays of an archive, none of them larger than its entry."""
    try:
        with zipfile.ZipFile(path) as archive:
            entries = [i for i in archive.infolist() if i.filename.endswith(_SUFFIX)]
            total = sum(entry.file_size for entry in entries)
            if len(entries) > _MOST_ARRAYS or total > _MOST_BYTES:
                raise HostileFile(
                    f"{named(path)} claims {len(entries)} arrays of {total} bytes, at "
                    f"most {_MOST_ARRAYS} and {_MOST_BYTES} are read; split it"
                )
            require_room(path, _NEEDED * total)
            return {
                entry.filename.removesuffix(_SUFFIX): _parsed(
                    path, entry.filename, archive.read(entry)
                )
                for entry in entries
            }
    except (*_DAMAGE, *_ZIP_DAMAGE) as error:
        raise FormatError(
            f"{named(path)} is no whole .npz archive ({shown(error)}); use another copy"
        ) from error


def _parsed(path: Path, name: str, data: bytes) -> NDArray[Any]:
    """Return the array of the bytes of a .npy file, its header compared with them."""
    file = io.BytesIO(data)
    try:
        version = np.lib.format.read_magic(file)
        read = (
            np.lib.format.read_array_header_1_0
            if version == (1, 0)
            else np.lib.format.read_array_header_2_0
        )
        shape, _, kind = read(file)
        held = len(data) - file.tell()
        if kind.hasobject:
            raise FormatError(
                f"{named(path)}: {shown(name)} holds Python objects, which are never "
                "read because that runs code; save numbers"
            )
        if math.prod(shape) * kind.itemsize != held:
            raise FormatError(
                f"{named(path)}: {shown(name)} claims the shape {shape}, {held} bytes "
                "are there; it is cut short: use another copy"
            )
        file.seek(0)
        return np.asarray(np.lib.format.read_array(file, allow_pickle=False))
    except _DAMAGE as error:
        raise FormatError(
            f"{named(path)}: {shown(name)} is no whole array ({shown(error)}); use "
            "another copy"
        ) from error


FORMAT = FrfFormat("numpy_frfs", recognise_numpy_frfs, read_numpy_frfs)
