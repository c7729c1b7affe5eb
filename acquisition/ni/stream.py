# SPDX-License-Identifier: MIT
"""Continuous acquisition with reconnection: blocks, and the gaps between."""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import InstrumentError
from jointbench.acquisition.ni.driver import AnalogTask, Chassis
from jointbench.acquisition.ni.driver_answers import (
    ConnectionLost,
    NotYet,
    Overrun,
    Stopped,
)
from jointbench.acquisition.ni.oldest_sample import read_oldest
from jointbench.acquisition.ni.sensors import Sensor
from jointbench.acquisition.ni.stream_records import (
    Block,
    Counters,
    HardwareTrigger,
    StreamGap,
    StreamSettings,
    Waiting,
)

__all__ = [
    "Block",
    "Counters",
    "HardwareTrigger",
    "NiStream",
    "StreamGap",
    "StreamSettings",
    "Waiting",
]

_RETRY = 0.2  # [s] between attempts to reconnect
_GRACE = 5.0  # [s] extra time for samples to arrive
_MOST_VALUES = 2**19  # of all channels in one read: 4 MB


@dataclass(slots=True)
class NiStream:
    """A stream of blocks and gaps from a chassis.

    Attributes:
        chassis: an open one.
        sensors: the channel table.
        settings: rate, block, time limits.
        counters: kept up to date while the stream is read.
        sample_rate: actual rate of the device [Hz]; 0 before `start`.
        segment: number of the uninterrupted task that is read.
    """

    chassis: Chassis
    sensors: Sequence[Sensor]
    settings: StreamSettings
    counters: Counters = field(default_factory=Counters)
    sample_rate: float = 0.0
    segment: int = 0
    _task: AnalogTask | None = None
    _position: int = 0
    _made_before: int = 0
    _trigger: HardwareTrigger | None = None
    _moved: bool = False
    _made: int = 0
    _progress: float = 0.0
    _asked: float = 0.0
    _late_reader: bool = True
    _read_to: int = 0

    def start(self) -> None:
        """Create the task and start its clock.

        Raises:
            InstrumentError: a channel or the rate is refused, or there is no answer.
        """
        task = self.chassis.task(f"jointbench-{self.segment}", self.sensors)
        try:
            self.sample_rate = _begin(task, self.settings, self._trigger)
        except InstrumentError:
            task.close()
            raise
        self._task, self._moved, self._made = task, False, 0
        self._position = self._read_to = 0
        self._made_before = self.counters.acquired

    def trigger_by(self, trigger: HardwareTrigger) -> StreamGap | None:
        """Detect hits on the device from now on; each is a separate segment.

        Returns:
            As `pause`.

        Raises:
            InstrumentError: it cannot, or does not return.
        """
        if trigger == self._trigger:
            return None
        gap = self.pause()
        self._trigger = trigger
        self.resume()
        return gap

    def pause(self) -> StreamGap | None:
        """Stop on purpose; unread samples are discarded.

        Returns:
            The gap of those that were overwritten before.
        """
        gap = self.settle()
        self.counters.unwanted += self.counters.unread
        self.counters.unread = 0
        self.close()
        self.segment += 1
        return gap

    def resume(self) -> None:
        """Start as soon as the device is available.

        Raises:
            InstrumentError: the device refuses, or does not return in time.
        """
        self._come_back((ConnectionLost, NotYet, Stopped))

    def _come_back(self, awaited: tuple[type[InstrumentError], ...]) -> None:
        """Start as soon as possible; only the expected errors are waited out."""
        settings = self.settings
        since = settings.now()
        while True:
            try:
                return self.start()
            except awaited as error:
                if settings.now() - since > settings.patience:
                    raise InstrumentError(
                        f"{error}; gave up after {settings.patience:g} s, what was "
                        "recorded is safe"
                    ) from error
                settings.sleep(_RETRY)

    def items(self) -> Iterator[Block | StreamGap | Waiting]:
        """Yield blocks and gaps for as long as the stream is read.

        Unread samples are read at once and passed on block by block, so that a delayed
        reader catches up.

        Raises:
            InstrumentError: the device refuses for a reason that only the operator can
                remove, does not return, or acquires no samples.
        """
        self._progress = self.settings.now()
        while True:
            try:
                yield from self._next()
            except Stopped as error:
                yield from self._rearm(str(error))
            except ConnectionLost as error:
                # What the device is known to have acquired is out of reach.
                lost = self.counters.acquired - self.passed
                yield StreamGap(
                    "lost", self.segment, self._position, lost, 0.0, str(error)
                )
                self._position += lost
                yield self._reconnect(str(error))

    def open_loops(self) -> tuple[str, ...]:
        """Return the channels with a disconnected cable or sensor, if reported."""
        try:
            return () if self._task is None else self._task.open_loops()
        except InstrumentError:
            return ()

    @property
    def passed(self) -> int:
        """Samples acquired up to the next one to read, over all segments."""
        return self._made_before + self._position

    def count(self) -> None:
        """Update the counters from the device.

        A device that waits for its trigger acquires samples that are not used; there, a
        block is complete or an error.
        """
        if self._task is not None and self._trigger is None:
            acquired = max(self._task.acquired(), self._position)
            self._seen(acquired)
            self.counters.unread = acquired - self._position

    def settle(self, *, ask: bool = True) -> StreamGap | None:
        """Count, and return the gap of what was overwritten since the last read.

        Args:
            ask: for the device's counter. Otherwise, and without an answer, unread is
                what the device was known to have acquired.
        """
        if self._task is None or self._trigger is not None:
            return None
        self.counters.unread = self.counters.acquired - self.passed
        with suppress(InstrumentError):
            if ask:
                self.count()
            return self._overwritten(self._task.buffer())
        return None

    def _overwritten(self, buffer: int) -> StreamGap | None:
        unread = self.counters.unread
        lost = unread - (self._read_to - self._position) - buffer
        if lost <= 0:
            return None
        self.counters.unread = unread - lost
        words = "overwritten in the buffer before the stream was stopped"
        return replace(self._gap("overrun", lost, words), first=self._read_to)

    def _gap(self, kind: str, lost: int, words: str) -> StreamGap:
        """Return the gap of samples that are lost from the next one on."""
        seconds = lost / self.sample_rate
        return StreamGap(kind, self.segment, self._position, lost, seconds, words)

    def _seen(self, acquired: int) -> None:
        """Note the device's counter of this segment."""
        made = self._made_before + acquired
        self.counters.acquired = max(self.counters.acquired, made)

    def close(self) -> None:
        """Stop the task, if it still exists."""
        if self._task is not None:
            self._task.close()
            self._task = None

    def _next(self) -> Iterator[Block | StreamGap | Waiting]:
        try:
            yield from self._read()
        except Overrun as error:
            yield from self._overrun(str(error))
        except NotYet as error:
            yield self._late(str(error))

    def _read(self) -> Iterator[Block | Waiting]:
        assert self._task is not None, "start() comes first"
        if self._trigger is not None:
            yield self._read_triggered(self._task, self._trigger)
            return
        block = self.settings.block
        count = max(1, self._waiting(self._task) // block) * block
        if self._moved:
            samples = self._task.resume_at(
                self._position, count, timeout=self._timeout(count)
            )
            self._moved = False
        else:
            samples = self._task.read(count, timeout=self._timeout(count))
        yield from self._blocks(samples)

    def _waiting(self, task: AnalogTask) -> int:
        """Return the number of samples to read at once; 0 for at most one block.

        The device is queried once per block time, and as long as there is more.
        """
        now, block = self.settings.now(), self.settings.block
        if not self._late_reader and now - self._asked < block / self.sample_rate:
            return 0
        available = task.available()
        self._seen(self._position + available)
        waiting = self._at_once(available)
        self._asked, self._late_reader = now, waiting > block
        return waiting

    def _at_once(self, waiting: int) -> int:
        """Return how many of the unread samples are read at once."""
        channels = sum(len(sensor.axes) for sensor in self.sensors)
        return min(waiting, _MOST_VALUES // channels)

    def _timeout(self, count: int) -> float:
        return count / self.sample_rate + _GRACE

    def _blocks(self, samples: FloatArray) -> Iterator[Block]:
        """Yield the samples read; the caller may pause the stream meanwhile."""
        segment, size = self.segment, self.settings.block
        self._read_to = self._position + samples.shape[1]
        for first in range(0, samples.shape[1], size):
            yield self._took(samples[:, first : first + size])
            if self.segment != segment:
                return

    def _read_triggered(
        self, task: AnalogTask, trigger: HardwareTrigger
    ) -> Block | Waiting:
        if not task.done():
            self.settings.sleep(self.settings.block / self.sample_rate)
            self._progress = self.settings.now()
            return Waiting(self.settings.block)
        block = self._took(task.read(trigger.samples, timeout=_GRACE))
        # The next block is armed before a hit is requested.
        self.close()
        self.segment += 1
        self.resume()
        return block

    def _took(self, samples: FloatArray) -> Block:
        # Counted before it is yielded: the caller may stop the stream.
        block = Block(samples, self.segment, self._position)
        self._position += samples.shape[1]
        self._progress = self.settings.now()
        self.counters.delivered += samples.shape[1]
        self._seen(self._position)
        return block

    def _overrun(self, words: str) -> Iterator[Block | StreamGap]:
        """Continue at the oldest sample in the buffer; yield the gap before it."""
        assert self._task is not None
        most = self._at_once(self._task.buffer())
        resume, samples = read_oldest(
            self._task, self._position, most, timeout=self._timeout(most)
        )
        gap = self._gap("overrun", resume - self._position, words)
        self._position, self._late_reader = resume, True
        self._read_to = resume + samples.shape[1]
        self._seen(self._read_to)
        segment = self.segment
        yield gap
        if self.segment == segment:
            yield from self._blocks(samples)

    def _late(self, words: str) -> Waiting:
        """Wait for late samples, as long as the task can acquire them.

        Raises:
            Stopped: the task has ended.
            InstrumentError: the device has acquired no sample for too long.
        """
        assert self._task is not None
        settings, made = self.settings, self._task.acquired()
        if self._task.done():
            raise Stopped(words)
        if made != self._made:
            self._made, self._progress = made, settings.now()
        elif settings.now() - self._progress > settings.patience:
            raise InstrumentError(
                f"{words}; no sample for {settings.patience:g} s, what was recorded is "
                "safe: check the clock and the trigger of the device"
            )
        # A read that fails may have consumed the available samples.
        self._moved = self._task.position() != self._position
        return Waiting(0)

    def _rearm(self, words: str) -> Iterator[Block | StreamGap]:
        """Save the samples of the stopped task, and start another.

        Raises:
            InstrumentError: the device stops repeatedly.
        """
        settings, since = self.settings, self.settings.now()
        if since - self._progress > settings.patience:
            raise InstrumentError(
                f"{words}; the device made no sample for {settings.patience:g} s, what "
                "was recorded is safe: lower the rate, or free the computer"
            )
        segment = self.segment
        yield from self._leftover()
        if self.segment != segment:
            return
        self.counters.unread = self.counters.acquired - self.passed
        with suppress(InstrumentError):
            self.count()
        lost, first = self.counters.unread, self._position
        self.counters.unread = 0
        self.close()
        self.segment += 1
        if first == 0:
            settings.sleep(_RETRY)
        self.resume()
        away = settings.now() - since + lost / self.sample_rate
        yield StreamGap("rearmed", segment, first, lost, away, words)

    def _leftover(self) -> Iterator[Block | StreamGap]:
        """Yield the remaining samples of a stopped task, and what was overwritten."""
        segment, before = self.segment, -1
        while self.segment == segment and self.passed > before:
            before = self.passed
            try:
                yield from self._still_there()
            except InstrumentError:
                return

    def _still_there(self) -> Iterator[Block | StreamGap]:
        if self._task is None or self._trigger is not None:
            return
        waiting = self._at_once(self._task.available())
        try:
            samples = self._task.read(waiting, timeout=0.0) if waiting else None
        except Overrun as error:
            yield from self._overrun(str(error))
        else:
            if samples is not None:
                yield from self._blocks(samples)

    def _reconnect(self, words: str) -> StreamGap:
        since, first = self.settings.now(), self._position
        self.close()
        self.segment += 1
        # The device has run with this table: a refusal now may be temporary after
        # switching on.
        self._come_back((InstrumentError,))
        away = self.settings.now() - since
        return StreamGap("back", self.segment, first, 0, away, words)


def _begin(
    task: AnalogTask, settings: StreamSettings, trigger: HardwareTrigger | None
) -> float:
    """Start the clock of a task and return its rate [Hz]."""
    if trigger is None:
        buffer = round(settings.buffer * settings.sample_rate)
        return task.start(settings.sample_rate, buffer=max(buffer, 4 * settings.block))
    return task.start_triggered(
        settings.sample_rate,
        samples=trigger.samples,
        source=trigger.channel,
        before=trigger.before,
        level=trigger.level,
    )
