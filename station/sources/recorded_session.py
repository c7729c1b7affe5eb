# SPDX-License-Identifier: MIT
"""Record a bench by its URL into a session file, with its nominal parameters."""

import json
from dataclasses import dataclass
from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.session import Session
from jointbench.acquisition.session_file.store import read_session
from jointbench.station.files.output_paths import check_outputs, write_text
from jointbench.station.files.session_place import session_place
from jointbench.station.sources.campaign_model import HEAD
from jointbench.station.sources.open_source import RunSequence, open_runs
from jointbench.station.sources.record_live import record_live

MODEL, TRUTH = ".toml", ".truth.json"


@dataclass(frozen=True, slots=True, eq=False)
class RecordedSession:
    """Files written by a recording.

    Attributes:
        session: as written.
        path: of the session file.
        model: of the bench model beside it, or None where the bench brings none.
        truth: of what a simulated bench hides, or None.
        whole: whether all of it was recorded.
        stays: in words, which file is which where an earlier session keeps its name.
    """

    session: Session
    path: Path
    model: Path | None
    truth: Path | None
    whole: bool = True
    stays: str = ""


def record_session_file(
    url: str, path: Path, *, overwrite: bool = False
) -> RecordedSession:
    """Record the bench that `url` names into a session file.

    Args:
        url: of the bench.
        path: of the session file; the model is written next to it as ``.toml``, the
            truth of a simulated bench as ``.truth.json``.
        overwrite: replace an earlier session and its model, once all is recorded.

    Raises:
        UsageError: the URL makes no sense, a file is there and `overwrite` is off, or
            what is there is no earlier session.
    """
    sequence = open_runs(url)
    with session_place(path, overwrite=overwrite) as place:
        for own in _side_files(sequence, path):
            _require_free(own, overwrite=overwrite)
        whole = record_live(sequence, place.own)
        path = place.settle(whole=whole)
    for own, text in _side_files(sequence, path).items():
        write_text(own, text)
    model, truth = path.with_suffix(MODEL), path.with_suffix(TRUTH)
    return RecordedSession(
        session=read_session(path),
        path=path,
        model=None if sequence.model is None else model,
        truth=None if sequence.truth is None else truth,
        whole=whole,
        stays="" if path == place.asked else place.stays,
    )


def _side_files(sequence: RunSequence, path: Path) -> dict[Path, str]:
    """Return what goes beside a session, as texts by their paths."""
    found = {}
    if sequence.model is not None:
        found[path.with_suffix(MODEL)] = sequence.model
    if sequence.truth is not None:
        found[path.with_suffix(TRUTH)] = json.dumps(sequence.truth, indent=1) + "\n"
    return found


def _require_free(path: Path, *, overwrite: bool) -> None:
    """Refuse an existing model, unless it is an earlier one and may be replaced."""
    if not path.exists():
        return
    if not overwrite:
        raise UsageError(f"'{path}' is there already; add --force to overwrite it")
    if path.suffix != MODEL:
        check_outputs([], [path])
    elif not path.is_file() or not path.read_bytes().startswith(HEAD.encode()):
        raise UsageError(
            f"'{path}' exists already and is no bench model; choose another name "
            "for the session, or move it away"
        )
