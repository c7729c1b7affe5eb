# SPDX-License-Identifier: MIT
"""The results that lie beside a session: what `modal` or a recipe made of it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.file_access.quoting import named, visible
from jointbench.acquisition.file_access.text_files import file_digest
from jointbench.acquisition.records.recordings import Recording
from jointbench.station.files.archive_patterns import RESULTS_SUFFIX
from jointbench.station.pipeline.recordings_by_preload import by_preload, of_preload
from jointbench.station.results.results_file import results_path
from jointbench.station.results.results_modes import StoredModes, StoredRun, read_run


@dataclass(frozen=True, slots=True, eq=False)
class StoredResults:
    """Modes that were stored, by the preload of the joint.

    Attributes:
        found: preload [N], modes, and by which run, of each.
        remarks: which results are shown, and which are not, a line each.
    """

    found: tuple[tuple[float | None, StoredModes, str], ...]
    remarks: tuple[str, ...]

    def at(self, preload: float | None) -> tuple[StoredModes, str] | None:
        """Return the modes at a preload and by which run, or None."""
        for own, modes, run in self.found:
            if own == preload:
                return modes, run
        return None


def stored_results(
    session: Path, recordings: Sequence[Recording], given: Path | None
) -> StoredResults:
    """Return the results that a report of a session shows.

    Those of ``jointbench modal`` beside it; else, the latest of a recipe.

    Args:
        session: its file.
        recordings: of it.
        given: a results file to show in place of these, or None.

    Raises:
        UsageError: the file given was made of another session.
        CorruptedFile: a results file is not what its digest says.
    """
    digest = file_digest(session)
    preloads = [preload for preload, _ in by_preload(recordings)]
    remarks: list[str] = []
    if given is not None:
        run = read_run(given)
        if digest not in run.inputs:
            raise UsageError(
                f"{named(given)} was not made of {named(session)} as it is now; make "
                "the results again, or leave --results out"
            )
        found = list(_placed(run, preloads, None))
    else:
        found = _of_modal(session, preloads, digest, remarks)
        found = found or _of_recipe(session, preloads, digest, remarks)
    shown = {run.path.name: run.words for _, _, run in found}
    remarks[:0] = [f"Modes from {visible(n)} ({w})." for n, w in shown.items()]
    remarks += [
        f"{visible(path.name)} lies there, too; --results shows it."
        for path in _beside(session)
        if path.name not in shown and given is None and _is_of(path, digest)
    ]
    rows = tuple(
        (preload, modes, f"{visible(run.path.name)}: {run.words}")
        for preload, modes, run in found
    )
    return StoredResults(rows, tuple(remarks))


Found = list[tuple[float | None, StoredModes, StoredRun]]


def _of_modal(
    session: Path, preloads: Sequence[float | None], digest: str, remarks: list[str]
) -> Found:
    """Return what `jointbench modal` left: a file, or one for each preload."""
    found: Found = []
    target = results_path(session)
    several = len(preloads) > 1
    for preload in preloads:
        path = of_preload(target, preload) if several else target
        if path.is_file():
            run = read_run(path)
            if digest in run.inputs:
                found += _placed(run, [preload], preload)
            else:
                remarks.append(_stale(path))
    return found


def _of_recipe(
    session: Path, preloads: Sequence[float | None], digest: str, remarks: list[str]
) -> Found:
    """Return the latest result of a recipe that was made of the session."""
    latest = sorted(_beside(session), key=lambda p: p.stat().st_mtime_ns, reverse=True)
    for path in latest:
        run = read_run(path)
        if digest in run.inputs and run.modes:
            return list(_placed(run, preloads, None))
        if _stale(path) not in remarks and digest not in run.inputs:
            remarks.append(_stale(path))
    return []


def _placed(
    run: StoredRun, preloads: Sequence[float | None], own: float | None
) -> Iterator[tuple[float | None, StoredModes, StoredRun]]:
    """Yield the modes of a run with the preload of the session that they are at."""
    for modes in run.modes:
        preload = modes.preload if modes.preload in preloads else own
        if preload is None and len(preloads) == 1:
            preload = preloads[0]
        yield preload, modes, run


def _stale(path: Path) -> str:
    return (
        f"{visible(path.name)} is not shown: it was made from another state of the "
        "session; make it again"
    )


def _is_of(path: Path, digest: str) -> bool:
    run = read_run(path)
    return digest in run.inputs and bool(run.modes)


def _beside(session: Path) -> list[Path]:
    """Return the results files whose names begin with that of the session."""
    begin = f"{session.stem}."
    return sorted(
        path
        for path in session.parent.iterdir()
        if path.name.startswith(begin) and path.name.endswith(RESULTS_SUFFIX)
    )
