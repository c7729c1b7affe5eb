"""The limit of a test counts CPU time, not the wall clock."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

CONFTEST = Path(__file__).with_name("conftest.py")
TESTS = """
import time
import pytest

def compute(seconds):
    end = time.process_time() + seconds
    while time.process_time() < end:
        pass

def test_costs_much() -> None:
    compute(0.4)

@pytest.mark.heavy(reason="nothing smaller shows it")
def test_states_why_it_costs_much() -> None:
    compute(0.4)

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
    """At a limit of 0.6 s of CPU time, waiting for 1 s passes.

    A test of more than 0.3 s that is not marked passes and is listed at the end.
    """
    text = CONFTEST.read_text(encoding="utf-8")
    limited = text.replace("CPU_LIMIT = 300.0", "CPU_LIMIT = 0.6")
    assert limited != text
    text, limited = limited, limited.replace("MOST_CPU = 20.0", "MOST_CPU = 0.3")
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
            "-W",
            "ignore::pytest.PytestUnknownMarkWarning",
        ],
        cwd=tmp_path,
        env=os.environ | {"PYTEST_ADDOPTS": ""},
        capture_output=True,
        text=True,
        check=False,
    )
    assert "1 failed, 3 passed" in run.stdout
    assert "more than 0.6 s of CPU time" in run.stdout
    _, listed = run.stdout.split("more than 0.3 s of CPU time in one test")
    assert "test_costs_much" in listed
    assert "test_states_why" not in listed
