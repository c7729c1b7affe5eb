# SPDX-License-Identifier: MIT
"""A hit whose samples are in the file of the recording, not in memory."""

from dataclasses import dataclass
from typing import Protocol

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.recorder.recorder_process import RecorderProcess


class HitCut(Protocol):
    """The samples around one trigger, in memory or in the file."""

    @property
    def samples(self) -> FloatArray:
        """All channels, shape (n_channels, count)."""

    @property
    def count(self) -> int:
        """Number of samples of each channel."""

    @property
    def trigger(self) -> int:
        """Index of the triggering sample in `samples`."""


@dataclass(frozen=True, slots=True, eq=False)
class StoredCut:
    """A hit that is read back from the file each time that its samples are used.

    Attributes:
        recorder: of the file.
        start: index of its first sample among those stored.
        count: samples of each channel.
        trigger: index of the triggering sample, from `start` on.
    """

    recorder: RecorderProcess
    start: int
    count: int
    trigger: int

    @property
    def samples(self) -> FloatArray:
        """All channels, shape (n_channels, count).

        Raises:
            InstrumentError: the disk refuses.
        """
        return self.recorder.read_back(self.start, self.start + self.count)
