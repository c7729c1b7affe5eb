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
