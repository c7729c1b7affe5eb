# SPDX-License-Identifier: MIT
"""Linear algebra of small matrices in one thread: faster, and the same to the bit."""

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

from threadpoolctl import threadpool_limits

P = ParamSpec("P")
R = TypeVar("R")


def one_blas_thread(function: Callable[P, R]) -> Callable[P, R]:
    """Run a function with the linear algebra library limited to one thread.

    For work on many small matrices: there a second thread doubles the CPU time and
    shortens nothing, and sums taken in another order change the last digits, which
    would make results depend on the machine (docs/decisions/0056).
    """

    @wraps(function)
    def limited(*args: P.args, **kwargs: P.kwargs) -> R:
        with threadpool_limits(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return limited
