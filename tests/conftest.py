"""The limit of one test: CPU time, so that a busy machine fails nothing."""

import signal
from collections.abc import Generator
from types import FrameType

import pytest

CPU_LIMIT = 120.0
"""CPU time of this process, all threads, that one test may take [s]."""


class CpuTimeExceeded(Exception):
    """A test took more CPU time than the limit."""


def _exceeded(signum: int, frame: FrameType | None) -> None:
    raise CpuTimeExceeded(f"more than {CPU_LIMIT:g} s of CPU time in one test")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol() -> Generator[None, object, object]:
    """Interrupt a test that computes too long; waiting is limited by the wall clock.

    The interval timer counts CPU time and is absent on Windows, where the limit of the
    wall clock (`timeout` in pyproject.toml) stands alone.
    """
    if not hasattr(signal, "setitimer"):
        return (yield)
    before = signal.signal(signal.SIGPROF, _exceeded)
    signal.setitimer(signal.ITIMER_PROF, CPU_LIMIT)
    try:
        return (yield)
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)
