"""The key of a stage holds its code; the same key gives the same numbers."""

import ast
import os
import subprocess
import sys
from functools import cache
from pathlib import Path
from types import FrameType

import h5py
import pytest

from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.acquisition.session_file.store import read_session
from jointbench.station.archive.process_file import Task, process_task, result_key
from jointbench.station.pipeline import code_version
from jointbench.station.pipeline.code_version import (
    CALLERS,
    STAGE_MODULES,
    imports_of,
    sources_of,
    stage_sources,
    stage_version,
)
from jointbench.station.pipeline.process_session import process_session
from jointbench.station.pipeline.stage_store import StageStore, stage_key
from jointbench.station.schemas.recipe import Recipe

ROOT = Path(code_version.__file__).resolve().parents[2]


@pytest.fixture
def forgotten():
    """Forget what was read of the sources, before and after."""
    caches = (
        stage_version,
        imports_of,
        code_version.source_of,
        code_version.source_digest,
    )
    for one in caches:
        one.cache_clear()
    yield
    for one in caches:
        one.cache_clear()


def test_a_change_of_a_module_of_a_stage_changes_its_key_and_no_other(
    forgotten, monkeypatch
) -> None:
    """The estimator of the FRF is edited: the Kalman stage and surfaces are not."""
    before = {name: stage_key(name, None) for name in STAGE_MODULES}
    result = result_key("input", "recipe")
    reading = code_version.source_of

    def edited(name: str) -> bytes | None:
        more = b"# edited" if name == "jointbench.signal.frf.estimators" else b""
        found = reading(name)
        return None if found is None else found + more

    for one in (stage_version, imports_of, code_version.source_digest):
        one.cache_clear()
    monkeypatch.setattr(code_version, "source_of", edited)
    after = {name: stage_key(name, None) for name in STAGE_MODULES}
    changed = {name for name in STAGE_MODULES if before[name] != after[name]}
    assert changed >= {"frf", "modes", "fill", "result"}
    assert not changed & {"kalman", "structure", "surface"}
    assert result_key("input", "recipe") != result


@pytest.mark.parametrize("stage", sorted(STAGE_MODULES))
def test_imports_are_found_as_the_parser_finds_them(stage: str) -> None:
    """Inside functions, over several lines, of whole modules: none is missed."""
    for name in stage_sources(stage):
        assert parsed_imports(name) <= set(imports_of(name)), name


@cache
def parsed_imports(name: str) -> frozenset[str]:
    """Return the product modules that a module imports; stages share most of them."""
    source = code_version.source_of(name)
    assert source is not None, name
    wanted: set[str] = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ImportFrom) and node.module:
            below = [f"{node.module}.{alias.name}" for alias in node.names]
            wanted |= {node.module, *below}
        elif isinstance(node, ast.Import):
            wanted |= {alias.name for alias in node.names}
    return frozenset(
        one
        for one in wanted
        if one.startswith("jointbench.") and code_version.source_of(one) is not None
    )


def test_every_stage_that_is_run_names_its_modules() -> None:
    """A stage key of a name without modules would hang on all code; none does."""
    calls = set()
    for path in (ROOT / "station").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and ast.unparse(node.func) in (
                "stages.key",
                "run.stages.key",
            ):
                assert isinstance(node.args[0], ast.Constant)
                calls.add(node.args[0].value)
    assert calls == set(STAGE_MODULES) - {"result"}


def test_all_of_our_code_that_runs_in_a_stage_is_in_its_version(make_session) -> None:
    """What Python enters while a stage is made lies in the modules of that stage."""
    session = read_session(make_session("s.h5"))
    met: dict[str, set[str]] = {}

    class Watching(StageStore):
        """Notes which of our files are entered while a stage is made."""

        def run(self, name, key, kind, make):
            return super().run(name, key, kind, lambda: self.watched(name, make))

        def watched(self, name, make):
            stage = name.split(" ")[0]
            files = met.setdefault(stage, set())

            def enter(frame: FrameType, event: str, _argument: object) -> None:
                if event == "call" and not frame.f_code.co_filename.startswith("<"):
                    files.add(_file(frame.f_code.co_filename))

            before = sys.getprofile()
            sys.setprofile(enter)
            try:
                return make()
            finally:
                sys.setprofile(before)

    process_session(session, "0" * 64, Recipe(name="plain"), Watching())
    assert set(met) == {"hits", "kalman", "frf", "modes", "fill", "amplitude"}
    for stage, files in met.items():
        named = {_module(file) for file in files if file.startswith(f"{ROOT}{os.sep}")}
        ours = {name for name in named if not name.startswith("jointbench.tests")}
        # Making and checking records belongs to every stage through its imports.
        assert ours <= stage_sources(stage), stage


@cache
def _file(name: str) -> str:
    return str(Path(name).resolve())


def _module(file: str) -> str:
    path = Path(file).relative_to(ROOT).with_suffix("")
    return ".".join(("jointbench", *path.parts))


def test_the_callers_of_stages_are_there() -> None:
    """Part of every stage, each with a source."""
    for name in CALLERS:
        assert sources_of(f"jointbench.{name}")


PROCESS = """
import sys
from pathlib import Path
from jointbench.station.archive.process_file import Task, process_task
from jointbench.station.schemas.recipe import Recipe
outcome = process_task(Task(Path(sys.argv[1]), Path(sys.argv[2])), Recipe(name="p"))
print(outcome.key)
"""


def test_one_thread_and_two_give_the_same_numbers_to_the_last_bit(
    make_session, tmp_path: Path
) -> None:
    """Same key, same content: the environment's threads change nothing."""
    session = make_session("s.h5", hits=3)
    one, two = tmp_path / "1.results.h5", tmp_path / "2.results.h5"
    with one_thread():
        here = process_task(Task(session, one), Recipe(name="p"))
    done = subprocess.run(
        [sys.executable, "-c", PROCESS, str(session), str(two)],
        env=os.environ | {"OMP_NUM_THREADS": "2", "OPENBLAS_NUM_THREADS": "2"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == here.key
    assert _numbers(one) == _numbers(two)


def _numbers(path: Path) -> dict[str, bytes]:
    content: dict[str, bytes] = {}

    def recorded(name: str, item: object) -> None:
        if isinstance(item, h5py.Dataset):
            content[name] = item[()].tobytes()

    with h5py.File(path, "r") as file:
        file.visititems(recorded)
    return content
