# SPDX-License-Identifier: MIT
"""The state that all calls share, and how they answer."""

import threading
from collections import Counter
from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar

import grpc

from jointbench.simulators.chassis.limits import Limits, Waiters, client
from jointbench.simulators.chassis.modules.inventory import Inventory
from jointbench.simulators.chassis.protocol import (
    DAQmxErrors,
    Refusal,
    Servicer,
    refuse,
)
from jointbench.simulators.chassis.tasks.acquisition import ClientGone
from jointbench.simulators.chassis.tasks.task import NewTask, SimulatedTask

_Answer = TypeVar("_Answer")


def answered(
    method: Callable[[Any, Any, Any], _Answer],
) -> Callable[[Any, Any, Any], _Answer]:
    """Convert a `Refusal` raised in a method to the error of the protocol."""

    @wraps(method)
    def call(self: Any, request: Any, context: grpc.ServicerContext) -> _Answer:
        try:
            return method(self, request, context)
        except Refusal as refusal:
            named = getattr(request, "task", None)
            refuse(context, refusal, named.name if named is not None else "")
            raise  # `refuse` ends the call by an exception of its own
        except ClientGone:
            context.abort(grpc.StatusCode.CANCELLED, "the client has disconnected")
            raise

    return call


class Calls(Servicer):  # type: ignore[misc]
    """Devices, tasks and limits, for the calls of its subclasses.

    Attributes:
        inventory: the devices.
        tasks: by name of their session.
        waiters: calls that wait.
    """

    def __init__(
        self, inventory: Inventory, new_task: NewTask, limits: Limits | None = None
    ) -> None:
        self.inventory = inventory
        self.tasks: dict[str, SimulatedTask] = {}
        self.waiters = Waiters(limits or Limits())
        self._new_task = new_task
        self._owners: dict[str, str] = {}
        self._unnamed = 0
        self._lock = threading.Lock()

    def task(self, request: Any) -> SimulatedTask:
        """Return the task of a request.

        Raises:
            Refusal: there is none; a restarted server has no earlier one.
        """
        found = self.tasks.get(request.task.name)
        if found is None:
            raise Refusal(
                DAQmxErrors.INVALID_TASK, "Task specified is invalid or does not exist."
            )
        return found

    def make_task(self, name: str, context: grpc.ServicerContext) -> tuple[str, bool]:
        """Return the name of a task, and whether it is new.

        Raises:
            Refusal: there are too many.
        """
        with self._lock:
            if name in self.tasks:
                return name, False
            self._require_room(client(context))
            if not name:
                name = f"_unnamedTask<{self._unnamed}>"
                self._unnamed += 1
            self.tasks[name] = self._new_task(name)
            self._owners[name] = client(context)
            return name, True

    def drop_task(self, task: SimulatedTask) -> None:
        """Abort a task and forget it."""
        with task.guard:
            task.abort()
        with self._lock:
            self.tasks.pop(task.name, None)
            self._owners.pop(task.name, None)

    def _require_room(self, who: str) -> None:
        limits, owned = self.waiters.limits, Counter(self._owners.values())
        if owned[who] >= limits.tasks_each or len(self.tasks) >= limits.tasks:
            raise Refusal(
                DAQmxErrors.PAL_MEMORY_FULL,
                "The requested memory could not be allocated.\n\n"
                f"The simulated chassis keeps {limits.tasks_each} tasks of a client "
                f"and {limits.tasks} in all: clear some of them.",
            )
