# SPDX-License-Identifier: MIT
"""Hammer hits in a running stream: the software trigger of the bench."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.records.recordings import Channel, Hit, Recording
from jointbench.signal.hits.find_hits import trigger_indices
from jointbench.signal.hits.hit_verdicts import HitLimits, judge

_REARM = 0.5  # of the level, as in `HitCriteria`


@dataclass(frozen=True, slots=True, eq=False)
class CutHit:
    """The samples around one trigger.

    Attributes:
        samples: all channels, shape (n_channels, n).
        start: index of the first of them in the stream.
        trigger: index of the triggering sample in `samples`.
        whole: False if the stream stopped before the end.
    """

    samples: FloatArray
    start: int
    trigger: int
    whole: bool

    def __post_init__(self) -> None:
        """Make the samples read-only."""
        freeze(self, "samples")

    @property
    def count(self) -> int:
        """Number of samples of each channel."""
        return int(self.samples.shape[1])


@dataclass(slots=True)
class HitCutter:
    """Cut hits out of a stream, block by block, independent of the block limits.

    A hit fires at the sample where ``previous < level <= sample``; after a hit the
    trigger is armed again once its block is complete and the force is low.

    Attributes:
        row: of the force channel.
        level: of the trigger [N].
        before: samples kept before the trigger.
        after: samples kept from the trigger on.
        offset: of the force channel [N], subtracted before the comparison.
        origin: index in the stream of the first sample that will be fed.
    """

    row: int
    level: float
    before: int
    after: int
    offset: float = 0.0
    origin: int = 0
    _data: FloatArray | None = None
    _from: int = 0
    _trigger: int | None = None

    def feed(self, samples: FloatArray) -> CutHit | None:
        """Process a block; return the hit that it completes, if any.

        A block completes at most one hit: blocks are shorter than hits.
        """
        data = samples if self._data is None else np.hstack((self._data, samples))
        self._data = data
        if self._trigger is None:
            self._trigger = self._search(data)
        end = self.origin + data.shape[1]
        if self._trigger is None:
            self._forget(end - self.before - 1)
            return None
        if end < self._trigger + self.after:
            return None
        hit = self._cut(self._trigger + self.after, whole=True)
        return hit

    def break_off(self, origin: int | None = None) -> CutHit | None:
        """Restart after a gap; return the hit that it cut short, if any.

        Args:
            origin: index in the stream of the next sample that will be fed; None for
                the one after the last sample fed.
        """
        hit = None
        if self._trigger is not None and self._data is not None:
            hit = self._cut(self.origin + self._data.shape[1], whole=False)
        end = self.origin + (0 if self._data is None else self._data.shape[1])
        end = end if origin is None else origin
        self._data, self.origin, self._from = None, end, end
        return hit

    def _search(self, data: FloatArray) -> int | None:
        """Return the first trigger in the part of the stream not searched yet."""
        first = max(0, self._from - self.origin - 1)
        force = data[self.row, first:] - self.offset
        level = self.level
        found = trigger_indices(force, level=level, rearm=_REARM * level, dead=0)
        self._from = self.origin + data.shape[1]
        return self.origin + first + found[0] if found else None

    def _cut(self, stop: int, *, whole: bool) -> CutHit:
        assert self._data is not None
        assert self._trigger is not None
        start = max(self.origin, self._trigger - self.before)
        samples = self._data[:, start - self.origin : stop - self.origin]
        hit = CutHit(samples, start, self._trigger - start, whole)
        self._trigger = None
        self._from = stop
        self._forget(stop - 1)
        return hit

    def _forget(self, first: int) -> None:
        """Drop samples before `first` that no later hit needs."""
        if self._data is not None and first > self.origin:
            self._data = self._data[:, first - self.origin :]
            self.origin = first


def judge_cut(
    cut: CutHit,
    channels: tuple[Channel, ...],
    *,
    row: int,
    sample_rate: float,
    point: str,
    needed: int,
    limits: HitLimits,
) -> Hit:
    """Judge a single hit; its position counts from the start of the stream.

    Args:
        cut: the hit.
        channels: of its rows.
        row: of the force channel.
        sample_rate: [Hz].
        point: that was struck.
        needed: samples from the trigger on for a block.
        limits: `weak_force` replaces the comparison with other hits.
    """
    recording = Recording("hit", cut.samples, sample_rate, channels)
    force = cut.samples[row] - float(np.median(cut.samples[row, : cut.trigger + 1]))
    count = cut.samples.shape[1]
    (judged,) = judge(
        recording, force, [(0, cut.trigger, count)], limits=limits, shortest=needed
    )
    return Hit(
        start=cut.start,
        trigger=cut.start + cut.trigger,
        stop=cut.start + count,
        point=point,
        peak_force=judged.peak_force,
        verdict=judged.verdict,
        measure=judged.measure,
        reason=judged.reason,
    )
