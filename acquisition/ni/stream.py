# SPDX-License-Identifier: MIT
"""Continuous acquisition that survives its cable: blocks, and the gaps between."""

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field

from jointbench.acquisition.arrays import FloatArray
from jointbench.acquisition.errors import InstrumentError
from jointbench.acquisition.ni.answers import ConnectionLost, Overrun
from jointbench.acquisition.ni.driver import AnalogTask, Chassis
from jointbench.acquisition.ni.sensors import Sensor

_RETRY = 0.2  # [s] between attempts to come back


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """Successive samples of one segment.

    Attributes:
        samples: SI units, shape (n_channels, n).
        segment: number of the uninterrupted task they come from, from 0.
        first: index of the first of them since that task began.
    """

    samples: FloatArray
    segment: int
    first: int


@dataclass(frozen=True, slots=True)
class Gap:
    """What is missing between two blocks.

    Attributes:
        kind: ``"overrun"``, ``"lost"`` (the connection, just now) or ``"back"``.
        segment: number of the segment that ends or goes on.
        first: index of the first sample that is missing in it.
        samples: how many are known to be missing.
        seconds: how long nothing was measured [s]; 0 where that is not known yet.
        words: what the driver said.
    """

    kind: str
    segment: int
    first: int
    samples: int
    seconds: float
    words: str


@dataclass(frozen=True, slots=True)
class Waiting:
    """A device that looks for its trigger has found none yet.

    Attributes:
        samples: how many fit into the time just waited.
    """

    samples: int


@dataclass(frozen=True, slots=True)
class HardwareTrigger:
    """A rising edge that the device itself looks for.

    Attributes:
        channel: name of the channel that triggers.
        level: [SI unit of the channel].
        before: samples kept before the edge.
        samples: of the whole block.
    """

    channel: str
    level: float
    before: int
    samples: int


@dataclass(frozen=True, slots=True)
class StreamSettings:
    """How to stream.

    Attributes:
        sample_rate: asked for [Hz].
        block: samples per channel of a block.
        buffer: seconds that the driver keeps until they are read [s].
        patience: how long to wait for a connection that is lost [s].
        now: clock [s].
        sleep: waits [s].
    """

    sample_rate: float
    block: int
    buffer: float = 20.0
    patience: float = 120.0
    now: Callable[[], float] = time.monotonic
    sleep: Callable[[float], None] = time.sleep


@dataclass(slots=True)
class Counters:
    """What the device made against what was read, over all segments.

    Attributes:
        acquired: samples per channel made by the device, as its counter says.
        unread: of those, still in its buffer when the counter was read.
        delivered: samples per channel read.
        unwanted: of those made, left in the buffer when the stream was paused.
    """

    acquired: int = 0
    unread: int = 0
    delivered: int = 0
    unwanted: int = 0

    @property
    def lost(self) -> int:
        """Samples per channel that were made, are not waiting, and were not read."""
        return self.acquired - self.unread - self.unwanted - self.delivered


