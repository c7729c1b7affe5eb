# SPDX-License-Identifier: MIT
"""One thread for linear algebra on small matrices: reproducible and faster.

A sum split over threads is rounded differently: stabilised poles differed by 1e-9
    between one core and two. And each of thousands of small systems waits longer for
    its second thread than it computes (docs/decisions/0056).
"""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache

import scipy.linalg  # noqa: F401 - its BLAS must be loaded before it can be limited
from threadpoolctl import ThreadpoolController


@contextmanager
def one_thread() -> Iterator[None]:
    """Limit BLAS and OpenMP to one thread, and restore their limits afterwards.

    A context manager, and as ``@one_thread()`` a decorator. Not for dense problems of
    thousands of unknowns.
    """
    with _libraries(len(sys.modules)).limit(limits=1):
        yield


@lru_cache(maxsize=1)
def _libraries(modules: int) -> ThreadpoolController:
    """Return the libraries that are loaded; to look for them takes 2 ms.

    Args:
        modules: number of those imported: another one may have loaded a library.
    """
    return ThreadpoolController()
