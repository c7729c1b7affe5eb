# SPDX-License-Identifier: MIT
"""What a ledger settles: files that are as they were when they were last met.

Size and time of a session and of its result are compared with what the ledger noted.
Where they stayed, neither file is opened; where one moved, the digests decide, and that
is the work of `process_file`. Damage that leaves size and time alone is found by
``jointbench verify``, which reads everything.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from jointbench.station.archive.file_mark import mark_of
from jointbench.station.archive.process_file import (
    Outcome,
    State,
    Task,
    Traces,
    result_key,
)


def settled(
    tasks: Sequence[Task], last: Mapping[str, Mapping[str, Any]], recipe: str
) -> tuple[list[Outcome], list[Task]]:
    """Part tasks into those that the ledger settles, and those to look at.

    Args:
        tasks: one a file.
        last: last line of the ledger on each file, by its path.
        recipe: digest of the recipe.

    Returns:
        What became of the first, as it was before; and the others.
    """
    known: list[Outcome] = []
    others: list[Task] = []
    for task in tasks:
        line = last.get(str(task.path))
        outcome = None
        if line is not None and not task.again:
            outcome = _as_before(task, line, recipe)
        if outcome is None:
            others.append(task)
        else:
            known.append(outcome)
    return known, others


def _as_before(task: Task, line: Mapping[str, Any], recipe: str) -> Outcome | None:
    """Return what a line says of a file, if all that it rests on is as it was."""
    digest, key = line.get("input_sha256"), line.get("key")
    if not digest or key != result_key(str(digest), recipe):
        return None
    session = mark_of(task.path)
    if not session or list(session) != line.get("input_mark"):
        return None
    if line.get("state") == State.FAILED:
        if not line.get("lasting"):
            return None
        reason, traces = str(line.get("reason", "")), Traces(str(digest), session)
        return Outcome(
            *(task.path, task.result, State.FAILED, str(key), reason),
            lasting=True,
            traces=traces,
        )
    result = mark_of(task.result)
    if not result or list(result) != line.get("result_mark"):
        return None
    traces = Traces(str(digest), session, result)
    return Outcome(task.path, task.result, State.SKIPPED, str(key), traces=traces)
