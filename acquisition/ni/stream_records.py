# SPDX-License-Identifier: MIT
"""Settings, items and counters of a stream."""

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
    """Missing samples between two blocks.

    Attributes:
        kind: ``"overrun"``, ``"lost"`` (the connection, just now), ``"back"``, or
            ``"rearmed"`` (the device had stopped and was started again).
        segment: number of the segment that ends or continues.
        first: index of the first sample that is missing in it.
        samples: number known to be missing.
        seconds: duration without samples [s]; 0 if not known yet.
        words: message of the driver.
    """

    kind: str
    segment: int
    first: int
    samples: int
    seconds: float
    words: str


@dataclass(frozen=True, slots=True)
class Waiting:
    """No samples yet: waiting for a trigger, or for late samples.

    Attributes:
        samples: number in the time waited.
    """

    samples: int


@dataclass(frozen=True, slots=True)
class HardwareTrigger:
    """A rising edge detected by the device.

    Attributes:
        channel: name of the trigger channel.
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
    """Settings of a stream.

    Attributes:
        sample_rate: requested [Hz].
        block: samples per channel of a block.
        buffer: seconds that the driver keeps until they are read [s].
        patience: longest wait for a lost connection, or for a device without samples
            [s].
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
    """Acquired and read samples, over all segments.

    Every sample that was acquired is delivered, unread, unwanted, or lost, and each
    lost one is in the `samples` of a `StreamGap`.

    Attributes:
        acquired: samples per channel acquired, by the counter of the device.
        unread: of those, in the buffer when the counter was read, or read and not yet
            yielded.
        delivered: samples per channel yielded.
        unwanted: of those acquired, left in the buffer when the stream was paused.
    """

    acquired: int = 0
    unread: int = 0
    delivered: int = 0
    unwanted: int = 0

    @property
    def lost(self) -> int:
        """Samples per channel that were acquired but neither read nor in the buffer."""
        return self.acquired - self.unread - self.unwanted - self.delivered
