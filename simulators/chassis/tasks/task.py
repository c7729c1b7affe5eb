# SPDX-License-Identifier: MIT
"""One task: its channels and properties, and the states that NI-DAQmx gives it.

Source:
    NI-DAQmx help, Task State Model: unverified, verified, reserved, committed, running.
"""

import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from enum import IntEnum

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.simulators.chassis.modules.inventory import Device
from jointbench.simulators.chassis.property_values import PropertyValues
from jointbench.simulators.chassis.protocol import DAQmxErrors, Refusal, constants
from jointbench.simulators.chassis.tasks import task_defaults
from jointbench.simulators.chassis.tasks.acquisition import Acquisition, Course, Pace
from jointbench.simulators.chassis.tasks.channel_names import listed_names
from jointbench.simulators.chassis.tasks.reservations import Reservations
from jointbench.simulators.chassis.tasks.signals import Signals, digitised
from jointbench.simulators.chassis.tasks.trigger_plan import trigger_plan
from jointbench.simulators.chassis.tasks.verification import (
    coerced_rate,
    require_clock,
    terminal,
    verify_channels,
    verify_mode,
    verify_samples,
)
from jointbench.simulators.chassis.tasks.virtual_channels import VirtualChannel

# Most bytes of a buffer, which is never allocated here, and of a read, which is.
_MOST_BUFFERED = 2**32
MOST_READ = 2**28
_BYTES = 8
_FINITE = int(constants.AcquisitionType.FINITE.value)
_ON_DEMAND = int(constants.SampleTimingType.ON_DEMAND.value)
_OVERWRITES = constants.OverwriteMode.OVERWRITE_UNREAD_SAMPLES.value


class TaskState(IntEnum):
    """State of a task, in NI's order."""

    UNVERIFIED = 0
    VERIFIED = 1
    RESERVED = 2
    COMMITTED = 3
    RUNNING = 4


@dataclass(frozen=True, slots=True)
class SharedBench:
    """What tasks share.

    Attributes:
        pace: time base.
        signals: at the inputs.
        devices: all of them.
        reservations: who holds which device.
        running: names of the running tasks.
        open_inputs: numbers of the inputs whose IEPE loop is open.
    """

    pace: Pace
    signals: Signals
    devices: tuple[Device, ...] = ()
    reservations: Reservations = field(default_factory=Reservations)
    running: set[str] = field(default_factory=set)
    open_inputs: set[int] = field(default_factory=set)