@dataclass(slots=True)
class NiStream:
    """A stream of blocks and gaps from a chassis.

    Attributes:
        chassis: an open one.
        sensors: the channel table.
        settings: rate, block, patience.
        counters: kept up to date while the stream is read.
        sample_rate: at which the device really runs [Hz]; 0 before `start`.
    """

    chassis: Chassis
    sensors: Sequence[Sensor]
    settings: StreamSettings
    counters: Counters = field(default_factory=Counters)
    sample_rate: float = 0.0
    _task: AnalogTask | None = None
    _segment: int = 0
    _position: int = 0
    _made_before: int = 0
    _trigger: HardwareTrigger | None = None

    def start(self) -> None:
        """Make the task and start its clock.

        Raises:
            InstrumentError: a channel or the rate is refused, or nobody answers.
        """
        task = self.chassis.task(f"jointbench-{self._segment}", self.sensors)
        try:
            self.sample_rate = _begin(task, self.settings, self._trigger)
        except InstrumentError:
            task.close()
            raise
        self._task, self._position = task, 0
        self._made_before = self.counters.acquired

    def trigger_by(self, trigger: HardwareTrigger) -> None:
        """Let the device look for hits from now on; each is a segment of its own.

        Raises:
            InstrumentError: it cannot, or does not come back.
        """
        if trigger == self._trigger:
            return
        self.pause()
        self._trigger = trigger
        self.resume()

    def pause(self) -> None:
        """Stop on purpose; what the device has made and nobody read is not wanted."""
        with suppress(InstrumentError):
            self.count()
        self.counters.unwanted += self.counters.unread
        self.counters.unread = 0
        self.close()
        self._segment += 1

    def resume(self) -> None:
        """Start, as soon as the device is there.

        Raises:
            InstrumentError: the device refuses, or does not come back in time.
        """
        settings = self.settings
        since = settings.now()
        while True:
            try:
                return self.start()
            except ConnectionLost as error:
                if settings.now() - since > settings.patience:
                    raise InstrumentError(
                        f"{error}; gave up after {settings.patience:g} s, what was "
                        "recorded is safe"
                    ) from error
                settings.sleep(_RETRY)

    def items(self) -> Iterator[Block | Gap | Waiting]:
        """Yield blocks and gaps for as long as the stream is read.

        Raises:
            InstrumentError: the device refuses for another reason than those two, or
                does not come back.
        """
        while True:
            try:
                yield self._read()
            except Overrun as error:
                yield from self._overrun(str(error))
            except ConnectionLost as error:
                yield Gap("lost", self._segment, self._position, 0, 0.0, str(error))
                yield self._reconnect(str(error))

    def open_loops(self) -> tuple[str, ...]:
        """Return the channels whose cable or sensor is off, if the device can tell."""
        try:
            return () if self._task is None else self._task.open_loops()
        except InstrumentError:
            return ()

    def count(self) -> None:
        """Bring the counters up to date with the device's own.

        A device that looks for its trigger makes samples that nobody wants; there, a
        block is whole or an error.
        """
        if self._task is not None and self._trigger is None:
            acquired, position = self._task.acquired(), self._task.position()
            self.counters.acquired = self._made_before + max(acquired, position)
            self.counters.unread = max(0, acquired - position)

    def close(self) -> None:
        """Stop the task, if it is still there."""
        if self._task is not None:
            self._task.close()
            self._task = None

    def _read(self) -> Block | Waiting:
        assert self._task is not None, "start() comes first"
        if self._trigger is not None:
            return self._read_triggered(self._task, self._trigger)
        count = self.settings.block
        samples = self._task.read(count, timeout=count / self.sample_rate + 5.0)
        return self._took(samples)

    def _read_triggered(
        self, task: AnalogTask, trigger: HardwareTrigger
    ) -> Block | Waiting:
        if not task.done():
            self.settings.sleep(self.settings.block / self.sample_rate)
            return Waiting(self.settings.block)
        block = self._took(task.read(trigger.samples, timeout=5.0))
        # The next one is armed before anybody is asked to hit.
        self.close()
        self._segment += 1
        self.resume()
        return block

    def _took(self, samples: FloatArray) -> Block:
        block = Block(samples, self._segment, self._position)
        self._position += samples.shape[1]
        self.counters.delivered += samples.shape[1]
        made = self._made_before + self._position
        self.counters.acquired = max(self.counters.acquired, made)
        return block

    def _overrun(self, words: str) -> Iterator[Block | Gap]:
        """Go on at a sample that is still there, and say what lies between."""
        assert self._task is not None
        newest = self._task.acquired()
        # The newest quarter of the buffer is safe from being overwritten meanwhile.
        keep = round(0.25 * self.settings.buffer * self.sample_rate)
        resume = max(self._position, newest - keep)
        if resume == self._position:
            resume = newest
        samples = self._task.resume_at(
            resume,
            self.settings.block,
            timeout=self.settings.block / self.sample_rate + 5.0,
        )
        lost, first = resume - self._position, self._position
        seconds = lost / self.sample_rate
        gap = Gap("overrun", self._segment, first, lost, seconds, words)
        self._position = resume
        self.counters.acquired = max(
            self.counters.acquired, self._made_before + self._position
        )
        # Counted before it is told: whoever is told may stop the stream.
        block = self._took(samples)
        yield gap
        yield block

    def _reconnect(self, words: str) -> Gap:
        since, first = self.settings.now(), self._position
        self.close()
        self._segment += 1
        self.resume()
        away = self.settings.now() - since
        return Gap("back", self._segment, first, 0, away, words)


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
