"""A compiled function runs what its sources say now, whichever of them was edited."""

import subprocess
import sys
from pathlib import Path

import pytest

from jointbench.acquisition.basics.compiled import digest_of

ROOT = Path(__file__).parents[3]
OUTER = """
from jointbench.acquisition.basics.compiled import compiled
from PAIR.inner import OFFSET, scaled

@compiled()
def result(x):
    return scaled(x) + OFFSET
"""
INNER = """
from jointbench.acquisition.basics.compiled import compiled
from PAIR.constants import FACTOR

OFFSET = 10

@compiled(inline="PAIR")
def scaled(x):
    return FACTOR * x
"""
PAIRS = ("always", "never")
"""Packages by whether their inner function is inlined into the outer one."""
ASKED = """
from importlib import import_module
for pair in {pairs}:
    result = import_module(f"{{pair}}.outer").result
    print(result(1), sum(result.stats.cache_hits.values()))
"""
ANNOUNCED = """
from jointbench.acquisition.basics.compiled import announced
from always.outer import result
heard = []
with announced(heard.append):
    result(1)
    result(1.0)
print(len(heard), heard[0].split(":")[0] if heard else "")
"""


def asked(folder: Path) -> list[str]:
    """Return what each pair does in one fresh interpreter.

    Its result, and whether it came from the cache.
    """
    command = [sys.executable, "-c", ASKED.format(pairs=PAIRS)]
    run = subprocess.run(
        command, cwd=folder, capture_output=True, text=True, check=True
    )
    printed = [line.split() for line in run.stdout.splitlines()]
    return [f"{value} {'cached' if int(n) else 'compiled'}" for value, n in printed]


def write(folder: Path, file: str, text: str) -> None:
    """Write a file of both pairs."""
    for pair in PAIRS:
        (folder / pair).mkdir(exist_ok=True)
        (folder / pair / file).write_text(text.replace("PAIR", pair))


def test_an_edit_of_any_source_is_compiled_at_the_next_run(tmp_path: Path) -> None:
    """The callee's body, a constant beside it, a constant that only the callee sees."""
    write(tmp_path, "outer.py", OUTER)
    write(tmp_path, "inner.py", INNER)
    write(tmp_path, "constants.py", "FACTOR = 2\n")
    assert asked(tmp_path) == ["12 compiled"] * 2
    assert asked(tmp_path) == ["12 cached"] * 2
    write(tmp_path, "inner.py", INNER.replace("FACTOR * x", "FACTOR * x * 3"))
    assert asked(tmp_path) == ["16 compiled"] * 2
    write(tmp_path, "inner.py", INNER.replace("OFFSET = 10", "OFFSET = 20"))
    assert asked(tmp_path) == ["22 compiled"] * 2
    write(tmp_path, "constants.py", "FACTOR = 5\n")
    assert asked(tmp_path) == ["25 compiled"] * 2


def test_nothing_is_cached_by_one_file_alone() -> None:
    """Numba's own cache stands nowhere in the product."""
    rooms = ("acquisition", "signal", "analysis", "simulators", "station")
    files = [path for room in rooms for path in (ROOT / room).rglob("*.py")]
    alone = [p.name for p in files if "cache=True" in p.read_text(encoding="utf-8")]
    assert len(files) > 100
    assert alone == []


def test_the_digest_of_an_integration_counts_what_is_inlined(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Each other file that is compiled into it changes it."""
    package = "jointbench.analysis.gap.response"
    before = digest_of(f"{package}.force_integration")
    own = Path.read_bytes
    for name in ("slider_integration", "curve_integration", "force_integration"):
        monkeypatch.setattr(
            Path,
            "read_bytes",
            lambda path, n=name: own(path) + b"#" * (path.stem == n),
        )
        digest_of.cache_clear()
        assert digest_of(f"{package}.force_integration") != before, name
    monkeypatch.undo()
    digest_of.cache_clear()
    assert digest_of(f"{package}.force_integration") == before


def test_a_compilation_is_announced_once_and_a_cached_function_is_not(
    tmp_path: Path,
) -> None:
    """Two signatures are compiled after one line; from the cache there is none."""
    write(tmp_path, "outer.py", OUTER)
    write(tmp_path, "inner.py", INNER)
    write(tmp_path, "constants.py", "FACTOR = 2\n")
    command = [sys.executable, "-c", ANNOUNCED]
    for expected in ("1 compiling the time integration", "0"):
        run = subprocess.run(
            command, cwd=tmp_path, capture_output=True, text=True, check=True
        )
        assert run.stdout.strip() == expected
