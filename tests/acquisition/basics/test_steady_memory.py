"""Memory goes back to the system when it is freed."""

import subprocess
import sys

import pytest

PROGRAM = """
import sys
from pathlib import Path
import numpy as np
from jointbench.acquisition.basics.steady_memory import keep_memory_steady

def memory():
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096 / 1e6

assert keep_memory_steady()
np.ones(3_000_000)  # a block that is freed raises the limit of the C library
before = memory()
large, kept = [], []
for _ in range(40):
    large.append(np.ones(500_000))
    kept.append(bytearray(100_000))
del large
print(memory() - before)
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="glibc alone")
def test_blocks_between_others_go_back_to_the_system() -> None:
    """160 MB were used and freed between blocks that stay, of 4 MB together."""
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=True
    )
    assert float(done.stdout) < 20.0


KEPT = """
import resource
from jointbench.acquisition.basics.steady_memory import freed_memory_kept

def cleared(rounds):
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    for _ in range(rounds):
        bytearray(40_000_000)[::4096]
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before

def memory():
    return int(open("/proc/self/statm").read().split()[1]) * 4096 / 1e6

cleared(2)
usual = cleared(10)
with freed_memory_kept():
    cleared(2)
    kept = cleared(10)
    at_end = memory()
print(usual, kept, at_end - memory(), cleared(10))
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="glibc alone")
def test_what_is_kept_is_not_cleared_again_and_goes_back_at_the_end() -> None:
    """Ten blocks of 40 MB are 100,000 pages, each cleared when it is touched."""
    done = subprocess.run(
        [sys.executable, "-c", KEPT], capture_output=True, text=True, check=True
    )
    usual, kept, returned, after = map(float, done.stdout.split())
    assert usual > 50_000 and after > 50_000
    assert kept < 0.01 * usual
    assert returned > 30.0
