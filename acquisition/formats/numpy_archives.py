# SPDX-License-Identifier: MIT
"""Arrays of NumPy files: .npz archives and .npy arrays, never objects.

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
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.errors import FormatError, HostileFile
from jointbench.acquisition.file_access.memory_room import require_room
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.file_access.text_files import file_size
from jointbench.acquisition.formats.tables import read_head

ZIP_MAGIC, NPY_MAGIC = b"PK\x03\x04", b"\x93NUMPY"
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


def is_numpy_archive(path: Path) -> bool:
    """Return whether a file is a .npz archive, by its ending and its first bytes.

    Raises:
        BadData: it cannot be opened.
    """
    return path.suffix.lower() == ".npz" and read_head(path, 4) == ZIP_MAGIC


def read_numpy_array(path: Path) -> NDArray[Any]:
    """Return the array of a .npy file.

    Raises:
        FormatError: it is damaged, or holds objects.
    """
    require_room(path, _NEEDED * file_size(path))
    return _parsed(path, path.name, path.read_bytes())


def read_numpy_archive(path: Path) -> dict[str, NDArray[Any]]:
    """Read all arrays of an archive, none of them larger than its entry.

    Raises:
        FormatError: it is damaged, or holds objects.
        HostileFile: it claims more than a measurement would hold.
    """
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


def read_array_header(file: BinaryIO) -> tuple[tuple[int, ...], np.dtype[Any]]:
    """Return shape and type of the array of a .npy file; leaves it at the values.

    Raises:
        ValueError: it is no such file, or its header is damaged; as well as what
            Python raises for a header that is no literal.
    """
    version = np.lib.format.read_magic(file)
    read = (
        np.lib.format.read_array_header_1_0
        if version == (1, 0)
        else np.lib.format.read_array_header_2_0
    )
    shape, _, kind = read(file)
    return shape, kind


def _parsed(path: Path, name: str, data: bytes) -> NDArray[Any]:
    """Return the array of the bytes of a .npy file, its header compared with them."""
    where = named(path) if name == path.name else f"{named(path)}: {shown(name)}"
    file = io.BytesIO(data)
    try:
        shape, kind = read_array_header(file)
        held = len(data) - file.tell()
        if kind.hasobject:
            raise FormatError(
                f"{where} holds Python objects, which are never "
                "read because that runs code; save numbers"
            )
        if math.prod(shape) * kind.itemsize != held:
            raise FormatError(
                f"{where} claims the shape {shape}, {held} bytes "
                "are there; it is cut short: use another copy"
            )
        file.seek(0)
        return np.asarray(np.lib.format.read_array(file, allow_pickle=False))
    except _DAMAGE as error:
        raise FormatError(
            f"{where} is no whole array ({shown(error)}); use another copy"
        ) from error
