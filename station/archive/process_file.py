# SPDX-License-Identifier: MIT
"""The pure step: one session file and a recipe make one result file, once.

The result carries the key of all it depends on: the SHA-256 of the input, the recipe,
the version of the code. A result with that key whose content is what its digest says is
left as it is. That is all there is to resuming, whoever calls: one process, a pool, a
cluster.
"""

import errno
import time
import traceback
from dataclasses import dataclass, replace
from enum import StrEnum
from hashlib import sha256
from pathlib import Path

from jointbench.acquisition.basics.errors import (
    BadData,
    HostileFile,
    JointbenchError,
    UsageError,
)
from jointbench.acquisition.basics.one_thread import one_thread
from jointbench.acquisition.file_access.content_digest import require_whole
from jointbench.acquisition.file_access.hdf5_guards import open_guarded
from jointbench.acquisition.file_access.netcdf_read import read_attribute
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.file_access.text_files import file_digest, file_size
from jointbench.acquisition.records.session import Session, software_version
from jointbench.acquisition.session_file.open_session import open_session
from jointbench.acquisition.session_file.store import damage_named
from jointbench.station.archive.file_mark import Mark, mark_of
from jointbench.station.archive.results_index import note_result
from jointbench.station.pipeline.code_version import stage_version
from jointbench.station.pipeline.process_session import process_session
from jointbench.station.pipeline.stage_store import StageStore
from jointbench.station.results.processed_file import Origin, write_processed
from jointbench.station.schemas.recipe import Recipe, recipe_digest

_MOST_BYTES = 64 * 2**30
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
class Traces:
    """What the files of a task were when they were last read or written.

    Attributes:
        input_sha256: of the session; empty where it was not read.
        session: mark of the session, before it was read.
        result: mark of the result; empty where there is none.
    """

    input_sha256: str = ""
    session: Mark = ()
    result: Mark = ()


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
        corrupted: what was wrong with the earlier result that was replaced; empty
            where nothing was.
        traces: by which a later run knows the files again without reading them.
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
    corrupted: str = ""
    traces: Traces = Traces()


def result_key(digest: str, recipe: str) -> str:
    """Return the key of a result: SHA-256 over input, recipe and version.

    Args:
        digest: of the input.
        recipe: digest of the recipe.
    """
    text = "\n".join((digest, recipe, software_version(), stage_version("result")))
    return sha256(text.encode()).hexdigest()


def _has_key(path: Path, key: str) -> bool:
    """Return whether a result of this key exists, whole or unsigned.

    Raises:
        CorruptedFile: a result is there, and its content is not what its digest says.
        FormatError: a file is there that cannot be read.
    """
    if not path.exists():
        return False
    with open_guarded(path) as file, damage_named(path):
        require_whole(file, path)
        return read_attribute(file, "key") == key


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
    key, traces = "", Traces(session=mark_of(task.path))
    try:
        traces = replace(traces, input_sha256=_digest(task.path))
        key = result_key(traces.input_sha256, recipe_digest(recipe))
        outcome = _met(task, recipe, key, traces, begun)
    except JointbenchError as error:
        outcome = _failed(task, key, str(error), begun, lasting=True)
    except OSError as error:
        words = f"{error.strerror or error}"
        outcome = _failed(task, key, words, begun, lasting=False)
    except Exception as error:  # noqa: BLE001 - one file must not end a night's run
        place = traceback.extract_tb(error.__traceback__)[-1]
        reason = (
            f"internal error ({type(error).__name__}: {error}) in "
            f"{Path(place.filename).name}:{place.lineno}; report it"
        )
        outcome = _failed(task, key, reason, begun, lasting=False)
    return replace(outcome, traces=replace(traces, result=outcome.traces.result))


def _met(task: Task, recipe: Recipe, key: str, traces: Traces, begun: float) -> Outcome:
    """Skip a file, refuse it as before, or make its result."""
    mark, corrupted = _there(task, key)
    if mark:
        own = Traces(result=mark)
        return Outcome(task.path, task.result, State.SKIPPED, key, traces=own)
    if not task.again and task.refused == key:
        return _failed(task, key, task.reason, begun, lasting=True)
    with one_thread():
        session = _unchanged_session(task.path, traces.session)
        origin = Origin(task.path, traces.input_sha256, key)
        outcome = _done(task, session, recipe, origin, begun, traces.session)
    own = Traces(result=mark_of(task.result))
    return replace(outcome, corrupted=corrupted, traces=own)


def _there(task: Task, key: str) -> tuple[Mark, str]:
    """Return the mark of a result that is as it should be, and what is wrong with it.

    Nothing is wrong with a result of another key, nor where there is none.
    """
    before = mark_of(task.result)
    try:
        if _has_key(task.result, key) and not task.again:
            return before, ""
    except BadData as error:
        return (), str(error)
    return (), ""


def _digest(path: Path) -> str:
    if file_size(path) > _MOST_BYTES:
        raise HostileFile(
            f"{named(path)} has more than {_MOST_BYTES} bytes, no session has"
        )
    return file_digest(path)


def _unchanged_session(path: Path, before: Mark) -> Session:
    """Read a session whose digest was taken when it had the mark `before`."""
    session = open_session(path)
    _require_unchanged(path, before)
    return session


def _require_unchanged(path: Path, before: Mark) -> None:
    """Raise OSError if a file no longer has the mark that it had."""
    if mark_of(path) != before:
        raise OSError(errno.EBUSY, "it changed while it was read")


def _done(
    task: Task,
    session: Session,
    recipe: Recipe,
    origin: Origin,
    begun: float,
    before: Mark,
) -> Outcome:
    stages = StageStore(None if task.again else task.stages)
    try:
        result = process_session(session, origin.sha256, recipe, stages)
    except BadData as error:
        raise type(error)(f"{named(task.path)}: {error}") from error
    # Samples of large sessions are read while they are processed.
    _require_unchanged(task.path, before)
    origin = replace(origin, seconds=time.perf_counter() - begun)
    try:
        write_processed(task.result, result, recipe, origin)
    except UsageError as error:
        reason, key = str(error), origin.key
        return _failed(task, key, reason, begun, lasting=False, unwritable=True)
    note_result(task.result)
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
