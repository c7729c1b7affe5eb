# SPDX-License-Identifier: MIT
"""One thread for linear algebra on small matrices: the same digits, sooner.

A sum that is split over threads rounds otherwise than one that is not: stabilised
poles differed by 1e-9 between one core and two. And of thousands of small systems each
waits longer for its second thread than it computes (docs/decisions/0056).
"""

from collections.abc import Iterator
from contextlib import contextmanager

import scipy.linalg  # noqa: F401 - its BLAS must be there before it can be limited
from threadpoolctl import threadpool_limits


@contextmanager
def one_thread() -> Iterator[None]:
    """Limit BLAS and OpenMP to one thread meanwhile, and give back what they had.

    A context manager, and as ``@one_thread()`` a decorator. A dense problem of
    thousands of unknowns should not carry it.
    """
    with threadpool_limits(limits=1):
        yield
