# SPDX-License-Identifier: MIT
"""NI's device service, continued: reading, counters, events, scripted faults."""

# The methods carry the names that the protocol gives them.
# ruff: noqa: N802

from collections.abc import Callable, Iterator
from typing import Any

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.simulators.chassis import device_properties as properties
from jointbench.simulators.chassis.faults import Fault, FaultKind
from jointbench.simulators.chassis.inventory import Inventory
from jointbench.simulators.chassis.protocol import Daqmx, Refusal, attribute_of
from jointbench.simulators.chassis.service import NewTask, TaskService, answered
from jointbench.simulators.chassis.task import Pace, SimulatedTask

_ACQUIRED, _AVAILABLE, _POSITION, _CHANNELS = 0x192A, 0x1223, 0x1221, 0x217B
_CHANNELS_TO_READ = 0x1823
_OVERLOADED_EXIST, _OVERLOADED = 0x2174, 0x2175
_OPEN_EXIST, _OPEN = 0x2A09, 0x2A0A
_BY_CHANNEL = 0
_READ_ARRAY = Daqmx.ReadAnalogF64Response.DESCRIPTOR.fields_by_name["read_array"].number
_LENGTH_DELIMITED = 2  # wire type of protocol buffers
_EVENT_POLL = 0.02  # [s]


