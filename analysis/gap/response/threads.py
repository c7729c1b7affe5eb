# SPDX-License-Identifier: MIT
"""Parallel predictions in threads; results do not depend on their number.

The slopes of a fit and the directed tests are dozens of independent predictions, and
both the compiled time integration and the transforms release the interpreter lock.
Candidates are not fitted in parallel: each fit is pruned by the best one before it.
"""

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar, copy_context

from jointbench.acquisition.basics.one_thread import one_thread

_POOL: ContextVar[ThreadPoolExecutor | None] = ContextVar("pool", default=None)


@contextmanager
def side_by_side(workers: int | None = None) -> Iterator[None]:
    """Run the predictions within the context in parallel.

    Linear algebra is limited to one thread meanwhile: its matrices are small, and its
    own threads, waiting for a busy core, would take ten times as long.

    Args:
        workers: number of threads; the number of cores if None.
    """
    count = workers or os.cpu_count() or 1
    with one_thread():
        if count == 1:
            yield
            return
        with ThreadPoolExecutor(count) as pool:
            token = _POOL.set(pool)
            try:
                yield
            finally:
                _POOL.reset(token)


def each(task: Callable[[int], None], count: int) -> None:
    """Run a task for 0, 1, ..., in parallel within `side_by_side`.

    Args:
        task: writes its result to its own place, and starts no threads.
        count: number of runs.

    Raises:
        Exception: that of the first task that failed.
    """
    pool = _POOL.get()
    if pool is None:
        for k in range(count):
            task(k)
        return
    running = [pool.submit(copy_context().run, task, k) for k in range(count)]
    try:
        for future in running:
            future.result()
    finally:
        for future in running:
            future.cancel()