class SimulatedTask:
    """State of one task; the service serialises its changes by `guard`."""

    def __init__(self, name: str, bench: SharedBench) -> None:
        self.name = name
        self.channels: list[VirtualChannel] = []
        self.timing = PropertyValues(task_defaults.TIMING)
        self.triggers = PropertyValues(task_defaults.TRIGGER)
        self.reading = PropertyValues(task_defaults.READ)
        self.buffers = PropertyValues(task_defaults.BUFFER)
        self.exports = PropertyValues(task_defaults.EXPORT)
        self.overloaded: set[str] = set()
        self.events: dict[str, int] = {}
        self.streams: dict[str, object] = {}
        self.state = TaskState.UNVERIFIED
        self.acquisition: Acquisition | None = None
        self.started_by_read = False
        self.guard = threading.RLock()
        self._bench = bench
        self._before = TaskState.UNVERIFIED

    @property
    def running(self) -> bool:
        """Whether the task was started."""
        return self.state is TaskState.RUNNING

    @property
    def clocked(self) -> bool:
        """Whether it has a sample clock."""
        return self.timing.whole("SAMP_TIMING_TYPE") != _ON_DEMAND

    @property
    def finite(self) -> int | None:
        """Samples of a block, None for a task that runs until it is stopped."""
        if not self.clocked or self.timing.whole("SAMP_QUANT_SAMP_MODE") != _FINITE:
            return None
        return self.timing.whole("SAMP_QUANT_SAMP_PER_CHAN")

    @property
    def open_loops(self) -> list[str]:
        """Names of the channels whose IEPE loop is open."""
        inputs = self._bench.open_inputs
        return [c.name for c in self.channels if c.input.number in inputs]

    @property
    def devices(self) -> list[Device]:
        """Devices of its channels, each once."""
        found = {
            channel.input.device.name: channel.input.device for channel in self.channels
        }
        return list(found.values())

    @property
    def rate(self) -> float:
        """Rate of the sample clock as the modules take it [Hz]."""
        return coerced_rate(self.channels, self.timing.number("SAMP_CLK_RATE"))

    @property
    def buffer(self) -> int:
        """Size of the input buffer [samples per channel]."""
        if self.buffers.changed("INPUT_BUF_SIZE"):
            return self.buffers.whole("INPUT_BUF_SIZE")
        if not self.clocked:
            return 0
        stated = self.timing.changed("SAMP_CLK_RATE")
        samples = self.timing.whole("SAMP_QUANT_SAMP_PER_CHAN")
        rate = self.timing.number("SAMP_CLK_RATE") if stated else None
        return task_defaults.default_buffer(
            rate, samples, finite=self.finite is not None
        )

    def terminal(self, named: str) -> str:
        """Return the full name of a terminal.

        Raises:
            Refusal: no device has it.
        """
        return terminal(self.devices[0], self._bench.devices, named)

    def change(self) -> None:
        """Prepare for a change of channels or properties.

        Raises:
            Refusal: the task is running.
        """
        if self.running:
            raise Refusal(
                DAQmxErrors.CANNOT_SET_PROPERTY_WHEN_TASK_RUNNING,
                "Specified property cannot be set while the task is running.\n\n"
                "Set the property prior to starting the task, or stop the task prior "
                "to setting the property.",
            )
        self._unreserve()
        self.state = TaskState.UNVERIFIED

    def verify(self) -> Course:
        """Check everything against the hardware and return what a start would do.

        Raises:
            Refusal: the hardware cannot do it.
        """
        verify_channels(self.channels)
        rate = 1000.0
        if self.clocked:
            verify_mode(self.timing, self.devices)
            verify_samples(self.timing)
            rate = self.rate
            source = self.timing.text("SAMP_CLK_SRC")
            if source and source != "OnboardClock":
                self.terminal(source)
        else:
            require_clock(self.channels)
        self._verify_buffer()
        plan = trigger_plan(
            self.triggers,
            self.channels,
            clocked=self.clocked,
            finite=self.finite,
            terminal=self.terminal,
        )
        overwrites = self.reading.whole("OVERWRITE") == _OVERWRITES
        return Course(
            rate=rate,
            finite=self.finite,
            buffer=self.buffer,
            overwrites=overwrites,
            triggers=plan,
            clocked=self.clocked,
        )

    def _verify_buffer(self) -> None:
        if self.buffers.changed("INPUT_BUF_SIZE") and not self.clocked:
            raise Refusal(
                DAQmxErrors.BUFFER_WITH_ON_DEMAND_SAMP_TIMING,
                "Buffered operations cannot use On Demand for Sample Timing.",
            )
        every = self.events.get("every_n", 0)
        # The driver chooses the buffer of a continuous task as a multiple.
        fixed = self.finite is not None or self.buffers.changed("INPUT_BUF_SIZE")
        if fixed and every and self.buffer % every:
            raise Refusal(
                DAQmxErrors.BUFFER_SIZE_NOT_MULTIPLE_OF_EVERY_N_SAMPS_EVENT_INTERVAL_WHEN_DMA,
                "Buffer size in samples per channel must be a multiple of the interval "
                "of the Every N Samples event.\n\n"
                f"Buffer Size: {self.buffer}\nEvery N Samples Event Interval: {every}",
            )
        if self.reading.whole("LOGGING_MODE") != constants.LoggingMode.OFF.value:
            raise Refusal(
                DAQmxErrors.MEASUREMENT_TYPE_NOT_SUPPORTED_FOR_LOGGING,
                "Logging is not supported: the simulated chassis writes no files.",
            )

    def reach(self, state: TaskState) -> Course:
        """Take a task that is not running to a state, through those before.

        Raises:
            Refusal: the hardware cannot do it, or another task holds it.
        """
        course = self.verify()
        if state >= TaskState.RESERVED:
            self._require_memory(course)
            self._bench.reservations.take(self, self.devices)
        self.state = max(self.state, state)
        return course

    def _require_memory(self, course: Course) -> None:
        samples = max(course.buffer, course.finite or 0)
        if samples * len(self.channels) * _BYTES > _MOST_BUFFERED:
            raise no_memory()

    def start(self) -> None:
        """Start the clock at sample 0.

        Raises:
            Refusal: it is running, the hardware cannot do it, or another task holds it.
        """
        if self.running:
            raise Refusal(
                DAQmxErrors.CAN_NOT_PERFORM_OP_WHILE_TASK_RUNNING,
                "Specified operation cannot be performed while the task is running.",
            )
        self._before = self.state
        course = self.reach(TaskState.COMMITTED)
        if not self._bench.running:
            self._bench.signals.begin(course.rate)
        self.overloaded.clear()
        self.acquisition = Acquisition(course, self._bench.pace, self._volts)
        self.started_by_read = False
        self._bench.running.add(self.name)
        self.state = TaskState.RUNNING

    def stop(self) -> None:
        """Stop the clock and return to the state before the start."""
        if self.running:
            self._bench.running.discard(self.name)
            self.state = max(self._before, TaskState.VERIFIED)
        if self.state < TaskState.RESERVED:
            self._bench.reservations.release(self)

    def unreserve(self) -> None:
        """Release the hardware.

        Raises:
            Refusal: the task is running.
        """
        if self.running:
            raise Refusal(
                DAQmxErrors.CAN_NOT_PERFORM_OP_WHILE_TASK_RUNNING,
                "Specified operation cannot be performed while the task is running.",
            )
        self._unreserve()

    def abort(self) -> None:
        """Stop at once and release the hardware."""
        self.stop()
        self._unreserve()

    def _unreserve(self) -> None:
        self.state = min(self.state, TaskState.VERIFIED)
        self._bench.reservations.release(self)

    def read_channels(self) -> list[int]:
        """Return the indices of the channels that a read returns.

        Raises:
            Refusal: the task has no such channel.
        """
        wanted = self.reading.text("CHANNELS_TO_READ")
        if not wanted:
            return list(range(len(self.channels)))
        return [self.index(name) for name in self._listed(wanted)]

    def index(self, name: str) -> int:
        """Return the index of a channel by its name.

        Raises:
            Refusal: the task has none of this name.
        """
        names = [channel.name.lower() for channel in self.channels]
        if name.strip().lower() not in names:
            raise Refusal(
                DAQmxErrors.INVALID_CHANNEL,
                "Channel specified does not exist in the task.\n\n"
                f"Channel Name: {name}",
            )
        return names.index(name.strip().lower())

    def named(self, names: str) -> list[VirtualChannel]:
        """Return the channels of a list of names; all of them for an empty one."""
        if not names:
            return list(self.channels)
        return [self.channels[self.index(name)] for name in self._listed(names)]

    def _listed(self, names: str) -> list[str]:
        known = {channel.name.lower() for channel in self.channels}
        # No list is longer than the channels there are; one more is refused.
        return listed_names(names, at_most=len(known) + 1, known=known)

    def _volts(self, first: int, count: int) -> FloatArray:
        volts = self._bench.signals.volts(first, count, self.channels)
        return digitised(volts, self.channels, self.overloaded)


def no_memory() -> Refusal:
    """Return the refusal of more values than a computer holds."""
    return Refusal(
        DAQmxErrors.PAL_MEMORY_FULL,
        "The requested memory could not be allocated.\n\nReduce the number of samples "
        "or of channels.",
    )


NewTask = Callable[[str], SimulatedTask]
