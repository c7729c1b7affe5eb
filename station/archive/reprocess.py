# SPDX-License-Identifier: MIT
"""``jointbench reprocess``: an archive under a recipe, resumable, in a pool or beyond.

What is done is known by the results that are there, so that Ctrl-C, a kill or a power
loss cost at most the files in progress; call again to continue.
"""

import os
import time
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import closing, suppress
from pathlib import Path

from jointbench.acquisition.basics.errors import InstrumentError, UsageError
from jointbench.station.archive.cluster import (
    ClusterSettings,
    require_safe,
    run_cluster,
)
from jointbench.station.archive.ledger import Ledger, now, open_ledger, write_quarantine
from jointbench.station.archive.process_file import Outcome, Task
from jointbench.station.archive.process_outcome import STAGES_FOLDER, recipe_or_default
from jointbench.station.archive.reprocess_progress import run_progress
from jointbench.station.archive.reprocess_summary import (
    Places,
    RunSummary,
    show_summary,
    summary_json,
)
from jointbench.station.archive.unchanged_files import settled
from jointbench.station.archive.worker_pool import PoolSettings, run_pool
from jointbench.station.files.archive_patterns import (
    archive_folder,
    common_folder,
    session_files,
)
from jointbench.station.files.output_paths import (
    check_outputs,
    make_folder,
    require_folder,
)
from jointbench.station.pipeline.stage_store import prune_stages
from jointbench.station.results.processed_file import processed_path
from jointbench.station.schemas.recipe import Recipe, recipe_digest
from jointbench.station.screen.interrupt import interruptible
from jointbench.station.screen.terminal import write_json

PRUNE_EVERY = 500
Backend = Callable[[Sequence[Task], Recipe], Iterator[Outcome]]


def pool_backend(settings: PoolSettings) -> Backend:
    """Return the pool of processes as a backend."""
    return lambda tasks, recipe: run_pool(tasks, recipe, settings)


def cluster_backend(settings: ClusterSettings) -> Backend:
    """Return a Dask cluster as a backend; refused at once where it is not safe."""
    require_safe(settings)
    return lambda tasks, recipe: run_cluster(tasks, recipe, settings)


def make_tasks(
    files: Sequence[Path],
    recipe: Recipe,
    places: Places,
    *,
    root: Path | None = None,
    again: bool = False,
) -> list[Task]:
    """Return one task a file, each with the place of its result.

    Args:
        files: sessions.
        recipe: how they are read.
        places: where to write.
        root: folder whose tree the results have again; what all have in common if None.
        again: process what has a result, too.

    Raises:
        UsageError: two files would have the same result.
    """
    root = root or common_folder(files)
    tasks = []
    for path in files:
        result = processed_path(path, recipe)
        if places.results is not None:
            result = places.results / os.path.relpath(result, root)
        tasks.append(Task(path, result, places.stages, again=again))
    taken: dict[Path, Path] = {}
    for task in tasks:
        other = taken.setdefault(task.result.absolute(), task.path)
        if other != task.path:
            raise UsageError(
                f"'{other}' and '{task.path}' would both become '{task.result}'; "
                "rename one of them"
            )
    return tasks


