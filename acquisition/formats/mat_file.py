# SPDX-License-Identifier: MIT
"""Read foreign MATLAB files: named rows of real numbers only.

A MAT file may hold objects, functions and nested structures, and claim gigabytes in a
few bytes. So the list of variables is read first, without their values; only the
requested ones are read, and only if they are plain numbers of a plausible size.
"""

import math
import struct
import zlib
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, FormatError, HostileFile
from jointbench.acquisition.file_access.memory_room import require_room
from jointbench.acquisition.file_access.quoting import named, shown
from jointbench.acquisition.file_access.text_files import file_size

_NUMERIC = frozenset(
    f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)
) | {"double", "single"}
_MOST_SAMPLES = 20_000_000
_MOST_BYTES = 512 * 2**20
_MOST_VARIABLES = 1000
_NEEDED = 24
"""Of each number: as it is stored, as a double, and in its unit [bytes]."""
_HEADER = 128
_COMPRESSED = 15
_PIECE = 2**20


def read_mat_rows(path: Path | str, names: Sequence[str]) -> tuple[FloatArray, ...]:
    """Read variables of a MAT file, each a row or a column of real numbers.

    Args:
        path: of a file of MATLAB 7 or older (``save -v7``).
        names: of the variables.

    Returns:
        One array per name, shape (n,), finite, in the order of `names`.

    Raises:
        BadData: it cannot be opened, or a value is not finite.
        FormatError: it is no such file, lacks a variable, or holds something other than
            a row of numbers.
        HostileFile: it claims more than a measurement can hold.
    """
    path = Path(path)
    require_sane_mat(path)
    found = _contents(path)
    for name in names:
        _check(path, name, found)
    require_room(path, _NEEDED * sum(math.prod(found[name][0]) for name in names))
    values = _load(path, names)
    return tuple(
        _row(path, name, value) for name, value in zip(names, values, strict=True)
    )


def list_mat_variables(path: Path | str) -> tuple[str, ...]:
    """Return the names of the variables of a MAT file, none of them read.

    Raises:
        BadData: see `read_mat_rows`.
    """
    path = Path(path)
    require_sane_mat(path)
    return tuple(_contents(path))


def require_sane_mat(path: Path) -> None:
    """Refuse a file that is no MAT file up to version 7, or unfolds into gigabytes.

    Raises:
        BadData: see `read_mat_rows`.
    """
    _require_mat(path)
    _require_sane_unpacked(path)


def _require_mat(path: Path) -> None:
    size = file_size(path)
    if size > _MOST_BYTES:
        raise HostileFile(
            f"{named(path)} has {size} bytes, at most {_MOST_BYTES} are read; cut it"
        )
    try:
        with path.open("rb") as file:
            head = file.read(128)
    except OSError as error:
        raise BadData(f"{named(path)} cannot be read: {error.strerror}") from error
    if head.startswith((b"\x89HDF", b"MATLAB 7.3")):
        raise FormatError(
            f"{named(path)} is a MATLAB 7.3 file; save it again with -v7 for jointbench"
        )


def _require_sane_unpacked(path: Path) -> None:
    """Check that no variable is truncated, or unpacks to gigabytes."""
    with path.open("rb") as file:
        order = {b"IM": "<", b"MI": ">"}.get(file.read(_HEADER)[126:128])
        total = count = 0
        while order is not None and len(tag := file.read(8)) == 8:
            kind, size = struct.unpack(f"{order}II", tag)
            count += 1
            if count > _MOST_VARIABLES:
                raise HostileFile(
                    f"{named(path)} holds more than {_MOST_VARIABLES} variables; save "
                    "those that are wanted"
                )
            packed = file.read(min(size, _MOST_BYTES))
            if len(packed) < min(size, _MOST_BYTES):
                raise FormatError(
                    f"{named(path)}: a variable claims {size} bytes, {len(packed)} are "
                    "left; it is cut short: use another copy"
                )
            if kind == _COMPRESSED:
                total += _unpacked_size(packed, _MOST_BYTES - total)
            if total >= _MOST_BYTES:
                raise HostileFile(
                    f"{named(path)} unpacks to more than {_MOST_BYTES} bytes; it was "
                    "refused unread: cut it"
                )
            require_room(path, total)


def _unpacked_size(packed: bytes, most: int) -> int:
    """Return the unpacked size of an element [bytes], or `most` if larger."""
    unpacker, total = zlib.decompressobj(), 0
    try:
        while packed and total < most:
            total += len(unpacker.decompress(packed, _PIECE))
            packed = unpacker.unconsumed_tail
    except zlib.error:
        return total  # the reader reports the damage
    return total


def _contents(path: Path) -> dict[str, tuple[tuple[int, ...], str]]:
    """Return shape and class of each variable, by its name."""
    import scipy.io

    try:
        listed = scipy.io.whosmat(path, appendmat=False)
    except mat_damage() as error:
        raise FormatError(
            f"{named(path)} cannot be read as a MAT file ({shown(error)}); save it "
            "again with -v7"
        ) from error
    if len(listed) > _MOST_VARIABLES:
        raise HostileFile(f"{named(path)} claims to hold {len(listed)} variables")
    return {name: (tuple(shape), kind) for name, shape, kind in listed}


def _check(
    path: Path, name: str, found: dict[str, tuple[tuple[int, ...], str]]
) -> None:
    if name not in found:
        raise FormatError(
            f"{named(path)} holds no variable {shown(name)}; it holds "
            f"{', '.join(shown(other) for other in list(found)[:12]) or 'none'}"
        )
    shape, kind = found[name]
    if kind not in _NUMERIC:
        raise FormatError(
            f"{named(path)}: variable {name!r} is of class {kind!r}, only plain "
            "numbers are read; save it as a row of doubles"
        )
    long = [size for size in shape if size != 1]
    if len(long) != 1 or long[0] < 1:
        raise FormatError(
            f"{named(path)}: variable {name!r} has shape {shape}, one row is needed; "
            "save each channel as a separate variable"
        )
    if long[0] > _MOST_SAMPLES:
        raise HostileFile(
            f"{named(path)}: variable {name!r} claims {long[0]} samples, at most "
            f"{_MOST_SAMPLES} are read; cut it"
        )


def _load(path: Path, names: Sequence[str]) -> list[object]:
    import scipy.io

    try:
        content = scipy.io.loadmat(path, variable_names=list(names), appendmat=False)
        return [content[name] for name in names]
    except mat_damage() as error:
        raise FormatError(
            f"{named(path)} is damaged ({shown(error)}); use another copy"
        ) from error


def mat_damage() -> tuple[type[Exception], ...]:
    """Return the exceptions of SciPy's reader for damaged content."""
    from scipy.io.matlab import MatReadError

    plain = (ValueError, TypeError, KeyError, IndexError, OSError, EOFError)
    rarer = (OverflowError, MemoryError, RuntimeError, NameError)
    return (*plain, *rarer, struct.error, zlib.error, MatReadError)


def _row(path: Path, name: str, value: object) -> FloatArray:
    array = np.asarray(value)
    if array.dtype.kind not in "fiu":
        raise FormatError(
            f"{named(path)}: variable {name!r} holds {array.dtype} values, real "
            "numbers are wanted; save its real part"
        )
    row: FloatArray = array.astype(np.float64).ravel()
    bad = np.flatnonzero(~np.isfinite(row))
    if bad.size:
        raise BadData(
            f"{named(path)}: variable {name!r} holds {bad.size} values that are not "
            f"finite, the first at sample {bad[0]}; cut the record there"
        )
    return row
