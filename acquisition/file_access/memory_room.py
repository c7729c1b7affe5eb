# SPDX-License-Identifier: MIT
"""What a file may take in memory: known before it is read, whatever it claims.

A reader of foreign bytes keeps to 500 MB and four times the file. Interpreter and
libraries take 150 MB of these; the rest is here. Samples of one byte become doubles of
eight, and packed ones more, so the size of the file alone bounds nothing.
"""

import os
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.errors import HostileFile
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.file_access.text_files import file_size

ROOM = 350
"""Beside four times the file [MB]."""
VARIABLE = "JOINTBENCH_MEMORY_MB"
"""Of the environment: what to allow in place of `ROOM`, for files one trusts."""
MAX_ROWS = 200_000
"""Of a table that becomes a record a row: hits, quantities, steps."""
MAX_JSON = 4_000_000
"""Characters of JSON in a file: lists of nothing take twenty times their text."""
_MB = 10**6
_PIECE = 2**24


def require_short_json(*texts: str) -> None:
    """Raise `HostileFile` where texts of JSON are longer than any of ours."""
    length = sum(map(len, texts))
    if length > MAX_JSON:
        raise HostileFile(f"it holds {length} characters of JSON, at most {MAX_JSON}")


def room(size: int) -> int:
    """Return what a file of `size` [bytes] may take in memory [bytes]."""
    given = os.environ.get(VARIABLE, "")
    floor = int(given) if given.isdecimal() else ROOM
    return floor * _MB + 4 * size


def count_cells(data: bytes) -> int:
    """Return how many words blanks, tabs, commas, semicolons and line ends part."""
    marks = np.zeros(256, dtype=bool)
    marks[[*b" \t\n,;"]] = True
    found = 0
    for first in range(0, len(data), _PIECE):
        part = marks[np.frombuffer(data[first : first + _PIECE], np.uint8)]
        found += int(np.count_nonzero(part[1:] & ~part[:-1])) + 1
    return found


def require_room(path: Path, needed: float) -> None:
    """Raise `HostileFile` where reading a file takes more memory than it may.

    Args:
        path: of the file.
        needed: what it would take [bytes].
    """
    allowed = room(file_size(path))
    if needed > allowed:
        raise HostileFile(
            f"{named(path)} would take {needed / _MB:.0f} MB of memory, a file of its "
            f"size may take {allowed / _MB:.0f} MB; split it, or if you trust it set "
            f"{VARIABLE}={needed / _MB:.0f}"
        )
