"""A compiled function runs what its sources say now, whichever of them was edited."""

import sys
from collections.abc import Callable
from importlib import import_module, invalidate_caches
from pathlib import Path
from types import ModuleType

import pytest

from jointbench.acquisition.basics import compiled as compiled_module
from jointbench.acquisition.basics.compiled import announced, digest_of

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
Start = Callable[[], list[ModuleType]]


@pytest.fixture
def start(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Start:
    """Return what imports the outer modules as a new run does, without its start-up.

    Nothing of an earlier run is kept in memory, and no bytecode on disk: an edit within
    the same second would not be seen in it.
    """
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)

    def begun() -> list[ModuleType]:
        for name in [n for n in sys.modules if n.partition(".")[0] in PAIRS]:
            monkeypatch.delitem(sys.modules, name)
        invalidate_caches()
        digest_of.cache_clear()
        compiled_module._imported.cache_clear()  # noqa: SLF001
        return [import_module(f"{pair}.outer") for pair in PAIRS]

    return begun


def asked(start: Start) -> list[str]:
    """Return what each pair does in a new run.

    Its result, and whether it came from the cache.
    """
    results = [module.result for module in start()]
    values = [result(1) for result in results]
    hits = [sum(result.stats.cache_hits.values()) for result in results]
    return [
        f"{value} {'cached' if n else 'compiled'}"
        for value, n in zip(values, hits, strict=True)
    ]


def write(folder: Path, file: str, text: str) -> None:
    """Write a file of both pairs."""
    for pair in PAIRS:
        (folder / pair).mkdir(exist_ok=True)
        (folder / pair / file).write_text(text.replace("PAIR", pair))


def test_an_edit_of_any_source_is_compiled_at_the_next_run(
    tmp_path: Path, start: Start
) -> None:
    """The callee's body, a constant beside it, a constant that only the callee sees."""
    write(tmp_path, "outer.py", OUTER)
    write(tmp_path, "inner.py", INNER)
    write(tmp_path, "constants.py", "FACTOR = 2\n")
    assert asked(start) == ["12 compiled"] * 2
    assert asked(start) == ["12 cached"] * 2
    write(tmp_path, "inner.py", INNER.replace("FACTOR * x", "FACTOR * x * 3"))
    assert asked(start) == ["16 compiled"] * 2
    write(tmp_path, "inner.py", INNER.replace("OFFSET = 10", "OFFSET = 20"))
    assert asked(start) == ["22 compiled"] * 2
    write(tmp_path, "constants.py", "FACTOR = 5\n")
    assert asked(start) == ["25 compiled"] * 2


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
    tmp_path: Path, start: Start
) -> None:
    """Two signatures are compiled after one line; from the cache there is none."""
    write(tmp_path, "outer.py", OUTER)
    write(tmp_path, "inner.py", INNER)
    write(tmp_path, "constants.py", "FACTOR = 2\n")
    for expected in (["compiling the models"], []):
        heard: list[str] = []
        always, _ = start()
        with announced(heard.append):
            always.result(1)
            always.result(1.0)
        assert [line.split(":")[0] for line in heard] == expected
