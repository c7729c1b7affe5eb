# SPDX-License-Identifier: MIT
"""Ctrl-C, a polite kill and a closed window: stop, but store what was read already.

SIGTERM, SIGHUP and, on Windows, SIGBREAK mean what Ctrl-C means. There the system ends
a process as soon as its handler of a closed window returns, so that handler waits until
everything is in order; Windows grants it five seconds.
"""

import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from types import FrameType
from typing import Protocol

_KILLS = ("SIGTERM", "SIGHUP", "SIGBREAK")
Handler = Callable[[int, FrameType | None], None]


class Stoppable(Protocol):
    """Work that looks at intervals whether it was told to stop."""

    interrupted: bool


def kills() -> tuple[signal.Signals, ...]:
    """Return the signals of this system that ask a process to end.

    One that is ignored when the program begins stays so, as under ``nohup``.
    """
    found = [getattr(signal, name) for name in _KILLS if hasattr(signal, name)]
    return tuple(s for s in found if signal.getsignal(s) is not signal.SIG_IGN)


@contextmanager
def interruptible() -> Iterator[None]:
    """Take a polite kill and a closed window as Ctrl-C: unwind, put all in order.

    A second kill does not disturb that: a terminal that closes sends two.
    """
    told = False

    def stop(number: int, frame: FrameType | None) -> None:
        nonlocal told
        again, told = told, True
        if not again:
            raise KeyboardInterrupt

    with _handling(dict.fromkeys(kills(), stop)), _closed_window():
        yield


@contextmanager
def patient_interrupt(work: Stoppable) -> Iterator[None]:
    """Note Ctrl-C and kills in the work; a Ctrl-C after that interrupts at once.

    A second kill changes nothing.

    Args:
        work: looks at its `interrupted` after every block.
    """

    def note(number: int, frame: FrameType | None) -> None:
        if work.interrupted and number == signal.SIGINT:
            raise KeyboardInterrupt
        work.interrupted = True

    with _handling(dict.fromkeys((signal.SIGINT, *kills()), note)):
        yield


def restless(
    work: Stoppable, sleep: Callable[[float], None] = time.sleep
) -> Callable[[float], None]:
    """Return a wait that ends the work, once it was told to stop.

    Where something is waited for that may never come, nobody looks at a note.

    Args:
        work: that waits.
        sleep: waits [s].
    """

    def wait(seconds: float) -> None:
        sleep(seconds)
        if work.interrupted:
            raise KeyboardInterrupt

    return wait


@contextmanager
def _handling(handlers: Mapping[signal.Signals, Handler]) -> Iterator[None]:
    """Install handlers meanwhile; only the main thread may."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    with ExitStack() as undo:
        for number, handler in handlers.items():
            undo.callback(signal.signal, number, signal.signal(number, handler))
        yield


def hold_window(number: int, over: threading.Event) -> None:
    """Tell the main thread of a closed window, and wait until all is in order.

    Args:
        number: of the signal whose handler the main thread runs.
        over: set when all is in order.
    """
    # Python runs handlers in the main thread, whoever raises the signal.
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

        def heard(event: int) -> bool:
            if event not in {_CLOSE, _LOGOFF, _SHUTDOWN}:
                return False
            hold_window(signal.SIGBREAK, over)
            return True

        routine = _Routine(heard)
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
