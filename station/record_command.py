# SPDX-License-Identifier: MIT
"""``jointbench record``: a visit to a bench into a session file, with its sheet."""

import json
from dataclasses import dataclass
from pathlib import Path

from jointbench.acquisition.errors import UsageError
from jointbench.acquisition.records import Verdict
from jointbench.acquisition.session import Session
from jointbench.acquisition.session_file import write_session
from jointbench.station.output import console, table, working, write_json
from jointbench.station.outputs import check_outputs, write_text
from jointbench.station.record import record_visit
from jointbench.station.sources import open_visit


@dataclass(frozen=True, slots=True, eq=False)
class WrittenVisit:
    """What a visit left behind.

    Attributes:
        session: as written.
        path: of the session file.
        model: of the bench model beside it, or None where the bench brings none.
        truth: of what a simulated bench hides, or None.
    """

    session: Session
    path: Path
    model: Path | None
    truth: Path | None


def write_visit(url: str, path: Path, *, overwrite: bool = False) -> WrittenVisit:
    """Record the bench that `url` names into a session file.

    Args:
        url: of the bench.
        path: of the session file; a sheet goes beside it as ``.toml``, the truth of a
            simulated bench as ``.truth.json``.
        overwrite: replace files that are there.

    Raises:
        UsageError: the URL makes no sense, or a file is there and `overwrite` is off.
    """
    visit = open_visit(url)
    model = path.with_suffix(".toml") if visit.sheet is not None else None
    truth = path.with_suffix(".truth.json") if visit.truth is not None else None
    for own in (path, model, truth):
        if own is not None and own.exists() and not overwrite:
            raise UsageError(f"'{own}' is there already; add --force to overwrite it")
    session = record_visit(visit)
    write_session(session, path, overwrite=overwrite)
    if model is not None and visit.sheet is not None:
        write_text(model, visit.sheet)
    if truth is not None:
        write_text(truth, json.dumps(visit.truth, indent=1) + "\n")
    return WrittenVisit(session, path, model, truth)


def run_record(
    url: str, out: Path, *, overwrite: bool, json_target: str | None
) -> Session:
    """Record a bench and say what was recorded.

    Args:
        url: of the bench.
        out: session file to write.
        overwrite: replace files that are there.
        json_target: where the JSON goes.
    """
    if out.suffix.lower() not in {".h5", ".hdf5"}:
        raise UsageError(f"'{out}' is no session file; name it *.h5")
    check_outputs([], [json_target])
    check_outputs([], [] if out.exists() else [out])
    with working(f"recording {url}"):
        written = write_visit(url, out, overwrite=overwrite)
    _show(written, json_target)
    return written.session


def _show(written: WrittenVisit, json_target: str | None) -> None:
    session = written.session
    hits = [hit for recording in session.recordings for hit in recording.hits]
    good = sum(hit.verdict is Verdict.OK for hit in hits)
    preloads = sorted({r.preload for r in session.recordings if r.preload is not None})
    rows = [
        ("recordings", f"{len(session.recordings)}"),
        ("hits", f"{len(hits)}, {good} accepted"),
        ("hit points", ", ".join(sorted({hit.point for hit in hits})) or "-"),
        ("preloads", ", ".join(f"{p:g} N" for p in preloads) or "-"),
    ]
    screen = console(json_target)
    screen.print(table(f"{written.path}", ("visit", "holds"), rows))
    for words, path in (("model", written.model), ("truth", written.truth)):
        if path is not None:
            screen.print(f"{words}: {path}")
    if written.model is not None:
        screen.print(f"\nnext: jointbench gap {written.path} --model {written.model}")
    write_json(
        json_target,
        {
            "session": str(written.path),
            "model": None if written.model is None else str(written.model),
            "truth": None if written.truth is None else str(written.truth),
            "recordings": len(session.recordings),
            "hits": len(hits),
            "accepted_hits": good,
            "preloads_n": preloads,
        },
    )
