# SPDX-License-Identifier: MIT
"""What one client may ask of the server, so that it serves another one beside it."""

import threading
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

import grpc


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """Most of each.

    Attributes:
        workers: threads that serve calls.
        waiting: calls of all clients that wait or stream events, each in a worker.
        waiting_each: of one client.
        tasks: of all clients.
        tasks_each: of one client.
    """

    workers: int = 48
    waiting: int = 40
    waiting_each: int = 16
    tasks: int = 512
    tasks_each: int = 128


@dataclass(slots=True)
class Waiters:
    """Calls that occupy a worker for long, by client."""

    limits: Limits
    _counts: Counter[str] = field(default_factory=Counter)
    _lock: threading.Lock = field(default_factory=threading.Lock)

    @contextmanager
    def occupied(self, context: grpc.ServicerContext) -> Iterator[None]:
        """Occupy a worker; end the call if its client, or all, have too many."""
        who = client(context)
        with self._lock:
            limits = self.limits
            mine, all_ = self._counts[who], self._counts.total()
            free = mine < limits.waiting_each and all_ < limits.waiting
            self._counts[who] += free
        if not free:
            context.abort(
                grpc.StatusCode.RESOURCE_EXHAUSTED,
                f"{mine} calls of this client and {all_} in all are waiting; the "
                f"simulated chassis serves {limits.waiting_each} and "
                f"{limits.waiting} at a time: end some of them",
            )
        try:
            yield
        finally:
            with self._lock:
                self._counts[who] -= 1
                self._counts += Counter()


def client(context: grpc.ServicerContext) -> str:
    """Return the connection of a call."""
    return str(context.peer())