def reprocess(
    tasks: Sequence[Task], recipe: Recipe, places: Places, backend: Backend
) -> RunSummary:
    """Process all files that have no result yet, and keep the ledger.

    Args:
        tasks: see `make_tasks`.
        recipe: how to read them.
        places: where to write.
        backend: what runs them.

    Returns:
        What became of every file met; not all of them where it was interrupted.
    """
    summary, begun = RunSummary(), time.monotonic()
    run = {"recipe": recipe.name, "recipe_sha256": recipe_digest(recipe)}
    with (
        open_ledger(places.ledger, run | {"files": len(tasks)}) as ledger,
        interruptible(),
        run_progress(len(tasks)) as tell,
    ):
        known, others = settled(tasks, ledger.last, recipe_digest(recipe))
        waiting = [_remembering(task, ledger) for task in others]
        _make_room(waiting)
        try:
            with closing(_outcomes(known, waiting, recipe, backend)) as outcomes:
                for outcome in outcomes:
                    if outcome.unwritable:  # no fault of the file
                        summary.unwritable = outcome.reason
                        break
                    ledger.outcome(outcome)
                    summary.outcomes.append(outcome)
                    tell(summary.counts)
                    _prune(places, len(summary.outcomes))
        except KeyboardInterrupt:
            summary.interrupted = True
        except InstrumentError as error:
            summary.lost = str(error)
        summary.seconds = time.monotonic() - begun
        counts = {state.value: n for state, n in summary.counts.items()}
        end: dict[str, object] = {"kind": "end", "time": now()}
        end |= {"interrupted": summary.interrupted, "lost": summary.lost}
        ledger.write(end | counts | {"seconds": round(summary.seconds, 3)})
    _prune(places, 0)
    write_quarantine(places.quarantine, summary.failed)
    return summary


def _outcomes(
    known: Sequence[Outcome], waiting: Sequence[Task], recipe: Recipe, backend: Backend
) -> Generator[Outcome, None, None]:
    """Yield what the ledger settles, then what the backend makes of the rest."""
    yield from known
    if waiting:
        yield from backend(waiting, recipe)


def _remembering(task: Task, ledger: Ledger) -> Task:
    key, reason = ledger.refused.get(str(task.path), ("", ""))
    return Task(task.path, task.result, task.stages, key, reason, task.again)


def _make_room(tasks: Sequence[Task]) -> None:
    """Make the folders of the results, and drop what a killed run left half written."""
    for folder in {task.result.parent for task in tasks}:
        make_folder(folder)
    for task in tasks:
        with suppress(OSError):
            task.result.with_name(f"{task.result.name}.part").unlink(missing_ok=True)


def _prune(places: Places, met: int) -> None:
    if places.stages is not None and met % PRUNE_EVERY == 0:
        prune_stages(places.stages, places.stages_bytes)


def run_reprocess(
    patterns: Sequence[str],
    *,
    recipe: Path | None,
    places: Callable[[Path, Recipe], Places],
    backend: Backend,
    again: bool,
    json_target: str | None,
) -> RunSummary:
    """Reprocess what patterns name, and show what became of it.

    Args:
        patterns: files, folders or patterns.
        recipe: TOML, or None for the defaults.
        places: makes the places of a run from the common folder and the recipe.
        backend: what runs the files.
        again: process files that have a result, too.
        json_target: where the JSON goes.

    Raises:
        KeyboardInterrupt: it was stopped, after all was put in order.
        UsageError: results cannot be written.
        InstrumentError: the cluster does not answer, or was lost on the way; all that
            was done until then is put in order.
    """
    check_outputs([recipe] if recipe else [], [json_target])
    made = recipe_or_default(recipe)
    files = session_files(patterns)
    root = archive_folder(patterns)
    here = places(root, made)
    tasks = make_tasks(files, made, here, root=root, again=again)
    summary = reprocess(tasks, made, here, backend)
    show_summary(summary, len(tasks), here, json_target)
    write_json(json_target, summary_json(summary, len(tasks), made, here))
    if summary.interrupted:
        raise KeyboardInterrupt
    if summary.unwritable:
        raise UsageError(summary.unwritable)
    if summary.lost:
        raise InstrumentError(summary.lost)
    return summary


def default_places(
    results: Path | None,
    ledger: Path | None,
    stages: Path | None,
    *,
    keep_stages: bool,
    stages_bytes: int,
) -> Callable[[Path, Recipe], Places]:
    """Return what makes the places of a run; what is None lies beside the results."""
    require_folder(stages, "--stages")

    def places(root: Path, recipe: Recipe) -> Places:
        home = results or root
        make_folder(home)
        kept = stages or home / STAGES_FOLDER
        return Places(
            results,
            ledger or home / f"{recipe.name}.ledger.jsonl",
            kept if keep_stages else None,
            stages_bytes,
        )

    return places
