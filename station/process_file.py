# SPDX-License-Identifier: MIT
"""The pure step: one session file and a recipe make one result file, once.

The result carries the key of all it depends on: the SHA-256 of the input, the recipe,
the version. A result with that key is left as it is. That is all there is to resuming,
whoever calls: one process, a pool, a cluster.
"""

import errno
import time
import traceback
from dataclasses import dataclass, replace
from enum import StrEnum
from hashlib import sha256
from pathlib import Path

import h5py

from jointbench.acquisition.errors import (
    BadData,
    HostileFile,
    JointbenchError,
    UsageError,
)
from jointbench.acquisition.session import Session, software_version
from jointbench.acquisition.session_file import read_session
from jointbench.acquisition.text_files import file_digest, file_size, named
from jointbench.station.process_session import process_session
from jointbench.station.processed_file import Origin, write_processed
from jointbench.station.recipe import Recipe, recipe_digest
from jointbench.station.stage_store import STAGE_LAYOUT, StageStore

MOST_BYTES = 64 * 2**30
"""A larger file is no session; reading it for its digest would take an hour [bytes]."""


class State(StrEnum):
    """What became of a file."""

    DONE = "done"
    SKIPPED = "skipped"
    FAILED = "failed"


@dataclass(frozen=True, slots=True)
class Task:
    """One file to process.

    Attributes:
        path: of the session.
        result: of the file to write.
        stages: folder of kept stages, or None.
        refused: key under which this file was refused before, or empty.
        reason: why it was.
        again: process it whatever is there.
    """

    path: Path
    result: Path
    stages: Path | None = None
    refused: str = ""
    reason: str = ""
    again: bool = False


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of a task.

    Attributes:
        path: of the session.
        result: of the result file.
        state: done, skipped because it was there, or failed.
        key: of input, recipe and version; empty where the input cannot be read.
        reason: why it failed, one line.
        lasting: a failure that would come again: the file's own fault.
        unwritable: the result could not be written: no fault of the file.
        seconds: that it took [s].
        changes: hits whose verdict changed.
        computed: stages that were run.
        reused: stages that were taken as kept.
    """

    path: Path
    result: Path
    state: State
    key: str = ""
    reason: str = ""
    lasting: bool = False
    unwritable: bool = False
    seconds: float = 0.0
    changes: int = 0
    computed: tuple[str, ...] = ()
    reused: tuple[str, ...] = ()


def result_key(digest: str, recipe: Recipe) -> str:
    """Return the key of a result: SHA-256 over input, recipe and version."""
    version = f"{software_version()}/{STAGE_LAYOUT}"
    text = "\n".join((digest, recipe_digest(recipe), version))
    return sha256(text.encode()).hexdigest()


def has_key(path: Path, key: str) -> bool:
    """Tell whether a result of this very key is there; a damaged one is not."""
    try:
        with h5py.File(path, "r") as file:
            return bool(file.attrs.get("key") == key.encode())
    except (OSError, RuntimeError, ValueError):
        return False


def process_task(task: Task, recipe: Recipe) -> Outcome:
    """Process one file unless its result is there; never raise for a file's sake.

    Args:
        task: the file.
        recipe: how to read it.

    Returns:
        What became of it. Data that cannot be used are a lasting failure; a system
        that refuses is one that may pass.
    """
    begun = time.perf_counter()
    key = ""
    try:
        before = _mark(task.path)
        digest = _digest(task.path)
        key = result_key(digest, recipe)
        if not task.again and has_key(task.result, key):
            return Outcome(task.path, task.result, State.SKIPPED, key)
        if not task.again and task.refused == key:
            return _failed(task, key, task.reason, begun, lasting=True)
        session = _unchanged_session(task.path, before)
        return _done(task, session, recipe, Origin(task.path, digest, key), begun)
    except JointbenchError as error:
        return _failed(task, key, str(error), begun, lasting=True)
    except OSError as error:
        return _failed(task, key, f"{error.strerror or error}", begun, lasting=False)
    except Exception as error:  # noqa: BLE001 - one file must not end a night's run
        place = traceback.extract_tb(error.__traceback__)[-1]
        reason = (
            f"internal error ({type(error).__name__}: {error}) in "
            f"{Path(place.filename).name}:{place.lineno}; report it"
        )
        return _failed(task, key, reason, begun, lasting=False)


def _digest(path: Path) -> str:
    if file_size(path) > MOST_BYTES:
        raise HostileFile(
            f"{named(path)} has more than {MOST_BYTES} bytes, no session has"
        )
    return file_digest(path)


def _mark(path: Path) -> tuple[int, ...]:
    """Return what tells whether a file was touched; empty where there is none."""
    try:
        info = path.stat()
    except (OSError, ValueError):
        return ()
    return info.st_ino, info.st_size, info.st_mtime_ns


def _unchanged_session(path: Path, before: tuple[int, ...]) -> Session:
    """Read a session whose digest was taken when it had the mark `before`."""
    session = read_session(path)
    if _mark(path) != before:
        raise OSError(errno.EBUSY, "it changed while it was read")
    return session


def _done(
    task: Task, session: Session, recipe: Recipe, origin: Origin, begun: float
) -> Outcome:
    stages = StageStore(None if task.again else task.stages)
    try:
        result = process_session(session, origin.sha256, recipe, stages)
    except BadData as error:
        raise type(error)(f"{named(task.path)}: {error}") from error
    origin = replace(origin, seconds=time.perf_counter() - begun)
    try:
        write_processed(task.result, result, recipe, origin)
    except UsageError as error:
        reason, key = str(error), origin.key
        return _failed(task, key, reason, begun, lasting=False, unwritable=True)
    return Outcome(
        task.path,
        task.result,
        State.DONE,
        origin.key,
        seconds=time.perf_counter() - begun,
        changes=len(result.changes),
        computed=tuple(stages.computed),
        reused=tuple(stages.reused),
    )


def _failed(
    task: Task,
    key: str,
    reason: str,
    begun: float,
    *,
    lasting: bool,
    unwritable: bool = False,
) -> Outcome:
    return Outcome(
        task.path,
        task.result,
        State.FAILED,
        key,
        " ".join(reason.split()),
        lasting,
        unwritable,
        time.perf_counter() - begun,
    )
