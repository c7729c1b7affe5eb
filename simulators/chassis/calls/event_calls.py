# SPDX-License-Identifier: MIT
"""NI's calls that stream events to a client, and the state of open loops."""

# The methods carry the names that the protocol gives them.
# ruff: noqa: N802

import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from typing import Any

from jointbench.simulators.chassis.calls.answers import Calls, answered
from jointbench.simulators.chassis.protocol import (
    Daqmx,
    DAQmxErrors,
    Refusal,
    constants,
    number_of,
    refuse,
)
from jointbench.simulators.chassis.tasks.acquisition import Acquisition
from jointbench.simulators.chassis.tasks.task import SimulatedTask

_POLL = 0.02  # [s]
_ACQUIRED = constants.EveryNSamplesEventType.ACQUIRED_INTO_BUFFER.value


class EventCalls(Calls):
    """Every N Samples and Done; a stream ends with its client, or when unregistered."""

    def RegisterEveryNSamplesEvent(self, request: Any, context: Any) -> Iterator[Any]:
        """Send an event for every n acquired samples."""
        kind = number_of(request, "every_n_samples_event_type")

        def check(task: SimulatedTask) -> None:
            _require_interval(task, kind, request.n_samples)

        event = Daqmx.RegisterEveryNSamplesEventResponse(
            every_n_samples_event_type_raw=kind, n_samples=request.n_samples
        )
        yield from self._stream(
            request, context, _Every(request.n_samples, event), check
        )

    def RegisterDoneEvent(self, request: Any, context: Any) -> Iterator[Any]:
        """Send an event when a task is done, once for each start."""

        def check(task: SimulatedTask) -> None:
            _require_free(task, "done", DAQmxErrors.DONE_EVENT_ALREADY_REGISTERED)
            task.events["done"] = 1

        yield from self._stream(request, context, _Done(), check)

    def RegisterSignalEvent(self, request: Any, context: Any) -> Iterator[Any]:
        """Register for a signal of the hardware; the chassis gives none."""

        def check(task: SimulatedTask) -> None:
            code = DAQmxErrors.SIGNAL_EVENT_ALREADY_REGISTERED
            _require_free(task, "signal", code)
            task.events["signal"] = 1

        yield from self._stream(request, context, _Never(), check)

    @answered
    def UnregisterEveryNSamplesEvent(self, request: Any, context: Any) -> Any:
        """End the stream of Every N Samples."""
        _forget(self.task(request), "every_n")
        return Daqmx.UnregisterEveryNSamplesEventResponse()

    @answered
    def UnregisterDoneEvent(self, request: Any, context: Any) -> Any:
        """End the stream of Done."""
        _forget(self.task(request), "done")
        return Daqmx.UnregisterDoneEventResponse()

    @answered
    def UnregisterSignalEvent(self, request: Any, context: Any) -> Any:
        """End the stream of a signal."""
        _forget(self.task(request), "signal")
        return Daqmx.UnregisterSignalEventResponse()

    def _stream(
        self,
        request: Any,
        context: Any,
        events: "_Events",
        check: Callable[[SimulatedTask], None],
    ) -> Iterator[Any]:
        with self.waiters.occupied(context):
            try:
                task = self.task(request)
                with task.guard:
                    check(task)
                    events.begin(task)
                    task.streams[events.name] = events
            except Refusal as refusal:
                refuse(context, refusal, request.task.name)
                return
            try:
                context.send_initial_metadata(())
                yield from self._events(task, events, context)
            finally:
                if task.streams.get(events.name) is events:
                    _forget(task, events.name)

    def _events(
        self, task: SimulatedTask, events: "_Events", context: Any
    ) -> Iterator[Any]:
        """Yield events while client, task and registration last."""
        while context.is_active() and self.tasks.get(task.name) is task:
            if task.streams.get(events.name) is not events:
                return
            yield from events.new(task)
            time.sleep(_POLL)


def _forget(task: SimulatedTask, name: str) -> None:
    """End a registration; its stream notices."""
    task.events.pop(name, None)
    task.streams.pop(name, None)


class _Events(ABC):
    """Events of one registration; a new start of the task counts from zero."""

    name = ""

    def __init__(self) -> None:
        self._earlier: Acquisition | None = None
        self._seen: Acquisition | None = None

    def begin(self, task: SimulatedTask) -> None:
        """Take no notice of what the task did before the registration."""
        self._earlier = self._seen = task.acquisition

    def _fresh(self, task: SimulatedTask) -> bool:
        """Return whether the task was started again."""
        fresh = task.acquisition is not self._seen
        self._seen = task.acquisition
        return fresh

    @abstractmethod
    def new(self, task: SimulatedTask) -> Iterator[Any]:
        """Yield the events since the last call."""


class _Every(_Events):
    name = "every_n"

    def __init__(self, every: int, event: Any) -> None:
        super().__init__()
        self._every, self._event, self._sent = every, event, 0

    def new(self, task: SimulatedTask) -> Iterator[Any]:
        """Yield an event for every interval that is complete."""
        if self._fresh(task):
            self._sent = 0
        made = task.acquisition
        if made is None or made is self._earlier:
            return
        if made.fast and made.position >= self._sent * self._every:
            # A chassis that runs as it is read waits for the reader here.
            made.skip_to(min((self._sent + 1) * self._every, made.end or 2**62))
        while self._sent < made.acquired() // self._every:
            self._sent += 1
            yield self._event


class _Done(_Events):
    name = "done"

    def __init__(self) -> None:
        super().__init__()
        self._told = False

    def new(self, task: SimulatedTask) -> Iterator[Any]:
        """Yield one event once the task is done."""
        if self._fresh(task):
            self._told = False
        made = task.acquisition
        if not self._told and task.running and made is not None and made.done():
            self._told = True
            yield Daqmx.RegisterDoneEventResponse(status=0)


class _Never(_Events):
    name = "signal"

    def new(self, task: SimulatedTask) -> Iterator[Any]:
        """Yield nothing."""
        return iter(())


def _require_free(task: SimulatedTask, name: str, code: DAQmxErrors) -> None:
    if task.running:
        raise Refusal(
            DAQmxErrors.CANNOT_REGISTER_DA_QMX_SOFTWARE_EVENT_WHILE_TASK_IS_RUNNING,
            "DAQmx software event cannot be registered because the task is running.",
        )
    if name in task.events:
        raise Refusal(
            code,
            "DAQmx software event is already registered.\n\nUnregister the event "
            "before you register it again.",
        )


def _require_interval(task: SimulatedTask, kind: int, every: int) -> None:
    if kind != _ACQUIRED:
        raise Refusal(
            DAQmxErrors.EVERY_N_SAMPS_TRANSFERRED_FROM_BUFFER_EVENT_NOT_SUPPORTED_BY_DEVICE,
            "Every N Samples Transferred From Buffer event is not supported by the "
            "device for the channel type specified.",
        )
    if every == 0:
        raise Refusal(
            DAQmxErrors.EVERY_N_SAMPS_EVENT_INTERVAL_ZERO_NOT_SUPPORTED,
            "An interval of zero is not supported for the Every N Samples event.",
        )
    code = DAQmxErrors.EVERY_N_SAMPS_ACQ_INTO_BUFFER_EVENT_ALREADY_REGISTERED
    _require_free(task, "every_n", code)
    task.events["every_n"] = every
