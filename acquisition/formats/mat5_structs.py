# SPDX-License-Identifier: MIT
"""Structs and arrays of MAT files up to version 7, as plain nested dictionaries.

SciPy's reader of structs is not used: on damaged bytes it reads beyond its buffers and
ends the process. Here every size is compared with the bytes that are there.

Source:
    MathWorks, MAT-File Format (level 5), "Data Elements", "Structures", "Cell Arrays".
"""

import math
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from jointbench.acquisition.basics.errors import FormatError, HostileFile
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.file_access.text_files import file_size
from jointbench.acquisition.formats.mat_file import require_sane_mat

_HEADER, _TAG = 128, 8
_COMPRESSED, _MATRIX = 15, 14
_CELL, _STRUCT, _CHAR = 1, 2, 4
_NUMERIC = range(6, 16)
_COMPLEX_FLAG = 0x0800
_KINDS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8"} | {
    12: "i8",
    13: "u8",
}
_ENCODINGS = {16: "utf-8", 17: "utf-16", 4: "utf-16"}
_DEEPEST = 12
_MOST_BYTES = 512 * 2**20
_DAMAGE = (struct.error, ValueError, IndexError, KeyError, zlib.error)
Element = tuple[int, int, int]


def read_mat5(path: Path) -> dict[str, Any]:
    """Return the variables of a MAT file: numbers, texts, structs, lists of these.

    Args:
        path: of a file of MATLAB 7 or older.

    Returns:
        Arrays, strings, dictionaries for structs and lists for arrays of structs and
        cells. Functions, objects and sparse matrices are left out.

    Raises:
        FormatError: it is damaged.
        HostileFile: it is nested deeper, or unfolds further, than any measurement.
    """
    require_sane_mat(path)
    found: dict[str, Any] = {}
    try:
        for body, order in _bodies(path):
            name, value = _matrix(path, body, (0, len(body)), order, 0)
            if value is not None:
                found[name] = value
    except _DAMAGE as error:
        raise FormatError(
            f"{named(path)} cannot be read as a MAT file ({shown(error)}); save it "
            "again with -v7"
        ) from error
    return found


def _bodies(path: Path) -> Iterator[tuple[bytes, str]]:
    """Yield the bytes of each variable, unpacked, and the order of its bytes."""
    with path.open("rb") as file:
        order = {b"IM": "<", b"MI": ">"}.get(file.read(_HEADER)[126:128])
        if order is None and not file_size(path):
            raise FormatError(f"{named(path)} is empty; export it again")
        if order is None:
            raise ValueError("its header names no order of bytes")
        while len(tag := file.read(_TAG)) == _TAG:
            kind, size = struct.unpack(f"{order}II", tag)
            body = file.read(size)
            if kind == _COMPRESSED:
                body = zlib.decompressobj().decompress(body, _MOST_BYTES)
                kind, size = struct.unpack(f"{order}II", body[:_TAG])
                body = body[_TAG : _TAG + size]
            if kind == _MATRIX:
                yield body, order


def _matrix(
    path: Path, body: bytes, span: tuple[int, int], order: str, depth: int
) -> tuple[str, Any]:
    """Return name and value of a matrix element; None for what is not read."""
    if depth > _DEEPEST:
        raise HostileFile(
            f"{named(path)} is nested more than {_DEEPEST} deep; save the FRFs alone"
        )
    if span[0] == span[1]:
        return "", np.zeros(0)
    parts = list(_elements(body, span, order))
    flags = struct.unpack_from(f"{order}I", body, parts[0][1])[0]
    shape = tuple(_numbers(body, parts[1], order).astype(int).tolist())
    name = body[parts[2][1] : parts[2][2]].decode("latin-1")
    kind, count = flags & 0xFF, math.prod(shape)
    if kind in _NUMERIC:
        array = _numbers(body, parts[3], order)
        if flags & _COMPLEX_FLAG:
            array = array + 1j * _numbers(body, parts[4], order)
        return name, array.reshape(shape, order="F")
    if kind == _CHAR:
        return name, _text(body, parts[3], order)
    if kind not in (_STRUCT, _CELL):
        return name, None
    fields = [""] if kind == _CELL else _fields(body, parts, order)
    inner = [p for p in parts[3 if kind == _CELL else 5 :] if p[0] == _MATRIX]
    if count * len(fields) != len(inner):
        raise ValueError(f"{count} x {len(fields)} values claimed, {len(inner)} there")
    values = [_matrix(path, body, p[1:], order, depth + 1)[1] for p in inner]
    if kind == _CELL:
        return name, values[0] if len(values) == 1 else values
    width = len(fields)
    rows = [values[i : i + width] for i in range(0, len(values), width)]
    structs = [dict(zip(fields, row, strict=True)) for row in rows]
    return name, structs[0] if len(structs) == 1 else structs


def _fields(body: bytes, parts: list[Element], order: str) -> list[str]:
    """Return the names of the fields of a struct."""
    width = int(_numbers(body, parts[3], order)[0])
    names = body[parts[4][1] : parts[4][2]]
    if width < 1:
        raise ValueError("names of fields without length")
    cut = [names[i : i + width] for i in range(0, len(names), width)]
    return [one.split(b"\0")[0].decode("latin-1") for one in cut]


def _numbers(body: bytes, part: Element, order: str) -> NDArray[Any]:
    kind, first, last = part
    number = np.dtype(order + _KINDS[kind])
    return np.frombuffer(body[first:last], number).astype(np.float64)


def _text(body: bytes, part: Element, order: str) -> str:
    kind, first, last = part
    encoding = _ENCODINGS.get(kind, "latin-1")
    if encoding == "utf-16":
        encoding += "-le" if order == "<" else "-be"
    return body[first:last].decode(encoding, "replace")


def _elements(body: bytes, span: tuple[int, int], order: str) -> Iterator[Element]:
    """Yield kind, first and past byte of the data of each element in a row."""
    place, end = span
    while place + _TAG <= end:
        kind, size = struct.unpack_from(f"{order}II", body, place)
        first = place + _TAG
        if kind >> 16:  # four bytes or fewer, in the tag itself
            kind, size, first = kind & 0xFFFF, kind >> 16, place + 4
        if first + size > end:
            raise ValueError(f"an element claims {size} bytes, {end - first} are left")
        yield kind, first, first + size
        place = max(place + _TAG, (first + size + 7) // 8 * 8)
