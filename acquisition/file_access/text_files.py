# SPDX-License-Identifier: MIT
"""Read files as text: size limit, lossless decoding, file name in every message."""

import codecs
import hashlib
import re
import stat
from pathlib import Path

from jointbench.acquisition.basics.errors import BadData, FormatError, HostileFile
from jointbench.acquisition.file_access.quoting import named

# A text takes up to six times its size in memory, a line an extra 60 bytes.
_MAX_TEXT_BYTES = 100_000_000
MAX_LINES = 3_000_000
_BYTES_A_LINE = 100
"""Characters of a larger text per additional line."""
_MAX_LINE_CHARACTERS = 2**20
_BOMS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
_HDF5 = b"\x89HDF\r\n\x1a\n"
# Characters of no text: control characters other than tab, line feed, form feed and the
# Ctrl-Z that old programs put at the end.
_BINARY = re.compile("[\x00-\x08\x0b\x0e-\x19\x1b-\x1f\x7f]")


def file_size(path: Path | str) -> int:
    """Return the size of an ordinary file [bytes].

    Raises:
        BadData: there is no such file, or it is a folder, a device or a pipe.
    """
    try:
        info = Path(path).stat()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise BadData(f"{named(path)}: {reason}; check the name of the file") from error
    if stat.S_ISDIR(info.st_mode):
        raise BadData(f"{named(path)} is a folder; name the file inside it")
    if not stat.S_ISREG(info.st_mode):
        raise BadData(f"{named(path)} is a device or a pipe; give an ordinary file")
    return info.st_size


def file_digest(path: Path | str) -> str:
    """Return the SHA-256 of a file as hexadecimal text."""
    file_size(path)
    try:
        with Path(path).open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise BadData(f"{named(path)} cannot be read: {error.strerror}") from error


def read_bytes(path: Path | str, *, limit: int = _MAX_TEXT_BYTES) -> bytes:
    """Return the content of a file that is not larger than `limit` [bytes].

    Raises:
        BadData: it cannot be opened.
        FormatError: it is empty.
        HostileFile: it is larger than `limit`.
    """
    size = file_size(path)
    if size == 0:
        raise FormatError(f"{named(path)} is empty; export it again")
    if size > limit:
        raise HostileFile(
            f"{named(path)} has {size} bytes, at most {limit} are read as text; "
            "split it, or save the numbers as .npy"
        )
    try:
        with Path(path).open("rb") as file:
            return file.read(limit)
    except OSError as error:
        raise BadData(f"{named(path)} cannot be read: {error.strerror}") from error


def decode(data: bytes, path: Path | str) -> tuple[str, str]:
    r"""Decode UTF-8, UTF-16 or Windows-1252, the first that fits without loss.

    Args:
        data: the content.
        path: the file it came from, for messages.

    Returns:
        The text with ``\n`` at the line ends, and the name of the encoding.

    Raises:
        FormatError: it is none of the three, or no text.
    """
    if data.startswith(_HDF5):
        raise FormatError(
            f"{named(path)} is an HDF5 file, not a table: a session needs no import, "
            "give it to 'jointbench modal' or 'jointbench report' directly"
        )
    candidates = _candidates(data)
    if b"\r" in data and not candidates[0].startswith("utf-16"):
        data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    for encoding in candidates:
        try:
            text = data.decode(encoding)
        except UnicodeDecodeError:
            continue
        if _BINARY.search(text) is None:
            if "\r" in text:
                text = text.replace("\r\n", "\n").replace("\r", "\n")
            return text, encoding
    raise FormatError(
        f"{named(path)} is not text in UTF-8, UTF-16 or Windows-1252; it looks like a "
        "binary file: export it as text, or convert it to .npy"
    )


def text_lines(text: str, path: Path | str) -> list[str]:
    """Split a text into lines of limited length.

    Raises:
        HostileFile: a line has more than a million characters, or there are more
            lines than any table of measured values has.
    """
    count, most = text.count("\n"), MAX_LINES + len(text) // _BYTES_A_LINE
    if count > most:
        raise HostileFile(
            f"{named(path)} has {count} lines, at most {most} are read of a text of "
            "its size; split it, or save the numbers as .npy"
        )
    lines = text.split("\n")
    lengths = list(map(len, lines))
    if max(lengths) > _MAX_LINE_CHARACTERS:
        raise HostileFile(
            f"{named(path)}: line {lengths.index(max(lengths)) + 1} has {max(lengths)} "
            f"characters; at most {_MAX_LINE_CHARACTERS} are read: write one row a line"
        )
    return lines


def _candidates(data: bytes) -> tuple[str, ...]:
    for mark, encoding in _BOMS:
        if data.startswith(mark):
            return (encoding,)
    head = data[:400]
    # In UTF-16 digits have every other byte zero, with or without a byte-order mark.
    if head and head[1::2].count(0) > 0.8 * len(head[1::2]):
        return ("utf-16-le",)
    if head and head[0::2].count(0) > 0.8 * len(head[0::2]):
        return ("utf-16-be",)
    return ("utf-8", "cp1252")
