"""One BLAS thread, shared bytecode, few searches for garbage, limits in CPU time.

Limits in CPU time hold on a busy machine as well.
"""

import gc
import os
import signal
import sys
from collections.abc import Generator
from pathlib import Path
from types import FrameType

import pytest

# Read when NumPy and SciPy load their BLAS, by this process and by those it starts. On
# small matrices a second thread only waits in a loop (docs/decisions/0173); a test of
# two threads asks for two.
for _library in ("OMP", "OPENBLAS", "MKL"):
    os.environ.setdefault(f"{_library}_NUM_THREADS", "1")

# Tests start a hundred interpreters, and where the environment forbids bytecode beside
# the sources each of them would compile a thousand modules again, 1.6 s of CPU time
# (docs/decisions/0326). They share bytecode beside pytest's own cache instead.
if os.environ.pop("PYTHONDONTWRITEBYTECODE", ""):
    _bytecode = Path(__file__).parents[1] / ".pytest_cache" / "bytecode"
    os.environ.setdefault("PYTHONPYCACHEPREFIX", str(_bytecode))
    sys.pycache_prefix = os.environ["PYTHONPYCACHEPREFIX"]
    sys.dont_write_bytecode = False

CPU_LIMIT = 120.0
"""CPU time of this process, all threads, after which a test is stopped [s]."""
MOST_CPU = 20.0
"""CPU time, child processes included, that a test may take without a mark [s].

Twice what the slowest of them take, compilation included: machines differ.
"""


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Collect without the garbage collector, and keep what was collected out of it.

    The half million objects of modules and tests live until the end; the collector
    would look at each of them again and again (docs/decisions/0213).
    """
    gc.disable()
    try:
        return (yield)
    finally:
        gc.collect()
        gc.freeze()
        gc.enable()


class CpuTimeExceeded(Exception):
    """A test took more CPU time than a limit."""


def _exceeded(signum: int, frame: FrameType | None) -> None:
    raise CpuTimeExceeded(f"more than {CPU_LIMIT:g} s of CPU time in one test")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the option that measures what the tests cost."""
    parser.addoption(
        "--cpu-costs",
        metavar="FILE",
        help="append the CPU time of each test with its fixtures and its children [s]",
    )


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Generator[None, object, object]:
    """Interrupt a test that computes too long; waiting is limited by the wall clock.

    The interval timer counts CPU time and is absent on Windows, where the limit of the
    wall clock (`timeout` in pyproject.toml) stands alone.
    """
    begun = _cpu_time()
    timed = hasattr(signal, "setitimer")
    if timed:
        before = signal.signal(signal.SIGPROF, _exceeded)
        signal.setitimer(signal.ITIMER_PROF, CPU_LIMIT)
    try:
        return (yield)
    finally:
        if timed:
            signal.setitimer(signal.ITIMER_PROF, 0.0)
            signal.signal(signal.SIGPROF, before)
        _note_cost(item, _cpu_time() - begun)


def _note_cost(item: pytest.Item, taken: float) -> None:
    """Append the cost of a test to the file that is asked for, if one is.

    A fixture counts with the first test that needs it, a child process with the test
    that waits for it; `sort -rn FILE` lists the largest.
    """
    file = item.config.getoption("--cpu-costs", default=None)
    if file:
        with Path(file).open("a", encoding="utf-8") as costs:
            costs.write(f"{taken:.2f}\t{item.nodeid}\n")


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Generator[None, object, object]:
    """Fail a test that costs much and does not state why.

    A campaign that is shorter, a fixture that is shared, or a statistic that moves to
    `benchmarks` makes it cheaper; where nothing does, it is marked `heavy`.
    """
    begun = _cpu_time()
    result = yield
    taken = _cpu_time() - begun
    if taken > MOST_CPU and item.get_closest_marker("heavy") is None:
        raise CpuTimeExceeded(
            f"{taken:.1f} s of CPU time in one test (limit {MOST_CPU:g} s); make it "
            "smaller, or mark it `@pytest.mark.heavy(reason=...)`"
        )
    return result


def _cpu_time() -> float:
    """Return the CPU time of this process and of the children it waited for [s]."""
    return sum(os.times()[:4])
