# SPDX-License-Identifier: MIT
"""The mark of a file's state, by which it is known again without being read."""

from pathlib import Path

Mark = tuple[int, ...]
"""Inode, size [bytes] and time [ns] of a file; empty for no file."""


def mark_of(path: Path) -> Mark:
    """Return the mark of a file's state; empty where there is none."""
    try:
        info = path.stat()
    except (OSError, ValueError):
        return ()
    return info.st_ino, info.st_size, info.st_mtime_ns
