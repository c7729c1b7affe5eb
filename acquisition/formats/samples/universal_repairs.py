# SPDX-License-Identifier: MIT
"""What pyuff does not read of valid universal files: Latin-1 units, padded lines."""

import re
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

_UNIT_LINES = {
    "abscissa_axis_units_lab": 9,
    "ordinate_axis_units_lab": 10,
    "orddenom_axis_units_lab": 11,
}
"""Units of a data set 58 by the names of pyuff, and their lines after the edge."""
_UNIT = slice(47, 67)
_REPLACED = "\ufffd"
_PADDED = re.compile(rb"[ \t]+(?=\r?\n {4}-1)")


@contextmanager
def unpadded(path: Path, data: bytes, *, binary: bool) -> Iterator[Path]:
    """Yield a file whose last lines of values end with their last number.

    SDynPy fills lines up to 80 characters; pyuff takes the spaces for a number.

    Args:
        path: of the file.
        data: its bytes.
        binary: whether a data set is binary; its bytes are left as they are.
    """
    if binary or _PADDED.search(data) is None:
        yield path
        return
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "unpadded.uff"
        copy.write_bytes(_PADDED.sub(b"", data))
        yield copy


def with_latin_units(one: dict[str, Any], header: bytes) -> dict[str, Any]:
    """Return a data set 58 with the units of a header that is not in UTF-8.

    pyuff decodes texts as UTF-8 and replaces what is none: a superscript or a micro
    sign of a program that writes Latin-1 is lost.

    Args:
        one: as pyuff reads it.
        header: first bytes of the data set, from its edge on.
    """
    if not any(_REPLACED in str(one.get(name)) for name in _UNIT_LINES):
        return one
    return {**one, **_units(header.splitlines())}


def _units(lines: list[bytes]) -> Mapping[str, str]:
    return {
        name: lines[line][_UNIT].decode("latin-1").strip()
        for name, line in _UNIT_LINES.items()
        if line < len(lines)
    }
