# SPDX-License-Identifier: MIT
"""A stream and the file that it is stored in, with one account of its samples."""

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace

from jointbench.acquisition.basics.errors import InstrumentError
from jointbench.acquisition.ni.driver import Chassis
from jointbench.acquisition.ni.stream import (
    Block,
    Counters,
    HardwareTrigger,
    NiStream,
    StreamGap,
)
from jointbench.acquisition.recorder.replies import Item
from jointbench.acquisition.recorder.requests import CreateFile, Setup
from jointbench.acquisition.session_file.live_read import LiveSpan
from jointbench.acquisition.session_file.live_write import LiveSession


class StoredStream:
    """Read, store, and report what was stored or is missing.

    Attributes:
        live: file; None before `create`.
        complete: whether all samples that were wanted are stored.
    """

    def __init__(self, setup: Setup, sleep: Callable[[float], None]) -> None:
        """Start a stream.

        Args:
            setup: what is streamed.
            sleep: waits for a lost device [s].

        Raises:
            InstrumentError: the device refuses, or does not answer.
        """
        self.live: LiveSession | None = None
        self._sleep, self._counters, self._next_segment = sleep, Counters(), 0
        self._stream: NiStream
        self._clock: bool
        self._left: int | None = None
        self._until: int | None = None
        self._open(setup)

    @property
    def sample_rate(self) -> float:
        """Actual rate of the device [Hz]."""
        return self._stream.sample_rate

    @property
    def in_step(self) -> bool:
        """Whether the device waits for its reader, who waits for the program."""
        return self._left is None and not self._clock

    @property
    def stored(self) -> int:
        """Samples per channel in the file."""
        return 0 if self.live is None else self.live.samples

    @property
    def counters(self) -> Counters:
        """Counters of the stream as they are now."""
        return replace(self._counters)

    def create(self, new: CreateFile) -> None:
        """Create the file; from now on `take` may be called.

        Raises:
            UsageError: it is there, or cannot be written.
        """
        self.live = LiveSession(
            new.path, new.meta, channels=self._channels, block=self._block
        )

    def change(self, setup: Setup) -> StreamGap | None:
        """Stream something else into the same file; return a gap as `pause` does.

        Raises:
            InstrumentError: the device refuses, or does not answer.
        """
        gap = self.pause()
        self.close()
        self._open(setup)
        return gap

    def take(self) -> Item:
        """Read the next item and store it.

        Raises:
            InstrumentError: device or disk refuse.
        """
        item = next(self._items)
        if isinstance(item, Block):
            return self._store(self._wanted(item))
        if isinstance(item, StreamGap):
            self.log(gap_entry(item))
        return item

    def lags(self) -> bool:
        """Return whether the device has made samples that are not stored yet.

        Those count that it had made when this was first asked.
        """
        if self._until is None:
            self._until = 0
            with suppress(InstrumentError):
                self._stream.count()
                self._until = self._counters.acquired
        return self._clock and self._stream.passed < self._until

    def pause(self) -> StreamGap | None:
        """Stop the stream on purpose; see `NiStream.pause`."""
        self._until = None
        return self._logged(self._stream.pause())

    def resume(self) -> None:
        """Start as soon as the device is available.

        Raises:
            InstrumentError: the device refuses, or does not return in time.
        """
        self._stream.resume()

    def trigger_by(self, trigger: HardwareTrigger) -> StreamGap | None:
        """Let the device detect hits; see `NiStream.trigger_by`."""
        self._until = None
        return self._logged(self._stream.trigger_by(trigger))

    def open_loops(self) -> tuple[str, ...]:
        """Return the channels with a disconnected cable or sensor, if reported."""
        return self._stream.open_loops()

    def log(self, entry: Mapping[str, object]) -> None:
        """Add an entry to the log of the file, if there is one.

        Raises:
            InstrumentError: the disk refuses.
        """
        if self.live is not None:
            self.live.log(entry)

    def settle(self) -> StreamGap | None:
        """Count for the last time; return the gap of what was overwritten.

        What the device makes after `lags` was asked is not wanted any more.
        """
        gap = self._stream.settle(ask=self._until is None)
        with suppress(InstrumentError):  # the disk; closing the file reports it
            self._logged(gap)
        return gap

    def log_account(self) -> None:
        """Log what the device has made, and what became of it.

        Raises:
            InstrumentError: the disk refuses.
        """
        counters = self._counters
        self.log(
            {
                "kind": "continuity",
                "acquired": counters.acquired,
                "unread": counters.unread,
                "unwanted": counters.unwanted,
                "stored_samples": self.stored,
                "lost": counters.lost,
            }
        )

    def close(self) -> None:
        """Stop the stream and leave the device."""
        self._stream.close()
        self._chassis.close()

    def _open(self, setup: Setup) -> None:
        self._channels = sum(len(sensor.axes) for sensor in setup.sensors)
        self._block, self._left = setup.settings.block, setup.samples
        self.complete, self._until = self._left == 0, None
        self._chassis = Chassis(setup.address)
        settings = replace(setup.settings, sleep=self._sleep)
        self._stream = NiStream(
            self._chassis,
            setup.sensors,
            settings,
            self._counters,
            segment=self._next_segment,
        )
        try:
            self._clock = self._chassis.has_clock()
            self._stream.start()
        except BaseException:
            self._chassis.close()
            raise
        self._items = self._stream.items()

    def _wanted(self, block: Block) -> Block:
        """Return a block without what is past the samples wanted; count that."""
        if self._left is None:
            return block
        past = max(0, block.samples.shape[1] - self._left)
        self._counters.delivered -= past
        self._counters.unwanted += past
        kept = block.samples[:, : block.samples.shape[1] - past]
        self._left -= kept.shape[1]
        self.complete = self._left == 0
        return replace(block, samples=kept)

    def _store(self, block: Block) -> LiveSpan:
        """Store a block; it is news once it is in the file."""
        assert self.live is not None, "create() comes first"
        stored, count = self.live.samples, block.samples.shape[1]
        self.live.append(block.samples, segment=block.segment, first=block.first)
        self.live.written()
        self._next_segment = block.segment + 1
        return LiveSpan(block.segment, block.first, stored, count)

    def _logged(self, gap: StreamGap | None) -> StreamGap | None:
        if gap is not None:
            self.log(gap_entry(gap))
        return gap


def gap_entry(gap: StreamGap) -> dict[str, object]:
    """Return the log entry of missing samples."""
    return {
        "kind": "gap",
        "what": gap.kind,
        "segment": gap.segment,
        "first_sample": gap.first,
        "samples": gap.samples,
        "seconds": round(gap.seconds, 3),
        "words": gap.words,
    }
