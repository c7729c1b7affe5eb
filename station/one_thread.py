# SPDX-License-Identifier: MIT
"""One thread for the libraries that add up: the same input, the same number.

A sum that is split over threads rounds otherwise than one that is not, and stabilised
poles differed by 1e-9 between one core and two. What is kept under a key is computed
on one thread, whatever the environment says; archives use the cores file by file.
"""

from collections.abc import Iterator
from contextlib import contextmanager

import scipy.linalg  # noqa: F401 - its BLAS must be there before it can be held
from threadpoolctl import threadpool_limits


@contextmanager
def one_thread() -> Iterator[None]:
    """Hold BLAS and OpenMP to one thread meanwhile, and give back what they had."""
    with threadpool_limits(limits=1):
        yield
