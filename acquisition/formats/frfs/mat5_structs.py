# SPDX-License-Identifier: MIT
"""Structs and arrays of MAT files up to version 7, as plain nested dictionaries.

SciPy unfolds structs by recursion in compiled code, so that a file of a few kilobytes
nested deep enough would end the process: depth and sizes are looked at before.

Source:
    MathWorks, MAT-File Format (level 5), "Data Elements" and "Structures".
"""

import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from jointbench.acquisition.basics.errors import FormatError, HostileFile
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.formats.samples.mat_file import (
    mat_damage,
    require_sane_mat,
)

_HEADER, _TAG = 128, 8
_COMPRESSED, _MATRIX = 15, 14
_CELL, _STRUCT = 1, 2
_DEEPEST = 12
_MOST_ELEMENTS = 200_000


def read_mat5(path: Path) -> dict[str, Any]:
    """Return the variables of a MAT file: numbers, texts, structs, lists of these.

    Args:
        path: of a file of MATLAB 7 or older.

    Returns:
        Arrays, strings, dictionaries for structs and lists for arrays of structs and
        cells. Functions and objects are left out.

    Raises:
        FormatError: it is damaged.
        HostileFile: it is nested deeper, or unfolds further, than any measurement.
    """
    import scipy.io

    require_sane_mat(path)
    _require_shallow(path)
    try:
        content = scipy.io.loadmat(path, appendmat=False)
        return {
            name: _plain(value)
            for name, value in content.items()
            if not name.startswith("__")
        }
    except mat_damage() as error:
        raise FormatError(
            f"{named(path)} cannot be read as a MAT file ({shown(error)}); save it "
            "again with -v7"
        ) from error


def _plain(value: Any) -> Any:
    """Return a value of SciPy's reader without its wrappers."""
    array = np.asarray(value)
    if array.dtype.names:
        structs = [
            {name: _plain(one[name]) for name in array.dtype.names}
            for one in array.ravel()
        ]
        return structs[0] if len(structs) == 1 else structs
    if array.dtype.kind == "U":
        texts = [str(text) for text in array.ravel()]
        return texts[0] if len(texts) == 1 else texts
    if array.dtype.kind == "O":
        items = [_plain(item) for item in array.ravel()]
        return items[0] if len(items) == 1 else items
    return array


def _require_shallow(path: Path) -> None:
    """Walk over all elements without recursion; none may be nested too deep."""
    with path.open("rb") as file:
        order = {b"IM": "<", b"MI": ">"}.get(file.read(_HEADER)[126:128])
        while order is not None and len(tag := file.read(_TAG)) == _TAG:
            kind, size = struct.unpack(f"{order}II", tag)
            body = file.read(size)
            if kind == _COMPRESSED:
                try:
                    body = zlib.decompressobj().decompress(body)
                except zlib.error:
                    continue  # the reader will refuse it
                kind, size = struct.unpack(f"{order}II", body[:_TAG].ljust(_TAG))
                body = body[_TAG : _TAG + size]
            if kind == _MATRIX:
                _require_shallow_element(path, body, order)


def _require_shallow_element(path: Path, body: bytes, order: str) -> None:
    waiting, count = [(0, len(body), 0)], 0
    while waiting:
        begin, end, depth = waiting.pop()
        count += 1
        if depth > _DEEPEST or count > _MOST_ELEMENTS:
            raise HostileFile(
                f"{named(path)} is nested {depth} deep with {count} elements, at most "
                f"{_DEEPEST} and {_MOST_ELEMENTS} are read; save the FRFs alone"
            )
        parts = list(_elements(body, begin, end, order, most=3))
        kind = body[parts[0][1]] if parts and parts[0][2] > parts[0][1] else 0
        if kind < 256 and order == ">" and parts and parts[0][2] - parts[0][1] >= 4:
            kind = body[parts[0][1] + 3]
        if kind in (_CELL, _STRUCT, 3):
            after = parts[-1][2] if len(parts) == 3 else end
            waiting += [
                (first, last, depth + 1)
                for number, first, last in _elements(
                    body, _padded(begin, after), end, order
                )
                if number == _MATRIX
            ]


def _padded(begin: int, end: int) -> int:
    return begin + (end - begin + 7) // 8 * 8


def _elements(
    body: bytes, begin: int, end: int, order: str, most: int = _MOST_ELEMENTS
) -> Iterator[tuple[int, int, int]]:
    """Yield kind, first and past byte of the data of each element in a row."""
    place = begin
    while place + _TAG <= end and most > 0:
        kind, size = struct.unpack_from(f"{order}II", body, place)
        if kind >> 16:  # four bytes or fewer, in the tag itself
            yield kind & 0xFFFF, place + 4, place + 4 + min(4, kind >> 16)
            place += _TAG
        else:
            first = place + _TAG
            yield kind, first, min(first + size, end)
            place = _padded(place, first + size)
        most -= 1
