# SPDX-License-Identifier: MIT
"""A pool of processes for files: one thread each, nothing lost with a worker.

Every worker has a pipe of its own, so it is known which file a worker held when it
died, and a worker that hangs is ended without the others. A worker retires after some
files. All of them die with their parent: each watches a line that only it holds open.
"""

import logging
import multiprocessing
import os
import signal
import threading
import time
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection, wait
from multiprocessing.context import BaseContext
from multiprocessing.process import BaseProcess

from jointbench.station.archive.process_file import Outcome, State, Task, process_task
from jointbench.station.schemas.recipe import Recipe

logger = logging.getLogger(__name__)
ONE_THREAD = dict.fromkeys(
    (
        "OMP_NUM_THREADS",
        "OPENBLAS_NUM_THREADS",
        "MKL_NUM_THREADS",
        "NUMEXPR_NUM_THREADS",
        "NUMBA_NUM_THREADS",
        "VECLIB_MAXIMUM_THREADS",
    ),
    "1",
)
"""Workers share the cores; threads of a library in each would fight over them."""
_LOOK = 1.0
"""How often a time limit is looked at [s]."""
_LEAVE = 5.0
"""How long a retiring worker may take to leave [s]."""


@dataclass(frozen=True, slots=True)
class PoolSettings:
    """How a pool works.

    Attributes:
        jobs: workers.
        retries: how often a file is tried again whose worker died or whose system
            refused; a file that is bad is not tried again.
        recycle: files after which a worker retires.
        time_limit: longest time for a file [s].
    """

    jobs: int = 2
    retries: int = 2
    recycle: int = 500
    time_limit: float = 1800.0


@dataclass(slots=True)
class _Worker:
    process: BaseProcess
    pipe: Connection
    task: Task | None = None
    since: float = 0.0
    files: int = 0


@dataclass(slots=True)
class _Pool:
    """What `run_pool` keeps track of."""

    settings: PoolSettings
    recipe: Recipe
    context: BaseContext
    lifeline: Connection
    waiting: deque[Task]
    workers: list[_Worker]
    tries: dict[Task, int]

    def start(self) -> _Worker:
        """Start a worker."""
        ours, theirs = self.context.Pipe()
        with environment(ONE_THREAD):
            process = self.context.Process(  # type: ignore[attr-defined]
                target=_work, args=(theirs, self.lifeline, self.recipe), daemon=True
            )
            process.start()
        theirs.close()
        worker = _Worker(process, ours)
        self.workers.append(worker)
        return worker

    def hand_out(self) -> None:
        """Give every idle worker a file; start workers as long as there is work."""
        idle = [worker for worker in self.workers if worker.task is None]
        while self.waiting and (idle or len(self.workers) < self.settings.jobs):
            worker = idle.pop() if idle else self.start()
            task = self.waiting.popleft()
            worker.task, worker.since = task, time.monotonic()
            try:
                worker.pipe.send(task)
            except OSError:  # it died while idle: it never received the file
                self.waiting.appendleft(task)
                self.drop(worker)

    def drop(self, worker: _Worker) -> None:
        """End a worker and forget it."""
        self.workers.remove(worker)
        worker.pipe.close()
        worker.process.kill()
        worker.process.join()

    def retire(self, worker: _Worker) -> None:
        """Let a worker leave that has done its share."""
        self.workers.remove(worker)
        worker.pipe.close()
        worker.process.join(_LEAVE)
        worker.process.kill()
        worker.process.join()

    def outcome_of(self, worker: _Worker) -> Outcome | None:
        """Receive a worker's report; None where its file is tried again."""
        task = worker.task
        try:
            outcome: Outcome = worker.pipe.recv()
        except (EOFError, OSError):
            self.drop(worker)
            return None if task is None else self.lost(task, "its worker died")
        worker.task = None
        worker.files += 1
        if worker.files >= self.settings.recycle:
            self.retire(worker)
        assert task is not None
        if outcome.state is State.FAILED and not (
            outcome.lasting or outcome.unwritable
        ):
            return self.lost(task, outcome.reason, outcome)
        return outcome

    def lost(
        self, task: Task, why: str, outcome: Outcome | None = None
    ) -> Outcome | None:
        """Try a file again, or give it up where it has had its tries."""
        self.tries[task] = self.tries.get(task, 0) + 1
        if self.tries[task] <= self.settings.retries:
            self.waiting.append(task)
            return None
        reason = f"{why}, {self.tries[task]} times"
        given_up = outcome or Outcome(task.path, task.result, State.FAILED)
        return replace(given_up, reason=reason)

    def overdue(self) -> Iterator[Outcome | None]:
        """End workers that hold a file for too long."""
        limit = self.settings.time_limit
        for worker in list(self.workers):
            if worker.task is not None and time.monotonic() - worker.since > limit:
                task = worker.task
                self.drop(worker)
                yield self.lost(task, f"it took more than {limit:g} s")


