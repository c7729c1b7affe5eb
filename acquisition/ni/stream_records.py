# SPDX-License-Identifier: MIT
"""What a stream is asked for, what it yields, and what it counts."""

import time
from collections.abc import Callable
from dataclasses import dataclass

from jointbench.acquisition.basics.arrays import FloatArray


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
class StreamGap:
    """What is missing between two blocks.

    Attributes:
        kind: ``"overrun"``, ``"lost"`` (the connection, just now), ``"back"``, or
            ``"rearmed"`` (the device had stopped and was started again).
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
    """Nothing has come: a trigger is looked for, or samples are late.

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
        patience: how long to wait for a connection that is lost, or for a device that
            makes no sample [s].
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
        unread: of those, still in its buffer when the counter was read, or read from
            it and not handed over.
        delivered: samples per channel handed over.
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
