# SPDX-License-Identifier: MIT
"""Read the oldest sample still in the driver's buffer after an overrun."""

from collections.abc import Callable

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.ni.driver import AnalogTask
from jointbench.acquisition.ni.driver_answers import Overrun, Stopped

_ATTEMPTS = 12  # the margin doubles each time, up to any buffer size


def read_oldest(
    task: AnalogTask, position: int, read: Callable[[int, int], FloatArray]
) -> tuple[int, FloatArray]:
    """Find the oldest readable sample, and read from there on.

    A running device overwrites more between the query of its counter and the read: each
    attempt leaves twice the margin needed by the last one.

    Args:
        task: that overran.
        position: next sample to read.
        read: reads from a sample on, given the number of unread samples.

    Returns:
        Index of the first sample read, and the samples, shape (n_channels, n).

    Raises:
        Stopped: the whole buffer was overwritten, or its counter is implausible.
        ConnectionLost: the device is unreachable.
    """
    kept, newest, room = task.buffer(), task.acquired(), 0
    for _ in range(_ATTEMPTS):
        oldest = min(max(position, newest - kept) + room, newest)
        try:
            return oldest, read(oldest, newest - oldest)
        except Overrun as error:
            words, before, newest = str(error), newest, task.acquired()
            room = max(2 * room, 2 * (newest - before), kept // 2**_ATTEMPTS, 1)
    raise Stopped(f"{words}; no sample of the buffer could be read")
