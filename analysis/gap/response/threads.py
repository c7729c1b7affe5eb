# SPDX-License-Identifier: MIT
"""Predictions side by side, in threads: what comes out does not depend on how many.

The slopes of a fit and the directed tests are dozens of predictions that know nothing
of each other, and both the compiled march and the transforms let other threads run.
Rivals are not raced side by side: each is given up by the best of those before it.
"""

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar, copy_context

from threadpoolctl import threadpool_limits

_POOL: ContextVar[ThreadPoolExecutor | None] = ContextVar("pool", default=None)


@contextmanager
def side_by_side(workers: int | None = None) -> Iterator[None]:
    """Let predictions within run side by side.

    Linear algebra keeps to one thread meanwhile: its matrices are small, and threads
    of its own that wait for a busy core take ten times as long as none.

    Args:
        workers: threads; as many as there are cores if None.
    """
    count = workers or os.cpu_count() or 1
    with threadpool_limits(limits=1):
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
    """Do a task for 0, 1, ..., side by side where that was asked for.

    Args:
        task: that writes its result to a place of its own, and asks for no threads.
        count: how often.

    Raises:
        Exception: what the first task raised that failed.
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
