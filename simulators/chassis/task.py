# SPDX-License-Identifier: MIT
"""One task of the simulated chassis: channels, clock, buffer, read position."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.simulators.chassis.protocol import DAQmxErrors, Refusal
from jointbench.simulators.measuring.converter import Digitiser

INPUT_RANGE = 5.0  # [V], either sign
BITS = 24
_LONGEST_SLEEP = 0.02  # [s] between polls of the clock
_NEVER = 2**63
# Samples searched for a trigger before a read's time-out is checked.
_SEARCH = 4096


@dataclass(frozen=True, slots=True)
class TaskChannel:
    """A virtual channel.

    Attributes:
        name: as the client called it.
        input: number of its input.
        sensitivity: set by the client [V per unit returned].
    """

    name: str
    input: int
    sensitivity: float


@dataclass(frozen=True, slots=True)
class Trigger:
    """An analogue edge that ends a finite task.

    Attributes:
        channel: index of the channel.
        level: [unit of the channel].
        before: samples kept before the edge.
        rising: direction of the edge.
    """

    channel: int
    level: float
    before: int
    rising: bool


@dataclass(frozen=True, slots=True)
class Pace:
    """Time base of the chassis.

    Attributes:
        speed: seconds of signal per second, infinite for as fast as it is read.
        now: clock [s].
        sleep: waits [s].
    """

    speed: float = 1.0
    now: Callable[[], float] = time.monotonic
    sleep: Callable[[float], None] = time.sleep


Volts = Callable[[int, int, list[int]], FloatArray]


class SimulatedTask:
    """State of one task; the service serialises the calls."""

    def __init__(self, name: str, pace: Pace, volts: Volts) -> None:
        self.name = name
        self.channels: list[TaskChannel] = []
        self.coupling: dict[str, int] = {}
        self.rate = 1000.0
        self.finite: int | None = None
        self.buffer = 0
        self.trigger: Trigger | None = None
        self.relative_to_first = False
        self.offset = 0
        self.overwrites = False
        self.overloaded: set[str] = set()
        self._pace, self._volts = pace, volts
        self._started: float | None = None
        self._position = 0
        self._end = _NEVER
        self._found_to = 1
        self._skipped = 0

    @property
    def running(self) -> bool:
        """Whether the task was started."""
        return self._started is not None

    @property
    def position(self) -> int:
        """Next sample that a read returns."""
        return self.offset if self.relative_to_first else self._position

    def start(self) -> None:
        """Start the clock at sample 0.

        Raises:
            Refusal: there is no channel.
        """
        if not self.channels:
            raise Refusal(
                DAQmxErrors.CAN_NOT_PERFORM_OP_WHEN_NO_CHANS_IN_TASK,
                "The task has no channels.",
            )
        self._started = self._pace.now()
        self._position = self._skipped = 0
        self._end, self._found_to = _NEVER, 1
        if self.finite is not None and self.trigger is None:
            self._end = self.finite
        self.overloaded.clear()

    def stop(self) -> None:
        """Stop the clock."""
        self._started = None

    def acquired(self) -> int:
        """Return how many samples per channel the converter has made so far."""
        if self._started is None:
            return self._position
        if math.isinf(self._pace.speed):
            looked = self._found_to - 1 if self.trigger is not None else 0
            return min(max(self._position, self._skipped, looked), self._end)
        elapsed = (self._pace.now() - self._started) * self._pace.speed
        return min(int(elapsed * self.rate), self._end)

    def skip_to(self, sample: int) -> None:
        """Advance the converter to a sample, read or not."""
        self._skipped = max(self._skipped, sample)

    def done(self) -> bool:
        """Return whether a finite task is done."""
        if self.trigger is not None and self._end == _NEVER and self.running:
            self._look()
        return self._end != _NEVER and (
            math.isinf(self._pace.speed) or self.acquired() >= self._end
        )

    def await_end(self, timeout: float) -> None:
        """Wait for the last sample of a finite task.

        Raises:
            Refusal: it does not come in time.
        """
        deadline = self._pace.now() + (timeout if timeout >= 0 else math.inf)
        while not self.done():
            if self._pace.now() >= deadline:
                raise Refusal(
                    DAQmxErrors.WAIT_UNTIL_DONE_DOES_NOT_INDICATE_DONE,
                    "Wait Until Done did not indicate that the task was done "
                    "within the specified timeout.",
                )
            self._pace.sleep(_LONGEST_SLEEP)

    def read(self, count: int, timeout: float) -> FloatArray:
        """Wait for samples and return them in the client's units, shape (n, count).

        Raises:
            Refusal: they do not come in time, are overwritten, or never come.
        """
        deadline = self._pace.now() + (timeout if timeout >= 0 else math.inf)
        if self.trigger is not None and self._end == _NEVER:
            self._await_trigger(deadline)
        self._await_samples(count, deadline)
        first = self.position
        if self.buffer and self.finite is None:
            self._require_kept(first)
        samples = self._samples(first, count)
        self._position = first + count
        return samples

    def _require_kept(self, first: int) -> None:
        """Refuse samples that are no longer in the buffer.

        Source:
            NI-DAQmx properties, OverWrite Mode.
        """
        if first >= self.acquired() - self.buffer:
            return
        if self.overwrites:
            raise Refusal(
                DAQmxErrors.SAMPLES_NO_LONGER_AVAILABLE,
                "The application is not able to keep up with the hardware "
                "acquisition: samples were overwritten before they were read.",
                read=0,
            )
        self.stop()
        raise Refusal(
            DAQmxErrors.ACQ_STOPPED_TO_PREVENT_INPUT_BUFFER_OVERWRITE,
            "Acquisition has been stopped to prevent an input buffer overwrite.",
            read=0,
        )

    def _await_samples(self, count: int, deadline: float) -> None:
        need = self.position + count
        if need > self._end:
            raise Refusal(
                DAQmxErrors.SAMPLES_WILL_NEVER_BE_AVAILABLE,
                "The specified number of samples will never be available.",
                read=0,
            )
        while not math.isinf(self._pace.speed):
            missing = (need - self.acquired()) / (self.rate * self._pace.speed)
            left = deadline - self._pace.now()
            if missing <= 0:
                return
            if left <= 0 or not self.running:
                raise Refusal(
                    DAQmxErrors.SAMPLES_NOT_YET_AVAILABLE,
                    "Some or all of the samples requested have not yet been acquired.",
                    read=0,
                )
            self._pace.sleep(min(max(missing, 1e-3), left, _LONGEST_SLEEP))

    def _await_trigger(self, deadline: float) -> None:
        """Search the acquired samples for the edge, and set the end of the task."""
        while not self._look():
            if self._pace.now() >= deadline:
                raise Refusal(
                    DAQmxErrors.SAMPLES_NOT_YET_AVAILABLE,
                    "The reference trigger did not occur within the timeout.",
                    read=0,
                )
            if not math.isinf(self._pace.speed):
                self._pace.sleep(_LONGEST_SLEEP)

    def _look(self) -> bool:
        """Search the new samples; return True once the edge is found."""
        fast = math.isinf(self._pace.speed)
        reach = self._found_to + _SEARCH if fast else self.acquired()
        if self.trigger is not None and reach > self._found_to:
            self._search(self.trigger, self._found_to - 1, reach)
            self._found_to = reach
        return self._end != _NEVER

    def _search(self, trigger: Trigger, first: int, past: int) -> None:
        sign = 1 if trigger.rising else -1
        signal = sign * self._samples(first, past - first)[trigger.channel]
        level = sign * trigger.level
        edges = (
            np.flatnonzero((signal[:-1] < level) & (signal[1:] >= level)) + 1 + first
        )
        edges = edges[edges >= trigger.before]
        if edges.size and self.finite is not None:
            begin = int(edges[0]) - trigger.before
            self._position = begin
            self._end = begin + self.finite

    def _samples(self, first: int, count: int) -> FloatArray:
        volts = self._volts(first, count, [channel.input for channel in self.channels])
        digitised = Digitiser(INPUT_RANGE, 0.0, BITS).round(volts)
        top = INPUT_RANGE * (1 - 2.0 ** (2 - BITS))
        for row, channel in zip(digitised, self.channels, strict=True):
            if float(np.abs(row).max(initial=0.0)) >= top:
                self.overloaded.add(channel.name)
            row /= channel.sensitivity
        return digitised
