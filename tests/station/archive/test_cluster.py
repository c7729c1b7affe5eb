"""A cluster that is lost midway: one line, nothing lost, continued."""

import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from jointbench.acquisition.basics.errors import InstrumentError
from jointbench.station.archive import cluster
from jointbench.station.archive.cluster import ClusterSettings
from jointbench.station.archive.ledger import read_ledger
from jointbench.station.archive.process_file import State, process_task
from jointbench.station.archive.reprocess import (
    cluster_backend,
    default_places,
    run_reprocess,
)
from jointbench.station.screen.exit_codes import EXIT_INSTRUMENT, code_of

SESSIONS = 12
Ends = Callable[[], None]


def serial(tasks, recipe):
    """Run tasks one after another, here."""
    return (process_task(task, recipe) for task in tasks)


@contextmanager
def _started(name: str, *words: str) -> Iterator[subprocess.Popen[bytes]]:
    """Run a program of Dask until the block ends."""
    process = subprocess.Popen(
        [sys.executable, "-m", f"distributed.cli.dask_{name}", *words],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        yield process
    finally:
        process.kill()
        process.wait()


@pytest.fixture(scope="module")
def scheduler(
    tmp_path_factory: pytest.TempPathFactory,
) -> Iterator[tuple[Path, Ends]]:
    """Yield the file of a scheduler, which is slow to start, and what kills it."""
    pytest.importorskip("distributed")
    file = tmp_path_factory.mktemp("dask") / "scheduler.json"
    local = ("--host", "127.0.0.1", "--port", "0", "--no-dashboard")
    with _started("scheduler", *local, "--scheduler-file", str(file)) as process:
        yield file, process.kill


@pytest.fixture
def dask(scheduler: tuple[Path, Ends]) -> Iterator[tuple[str, Ends, Ends]]:
    """Yield the scheduler's address, and what kills it and its only worker."""
    file, kill = scheduler
    alone = ("--nthreads", "1", "--no-nanny", "--no-dashboard")
    with _started("worker", *alone, "--scheduler-file", str(file)) as worker:
        yield _address(file), kill, worker.kill


def _address(reported: Path) -> str:
    from distributed import Client

    for _ in range(1200):
        if reported.exists() and reported.read_text(encoding="utf-8").endswith("}"):
            break
        time.sleep(0.05)
    with Client(scheduler_file=str(reported), timeout=60) as client:
        client.wait_for_workers(1, timeout=60)
        return str(client.scheduler.address)


def _run(folder: Path, backend) -> None:
    places = default_places(
        folder / "out", None, None, keep_stages=False, stages_bytes=0
    )
    run_reprocess(
        [str(folder / "in")],
        recipe=None,
        places=places,
        backend=backend,
        again=False,
        json_target=None,
    )


# The scheduler last: both use the same one.
@pytest.mark.parametrize("killed", ["worker", "scheduler"])
def test_a_cluster_that_is_lost_midway_is_one_line_and_gone_on_with(
    make_session, tmp_path: Path, dask, monkeypatch, capfd, killed: str
) -> None:
    """Exit code 4; what was done is whole and not done again; no file is at fault."""
    monkeypatch.setattr(cluster, "_DESERTED", 3.0)
    first = make_session("in/0.h5")
    for number in range(1, SESSIONS):
        data = first.read_bytes() + str(number).encode()
        first.with_name(f"{number}.h5").write_bytes(data)
    address, kill_scheduler, kill_worker = dask
    distributed = cluster_backend(ClusterSettings(address, batch=1))

    def dying(tasks, recipe):
        for number, outcome in enumerate(distributed(tasks, recipe)):
            if number == 1:
                (kill_scheduler if killed == "scheduler" else kill_worker)()
            yield outcome

    with pytest.raises(InstrumentError, match="repeat the same command") as caught:
        _run(tmp_path, dying)
    assert code_of(caught.value) == EXIT_INSTRUMENT
    assert "distributed" not in capfd.readouterr().err  # Dask's own account
    lines = read_ledger(tmp_path / "out" / "default.ledger.jsonl")
    assert lines[-1]["kind"] == "end"
    assert lines[-1]["lost"] == str(caught.value)
    states = [line["state"] for line in lines if line["kind"] == "file"]
    assert 2 <= states.count(State.DONE) < SESSIONS
    assert set(states) == {State.DONE}
    there = len(list((tmp_path / "out").glob("*.results.h5")))
    _run(tmp_path, serial)
    end = read_ledger(tmp_path / "out" / "default.ledger.jsonl")[-1]
    assert end["skipped"] >= there
    assert end["done"] + end["skipped"] == SESSIONS