def run_pool(
    tasks: Sequence[Task], recipe: Recipe, settings: PoolSettings
) -> Iterator[Outcome]:
    """Process files in a pool; yield what became of each, in the order of finishing.

    Close the generator to stop: files in progress are finished but not yielded. Where
    Ctrl-C meets it, they are finished and yielded; a second Ctrl-C ends them, too.

    Args:
        tasks: one a file.
        recipe: how to read them.
        settings: of the pool.

    Raises:
        KeyboardInterrupt: it was stopped by Ctrl-C.
    """
    context = _context()
    lifeline, held = context.Pipe(duplex=False)
    pool = _Pool(settings, recipe, context, lifeline, deque(tasks), [], {})
    try:
        yield from _work_off(pool)
    except KeyboardInterrupt:
        logger.warning("finishing the files in progress; Ctrl-C again aborts them, too")
        yield from _in_hand(pool)
        raise
    finally:
        _finish(pool)
        held.close()
        lifeline.close()


def _work_off(pool: _Pool) -> Iterator[Outcome]:
    pool.hand_out()
    while pool.workers:
        ready = wait([worker.pipe for worker in pool.workers], timeout=_LOOK)
        reports = [
            pool.outcome_of(worker)
            for worker in list(pool.workers)
            if worker.pipe in ready
        ]
        reports += pool.overdue()
        pool.hand_out()
        yield from (outcome for outcome in reports if outcome is not None)
        for worker in [w for w in pool.workers if w.task is None]:
            pool.retire(worker)


def _in_hand(pool: _Pool) -> Iterator[Outcome]:
    """Yield the outcomes of the files in progress; end their workers if interrupted."""
    pool.waiting.clear()
    try:
        for worker in [w for w in pool.workers if w.task is not None]:
            if worker.pipe.poll(pool.settings.time_limit):
                outcome = pool.outcome_of(worker)
                if outcome is not None:
                    yield outcome
    except KeyboardInterrupt:
        for worker in list(pool.workers):
            pool.drop(worker)
        raise


def _finish(pool: _Pool) -> None:
    """Let workers finish the files in progress, then leave."""
    pool.waiting.clear()
    try:
        for worker in pool.workers:
            if worker.task is not None:
                worker.pipe.poll(pool.settings.time_limit)
    finally:
        for worker in list(pool.workers):
            pool.drop(worker)


def _context() -> BaseContext:
    """Return how processes start: from a server that has imported everything once."""
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([__name__])
    return context


@contextmanager
def environment(values: Mapping[str, str]) -> Iterator[None]:
    """Set environment variables for the processes started meanwhile."""
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def _work(pipe: Connection, lifeline: Connection, recipe: Recipe) -> None:
    """Process files until the pipe ends; Ctrl-C is the parent's business."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_die_with_parent, args=(lifeline,), daemon=True).start()
    while True:
        try:
            task = pipe.recv()
            pipe.send(process_task(task, recipe))
        except (EOFError, OSError):
            return


def _die_with_parent(lifeline: Connection) -> None:
    """Wait for the end of a line that nothing is ever sent on, and leave at once."""
    try:
        lifeline.recv_bytes()
    finally:
        os._exit(1)