class ReadingService(TaskService):
    """The complete service.

    Attributes:
        delivered: samples per channel delivered over all streams.
        reached: sample up to which faults were applied.
    """

    def __init__(
        self,
        inventory: Inventory,
        new_task: NewTask,
        *,
        begin: Callable[[float], None],
        pace: Pace,
        faults: tuple[Fault, ...] = (),
        drop: Callable[[float], None] = lambda seconds: None,
    ) -> None:
        super().__init__(inventory, new_task)
        self.delivered = 0
        self.reached = -1
        self._begin, self._pace, self._drop = begin, pace, drop
        self._waiting = sorted(faults, key=lambda fault: fault.at)
        self._open: set[int] = set()
        self._delay = 0.0

    def latest(self) -> int:
        """Return the latest sample of the running task, 0 without one."""
        return max((t.acquired() for t in self.tasks.values() if t.running), default=0)

    @answered
    def StartTask(self, request: Any, context: Any) -> Any:
        """Start the clock; the specimen begins a new stream from rest."""
        task = self.task(request)
        self._begin(task.rate)
        task.start()
        return Daqmx.StartTaskResponse()

    @answered
    def ReadAnalogF64(self, request: Any, context: Any) -> Any:
        """Deliver samples in the units of the channels."""
        task = self.task(request)
        count = self._count(task, request)
        samples = self._read(task, count, request.timeout)
        if (request.fill_mode_raw or request.fill_mode) != _BY_CHANNEL:
            samples = samples.T
        # Doubles travel packed: their bytes are the message, which saves a Python
        # object for every sample.
        packed = samples.astype("<f8").tobytes()
        response = Daqmx.ReadAnalogF64Response.FromString(
            _packed_field(_READ_ARRAY, len(packed)) + packed
        )
        response.samps_per_chan_read = count
        return response

    def _count(self, task: SimulatedTask, request: Any) -> int:
        if request.num_samps_per_chan >= 0:
            return int(request.num_samps_per_chan)
        if task.finite is not None:
            return task.finite
        return max(0, task.acquired() - task.position)

    def _read(self, task: SimulatedTask, count: int, timeout: float) -> FloatArray:
        self._break(task, count)
        if self._delay:
            self._pace.sleep(self._delay)
        samples = task.read(count, timeout)
        for row, channel in zip(samples, task.channels, strict=True):
            if channel.input in self._open:
                # An open loop drives the input to the compliance voltage.
                row[:] = 5.0 / channel.sensitivity
        self.delivered += count
        return samples

    def _break(self, task: SimulatedTask, count: int) -> None:
        """Apply every fault up to the last sample of this read."""
        while self._waiting and self._waiting[0].at < self.delivered + count:
            fault = self._waiting.pop(0)
            self.reached = fault.at
            if fault.kind is FaultKind.SLOW:
                self._delay = fault.value
            elif fault.kind is FaultKind.OPEN:
                self._open.add(int(fault.value))
            elif fault.kind is FaultKind.CLOSE:
                self._open.discard(int(fault.value))
            elif fault.kind is FaultKind.OVERRUN:
                task.skip_to(task.position + task.buffer + int(fault.value))
            elif fault.kind is FaultKind.ERROR:
                words = "An error by script."
                raise Refusal(-int(fault.value), words, read=0)
            elif fault.kind is FaultKind.DROP:
                self._drop(fault.value)

    @answered
    def GetReadAttributeUInt64(self, request: Any, context: Any) -> Any:
        """Answer for the counters."""
        return Daqmx.GetReadAttributeUInt64Response(value=self._counter(request))

    @answered
    def GetReadAttributeUInt32(self, request: Any, context: Any) -> Any:
        """Answer for the samples available in the buffer."""
        return Daqmx.GetReadAttributeUInt32Response(value=self._counter(request))

    def _counter(self, request: Any) -> int:
        task, attribute = self.task(request), attribute_of(request)
        counters: dict[int, Callable[[], int]] = {
            _ACQUIRED: task.acquired,
            _AVAILABLE: lambda: max(0, task.acquired() - task.position),
            _POSITION: lambda: task.position,
            _CHANNELS: lambda: len(task.channels),
        }
        if attribute not in counters:
            raise Refusal(
                properties.UNKNOWN_ATTRIBUTE,
                f"Specified property is not supported: {attribute:#x}",
            )
        return counters[attribute]()

    @answered
    def GetReadAttributeBool(self, request: Any, context: Any) -> Any:
        """Answer whether a channel was overloaded, or is open, since last asked."""
        found = self._flagged(request, (_OVERLOADED_EXIST, _OPEN_EXIST))
        return Daqmx.GetReadAttributeBoolResponse(value=bool(found))

    @answered
    def GetReadAttributeString(self, request: Any, context: Any) -> Any:
        """Answer which channels were overloaded, or are open."""
        found = self._flagged(request, (_OVERLOADED, _OPEN))
        if attribute_of(request) == _CHANNELS_TO_READ:
            found = [channel.name for channel in self.task(request).channels]
        if attribute_of(request) == _OVERLOADED:
            self.task(request).overloaded.clear()
        return Daqmx.GetReadAttributeStringResponse(value=", ".join(found))

    def _flagged(self, request: Any, kinds: tuple[int, int]) -> list[str]:
        task, attribute = self.task(request), attribute_of(request)
        names = [channel.name for channel in task.channels]
        if attribute == kinds[0]:
            return [name for name in names if name in task.overloaded]
        if attribute == kinds[1]:
            return [c.name for c in task.channels if c.input in self._open]
        return []

    @answered
    def WaitUntilTaskDone(self, request: Any, context: Any) -> Any:
        """Wait for the last sample of a finite task."""
        task = self.task(request)
        if task.finite is not None:
            task.await_end(request.time_to_wait)
        return Daqmx.WaitUntilTaskDoneResponse()

    def RegisterEveryNSamplesEvent(self, request: Any, context: Any) -> Iterator[Any]:
        """Send an event for every n acquired samples, until the client disconnects."""
        context.send_initial_metadata(())
        task = self.tasks.get(request.task.name)
        sent = 0
        while task is not None and context.is_active():
            reached = task.acquired() // request.n_samples if task.running else sent
            for _ in range(sent, reached):
                yield Daqmx.RegisterEveryNSamplesEventResponse(
                    every_n_samples_event_type_raw=request.every_n_samples_event_type_raw,
                    n_samples=request.n_samples,
                )
            sent = max(sent, reached)
            self._pace.sleep(_EVENT_POLL)

    def RegisterDoneEvent(self, request: Any, context: Any) -> Iterator[Any]:
        """Send an event when a finite task is done."""
        context.send_initial_metadata(())
        task = self.tasks.get(request.task.name)
        while task is not None and context.is_active():
            if task.running and task.done():
                yield Daqmx.RegisterDoneEventResponse(status=0)
                return
            self._pace.sleep(_EVENT_POLL)

    @answered
    def IsTaskDone(self, request: Any, context: Any) -> Any:
        """Answer whether a finite task is done."""
        return Daqmx.IsTaskDoneResponse(is_task_done=self.task(request).done())


def _packed_field(number: int, size: int) -> bytes:
    """Return the head of a field of some bytes in protocol buffers' encoding."""
    head = bytearray([number << 3 | _LENGTH_DELIMITED])
    while size > 0x7F:
        head.append(size & 0x7F | 0x80)
        size >>= 7
    return bytes([*head, size])
