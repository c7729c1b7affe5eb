# SPDX-License-Identifier: MIT
"""Read the oldest sample still in the driver's buffer after an overrun."""

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.ni.driver import AnalogTask
from jointbench.acquisition.ni.driver_answers import Overrun, Stopped

_LEAST_ROOM = 2**-12  # of the buffer: 5 ms of 20 s; it doubles at each attempt


def read_oldest(
    task: AnalogTask, position: int, most: int, *, timeout: float
) -> tuple[int, FloatArray]:
    """Read from the oldest sample on that is still in the buffer.

    The driver itself counts back from its newest sample, so that the time between a
    question for its counter and the read costs no sample. A running device may
    overwrite the oldest samples during the read: each attempt leaves twice the room of
    the last one.

    Args:
        task: that overran.
        position: next sample to read.
        most: samples to read at most.
        timeout: [s].

    Returns:
        Index of the first sample read, and the samples, shape (n_channels, n).

    Raises:
        Stopped: the whole buffer was overwritten, or its counter is implausible.
        ConnectionLost: the device is unreachable.
    """
    kept, waiting, room = task.buffer(), task.acquired() - position, 0
    words = f"the driver counts {waiting} unread samples after an overrun"
    while (back := min(kept - room, waiting)) > 0:
        try:
            return task.read_back(back, min(most, back), timeout=timeout)
        except Overrun as error:
            words = str(error)
            room = max(2 * room, round(_LEAST_ROOM * kept), 1)
    raise Stopped(f"{words}; no sample of the buffer could be read")
