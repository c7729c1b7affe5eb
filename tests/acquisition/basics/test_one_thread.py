# SPDX-License-Identifier: MIT
"""Small matrices are solved in one thread, and the limit ends with the function."""

import numpy as np
from threadpoolctl import threadpool_info, threadpool_limits

from jointbench.acquisition.basics.one_thread import one_thread


def blas_threads() -> set[int]:
    """Return the thread counts of the BLAS libraries that NumPy and SciPy loaded."""
    np.linalg.inv(np.eye(3))
    return {
        lib["num_threads"] for lib in threadpool_info() if lib["user_api"] == "blas"
    }


def test_the_limit_holds_within_the_function_and_ends_with_it() -> None:
    """Two threads outside, one inside, two again."""
    with threadpool_limits(limits=2, user_api="blas"):
        outside = blas_threads()
        assert one_thread()(blas_threads)() == {1}
        assert blas_threads() == outside == {2}
