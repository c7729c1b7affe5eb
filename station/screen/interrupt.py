# SPDX-License-Identifier: MIT
"""Ctrl-C, termination signals and a closed window: stop and store the data read so far.

SIGTERM, SIGHUP and, on Windows, SIGBREAK act like Ctrl-C. Windows ends a process as
soon as its handler of a closed window returns. The handler therefore waits for the
clean-up; Windows allows five seconds.
"""

import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from types import FrameType
from typing import Protocol

_TERMINATION = ("SIGTERM", "SIGHUP", "SIGBREAK")
Handler = Callable[[int, FrameType | None], None]


class Stoppable(Protocol):
    """Work that checks at intervals whether it was interrupted."""

    interrupted: bool


def termination_signals() -> tuple[signal.Signals, ...]:
    """Return the signals of this system that ask a process to end.

    A signal that is ignored at the start stays ignored, as under ``nohup``.
    """
    found = [getattr(signal, name) for name in _TERMINATION if hasattr(signal, name)]
    return tuple(s for s in found if signal.getsignal(s) is not signal.SIG_IGN)


@contextmanager
def interruptible() -> Iterator[None]:
    """Treat termination signals and a closed window as Ctrl-C: unwind and clean up.

    A second signal is ignored: a terminal that closes sends two.
    """
    stopping = False

    def stop(number: int, frame: FrameType | None) -> None:
        nonlocal stopping
        again, stopping = stopping, True
        if not again:
            raise KeyboardInterrupt

    with _handling(dict.fromkeys(termination_signals(), stop)), _closed_window():
        yield


@contextmanager
def patient_interrupt(work: Stoppable) -> Iterator[None]:
    """Note Ctrl-C and termination signals; a second Ctrl-C interrupts at once.

    A second termination signal has no effect.

    Args:
        work: checks its `interrupted` after every block.
    """

    def note(number: int, frame: FrameType | None) -> None:
        if work.interrupted and number == signal.SIGINT:
            raise KeyboardInterrupt
        work.interrupted = True

    with _handling(dict.fromkeys((signal.SIGINT, *termination_signals()), note)):
        yield


def interruptible_wait(
    work: Stoppable, sleep: Callable[[float], None] = time.sleep
) -> Callable[[float], None]:
    """Return a wait that raises KeyboardInterrupt once the work is interrupted.

    It is for waits without end, in which the work does not check `interrupted`.

    Args:
        work: that waits.
        sleep: function that waits [s].
    """

    def wait(seconds: float) -> None:
        sleep(seconds)
        if work.interrupted:
            raise KeyboardInterrupt

    return wait


@contextmanager
def _handling(handlers: Mapping[signal.Signals, Handler]) -> Iterator[None]:
    """Install handlers for the duration; only the main thread can."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    with ExitStack() as undo:
        for number, handler in handlers.items():
            undo.callback(signal.signal, number, signal.signal(number, handler))
        yield


def hold_window(number: int, over: threading.Event) -> None:
    """Signal a closed window to the main thread and wait for its clean-up.

    Args:
        number: signal whose handler the main thread runs.
        over: set at the end of the clean-up.
    """
    # Python runs handlers in the main thread, whichever thread raises the signal.
    signal.raise_signal(number)
    over.wait()


if sys.platform == "win32":
    import ctypes
    from ctypes import wintypes

    _CLOSE, _LOGOFF, _SHUTDOWN = 2, 5, 6
    _Routine = ctypes.WINFUNCTYPE(wintypes.BOOL, wintypes.DWORD)

    @contextmanager
    def _closed_window() -> Iterator[None]:
        over = threading.Event()

        def on_close(event: int) -> bool:
            if event not in {_CLOSE, _LOGOFF, _SHUTDOWN}:
                return False
            hold_window(signal.SIGBREAK, over)
            return True

        routine = _Routine(on_close)
        ctypes.windll.kernel32.SetConsoleCtrlHandler(routine, True)
        try:
            yield
        finally:
            over.set()
            ctypes.windll.kernel32.SetConsoleCtrlHandler(routine, False)
else:

    @contextmanager
    def _closed_window() -> Iterator[None]:
        yield
