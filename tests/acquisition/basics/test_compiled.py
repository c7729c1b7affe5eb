"""A compiled function runs what its sources say now, whichever of them was edited."""

import subprocess
import sys
from pathlib import Path

import pytest

from jointbench.acquisition.basics.compiled import digest_of

ROOT = Path(__file__).parents[3]
OUTER = """
from jointbench.acquisition.basics.compiled import compiled
from pair.inner import OFFSET, scaled

@compiled()
def result(x):
    return scaled(x) + OFFSET
"""
INNER = """
from jointbench.acquisition.basics.compiled import compiled
from pair.constants import FACTOR

OFFSET = {offset}

@compiled(inline="{inline}")
def scaled(x):
    return FACTOR * x
"""
ASKED = """
from pair.outer import result
print(result(1), sum(result.stats.cache_hits.values()))
"""


def asked(folder: Path) -> list[str]:
    """Return the result in a fresh interpreter, and whether it came from the cache."""
    command = [sys.executable, "-c", ASKED]
    run = subprocess.run(
        command, cwd=folder, capture_output=True, text=True, check=True
    )
    value, hits = run.stdout.split()
    return [value, "cached" if int(hits) else "compiled"]


@pytest.mark.parametrize("inline", ["always", "never"])
def test_an_edit_of_any_source_is_compiled_at_the_next_run(
    inline: str, tmp_path: Path
) -> None:
    """The callee's body, a constant beside it, a constant that only the callee sees."""
    pair = tmp_path / "pair"
    pair.mkdir()
    inner = INNER.format(offset=10, inline=inline)
    (pair / "outer.py").write_text(OUTER)
    (pair / "inner.py").write_text(inner)
    (pair / "constants.py").write_text("FACTOR = 2\n")
    assert asked(tmp_path) == ["12", "compiled"]
    assert asked(tmp_path) == ["12", "cached"]
    (pair / "inner.py").write_text(inner.replace("FACTOR * x", "FACTOR * x * 3"))
    assert asked(tmp_path) == ["16", "compiled"]
    (pair / "inner.py").write_text(inner.replace("OFFSET = 10", "OFFSET = 20"))
    assert asked(tmp_path) == ["22", "compiled"]
    (pair / "constants.py").write_text("FACTOR = 5\n")
    assert asked(tmp_path) == ["25", "compiled"]


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
