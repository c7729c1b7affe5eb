# SPDX-License-Identifier: MIT
"""Memory of a process that runs for hours."""

import ctypes
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

_LARGE = 2**17  # [bytes] from which a block goes back to the system when it is freed
_ARENAS = 2  # heaps of all threads together
# Numbers of `mallopt`, from malloc.h.
_TRIM_THRESHOLD, _MMAP_THRESHOLD, _MMAP_MAX, _ARENA_MAX = -1, -3, -4, -8
_KEPT, _USUAL = 2**30, 2**26  # [bytes] free at the end of the heap: kept, and usually
_MAPPED = 2**16  # blocks that the C library takes from the system one by one


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
    return _set(
        (_MMAP_THRESHOLD, large), (_TRIM_THRESHOLD, large), (_ARENA_MAX, _ARENAS)
    )


@contextmanager
def freed_memory_kept() -> Iterator[None]:
    """Keep memory that is freed within the context for the blocks that follow.

    A block of megabytes that goes back to the system is cleared when it is taken again:
    a tenth of a computation that takes thousands of them. The process stays as large as
    it was at its largest, and somewhat larger by what lies unused between blocks.
    """
    if not _set((_MMAP_MAX, 0), (_TRIM_THRESHOLD, _KEPT)):
        yield
        return
    try:
        yield
    finally:
        _set((_MMAP_MAX, _MAPPED), (_TRIM_THRESHOLD, _USUAL))
        return_freed_memory()


def return_freed_memory() -> bool:
    """Give memory that was freed back to the system, from within the heap as well.

    Small blocks that stay hold the large ones around them; between two steps of a long
    computation that is a third of its memory.

    Returns:
        Whether there was any, and the C library can; others than glibc need not.

    Source:
        malloc_trim(3).
    """
    trim = _of_glibc("malloc_trim")
    return trim is not None and trim(0) == 1


def _set(*settings: tuple[int, int]) -> bool:
    """Return whether the C library took all settings, each a number and its value."""
    take = _of_glibc("mallopt")
    return take is not None and all(take(*one) == 1 for one in settings)


def _of_glibc(name: str) -> Callable[..., int] | None:
    """Return a function of the C library; None where it has none of this name."""
    if not sys.platform.startswith("linux"):
        return None
    try:
        found: Callable[..., int] = getattr(ctypes.CDLL(None), name)
    except (AttributeError, OSError):
        return None
    return found
