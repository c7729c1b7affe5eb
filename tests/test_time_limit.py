"""The limit of a test counts CPU time, not the wall clock."""

import signal
import subprocess
import sys
from pathlib import Path

import pytest

CONFTEST = Path(__file__).with_name("conftest.py")
TESTS = """
import time

def test_waits() -> None:
    time.sleep(1.0)

def test_computes() -> None:
    while True:
        pass
"""


@pytest.mark.skipif(
    not hasattr(signal, "setitimer"), reason="this system has no CPU-time timer"
)
def test_a_test_that_computes_is_stopped_and_one_that_waits_is_not(
    tmp_path: Path,
) -> None:
    """At a limit of 0.5 s of CPU time, waiting for 1 s passes."""
    text = CONFTEST.read_text(encoding="utf-8")
    limited = text.replace("CPU_LIMIT = 120.0", "CPU_LIMIT = 0.5")
    assert limited != text
    (tmp_path / "conftest.py").write_text(limited, encoding="utf-8")
    (tmp_path / "test_two.py").write_text(TESTS, encoding="utf-8")
    run = subprocess.run(
        [
            sys.executable,
            "-m",
            "pytest",
            "-q",
            "--timeout=60",
            "-p",
            "no:cacheprovider",
        ],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert "1 failed, 1 passed" in run.stdout
    assert "CpuTimeExceeded" in run.stdout
