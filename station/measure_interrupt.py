# SPDX-License-Identifier: MIT
"""Ctrl-C that lets a block be stored which was read already."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from jointbench.station.measure_record import Record


@contextmanager
def patient_interrupt(record: Record) -> Iterator[None]:
    """Note the first Ctrl-C in the record; a second one interrupts at once.

    Args:
        record: of the session, which looks at it after every block.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def note(number: int, frame: FrameType | None) -> None:
        if record.interrupted:
            raise KeyboardInterrupt
        record.interrupted = True

    before = signal.signal(signal.SIGINT, note)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
