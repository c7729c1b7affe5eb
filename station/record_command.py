# SPDX-License-Identifier: MIT
"""``jointbench record``: a visit to a bench into a session file, with its sheet."""

import json
from dataclasses import dataclass
from pathlib import Path

from jointbench.acquisition.errors import UsageError
from jointbench.acquisition.records import Verdict
from jointbench.acquisition.session import Session
from jointbench.acquisition.session_file import read_session
from jointbench.station.campaign_sheet import HEAD
from jointbench.station.output import lasting_console, table, working, write_json
from jointbench.station.outputs import check_outputs, write_text
from jointbench.station.record_live import record_live
from jointbench.station.session_place import check_session_name, session_place
from jointbench.station.sources import Visit, open_visit

MODEL, TRUTH = ".toml", ".truth.json"


@dataclass(frozen=True, slots=True, eq=False)
class WrittenVisit:
    """What a visit left behind.

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


def write_visit(url: str, path: Path, *, overwrite: bool = False) -> WrittenVisit:
    """Record the bench that `url` names into a session file.

    Args:
        url: of the bench.
        path: of the session file; a sheet goes beside it as ``.toml``, the truth of a
            simulated bench as ``.truth.json``.
        overwrite: replace an earlier session and its sheets, once all is recorded.

    Raises:
        UsageError: the URL makes no sense, a file is there and `overwrite` is off, or
            what is there is no earlier session.
    """
    visit = open_visit(url)
    with session_place(path, overwrite=overwrite) as place:
        for own in _sheets(visit, path):
            _require_free(own, overwrite=overwrite)
        whole = record_live(visit, place.own)
        path = place.settle(whole=whole)
    for own, text in _sheets(visit, path).items():
        write_text(own, text)
    model, truth = path.with_suffix(MODEL), path.with_suffix(TRUTH)
    return WrittenVisit(
        session=read_session(path),
        path=path,
        model=None if visit.sheet is None else model,
        truth=None if visit.truth is None else truth,
        whole=whole,
        stays="" if path == place.asked else place.stays,
    )


def _sheets(visit: Visit, path: Path) -> dict[Path, str]:
    """Return what goes beside a session, as texts by their paths."""
    found = {}
    if visit.sheet is not None:
        found[path.with_suffix(MODEL)] = visit.sheet
    if visit.truth is not None:
        found[path.with_suffix(TRUTH)] = json.dumps(visit.truth, indent=1) + "\n"
    return found


def _require_free(path: Path, *, overwrite: bool) -> None:
    """Refuse a sheet that is there, unless it is an earlier one and may be replaced."""
    if not path.exists():
        return
    if not overwrite:
        raise UsageError(f"'{path}' is there already; add --force to overwrite it")
    if path.suffix != MODEL:
        check_outputs([], [path])
    elif not path.is_file() or not path.read_bytes().startswith(HEAD.encode()):
        raise UsageError(
            f"'{path}' is there already and no sheet of a bench; choose another name "
            "for the session, or move it away"
        )


def run_record(
    url: str, out: Path, *, overwrite: bool, json_target: str | None
) -> WrittenVisit:
    """Record a bench and say what was recorded.

    Args:
        url: of the bench.
        out: session file to write.
        overwrite: replace an earlier session and its sheets, once all is recorded.
        json_target: where the JSON goes.
    """
    check_session_name(out)
    check_outputs([out], [json_target])
    with working(f"recording {url}"):
        written = write_visit(url, out, overwrite=overwrite)
    _show(written, json_target)
    return written


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
    screen = lasting_console(json_target)
    screen.print(table(f"{written.path}", ("visit", "holds"), rows))
    for words, path in (("model", written.model), ("truth", written.truth)):
        if path is not None:
            screen.print(f"{words}: {path}")
    for words in (written.stays, "" if written.whole else "stopped before its end"):
        if words:
            screen.print(words, soft_wrap=True)
    if written.model is not None:
        screen.print(f"\nnext: jointbench gap {written.path} --model {written.model}")
    write_json(
        json_target,
        {
            "session": str(written.path),
            "interrupted": not written.whole,
            "model": None if written.model is None else str(written.model),
            "truth": None if written.truth is None else str(written.truth),
            "recordings": len(session.recordings),
            "hits": len(hits),
            "accepted_hits": good,
            "preloads_n": preloads,
        },
    )
