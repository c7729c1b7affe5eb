# SPDX-License-Identifier: MIT
"""Memory of a process that runs for hours."""

import ctypes
import sys

_LARGE = 2**17  # [bytes] from which a block goes back to the system when it is freed
_ARENAS = 2  # heaps of all threads together
# Numbers of `mallopt`, from malloc.h.
_TRIM_THRESHOLD, _MMAP_THRESHOLD, _ARENA_MAX = -1, -3, -8


def keep_memory_steady(large: int = _LARGE) -> bool:
    """Let large blocks of memory go back to the system as soon as they are freed.

    The C library of Linux keeps freed blocks of up to 32 MB for later. Reads of
    changing size then leave holes between what stays, and a recording grows by
    megabytes a minute for as long as the computer is busy.

    Args:
        large: size of a block from which it goes back at once [bytes]. Each one that
            does costs the time to clear it when it is taken again.

    Returns:
        Whether the C library took the settings; others than glibc need not be.

    Source:
        mallopt(3), section "dynamic mmap threshold".
    """
    if not sys.platform.startswith("linux"):
        return False
    try:
        tell = ctypes.CDLL(None).mallopt
    except (AttributeError, OSError):
        return False
    settings = (
        (_MMAP_THRESHOLD, large),
        (_TRIM_THRESHOLD, large),
        (_ARENA_MAX, _ARENAS),
    )
    return all(tell(name, value) == 1 for name, value in settings)


def return_freed_memory() -> bool:
    """Give memory that was freed back to the system, from within the heap as well.

    Small blocks that stay hold the large ones around them; between two steps of a long
    computation that is a third of its memory.

    Returns:
        Whether there was any, and the C library can; others than glibc need not.

    Source:
        malloc_trim(3).
    """
    if not sys.platform.startswith("linux"):
        return False
    try:
        trim = ctypes.CDLL(None).malloc_trim
    except (AttributeError, OSError):
        return False
    return bool(trim(0))
