# SPDX-License-Identifier: MIT
"""One thread for linear algebra on small matrices: reproducible and faster.

A sum split over threads is rounded differently: stabilised poles differed by 1e-9
    between one core and two. And each of thousands of small systems waits longer for
    its second thread than it computes (docs/decisions/0056).
"""

from collections.abc import Iterator
from contextlib import contextmanager

import scipy.linalg  # noqa: F401 - its BLAS must be loaded before it can be limited
from threadpoolctl import threadpool_limits


@contextmanager
def one_thread() -> Iterator[None]:
    """Limit BLAS and OpenMP to one thread, and restore their limits afterwards.

    A context manager, and as ``@one_thread()`` a decorator. Not for dense problems of
    thousands of unknowns.
    """
    with threadpool_limits(limits=1):
        yield
