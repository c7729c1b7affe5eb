# SPDX-License-Identifier: MIT
"""Memory limit of a file, set before it is read.

A reader of foreign files is limited to 500 MB and four times the file. Interpreter and
libraries use 150 MB of these; the rest is here. Samples of one byte become doubles of
eight, and packed ones more, so the size of the file alone is no bound.
"""

import os
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.errors import HostileFile
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.file_access.text_files import file_size

ROOM = 350
"""In addition to four times the file [MB]."""
VARIABLE = "JOINTBENCH_MEMORY_MB"
"""Environment variable that replaces `ROOM`, for trusted files."""
MAX_ROWS = 200_000
"""Most rows of a table with one record per row: hits, quantities, steps."""
MAX_JSON = 4_000_000
"""Most characters of JSON in a file: empty lists take twenty times their text."""
_MB = 10**6
_PIECE = 2**24


def require_short_json(*texts: str) -> None:
    """Raise `HostileFile` where texts of JSON exceed the limit."""
    length = sum(map(len, texts))
    if length > MAX_JSON:
        raise HostileFile(f"it holds {length} characters of JSON, at most {MAX_JSON}")


def room(size: int) -> int:
    """Return the memory limit [bytes] of a file of `size` [bytes]."""
    given = os.environ.get(VARIABLE, "")
    floor = int(given) if given.isdecimal() else ROOM
    return floor * _MB + 4 * size


def count_cells(data: bytes) -> int:
    """Count words separated by blanks, tabs, commas, semicolons and line ends."""
    marks = np.zeros(256, dtype=bool)
    marks[[*b" \t\n,;"]] = True
    found = 0
    for first in range(0, len(data), _PIECE):
        part = marks[np.frombuffer(data[first : first + _PIECE], np.uint8)]
        found += int(np.count_nonzero(part[1:] & ~part[:-1])) + 1
    return found


def require_room(path: Path, needed: float) -> None:
    """Raise `HostileFile` where reading a file exceeds its memory limit.

    Args:
        path: of the file.
        needed: memory to read it [bytes].
    """
    allowed = room(file_size(path))
    if needed > allowed:
        raise HostileFile(
            f"{named(path)} would take {needed / _MB:.0f} MB of memory, a file of its "
            f"size may take {allowed / _MB:.0f} MB; split it, or if you trust it set "
            f"{VARIABLE}={needed / _MB:.0f}"
        )
