# SPDX-License-Identifier: MIT
"""After an overrun: the oldest sample that the driver still holds."""

from collections.abc import Callable

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.ni.driver import AnalogTask
from jointbench.acquisition.ni.driver_answers import Overrun, Stopped

_ATTEMPTS = 12  # by the last one the room has doubled past any buffer


def read_oldest(
    task: AnalogTask, position: int, read: Callable[[int, int], FloatArray]
) -> tuple[int, FloatArray]:
    """Find the oldest sample that can be read, and read from there on.

    A device that runs on overwrites more between the look at its counter and the read:
    each attempt leaves twice as much room as the last one would have needed.

    Args:
        task: that overran.
        position: next sample that was to be read.
        read: reads from a sample on, given how many wait from there.

    Returns:
        Index of the first sample read, and the samples, shape (n_channels, n).

    Raises:
        Stopped: the whole buffer has gone by, or its counter makes no sense.
        ConnectionLost: the device went away.
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
