# SPDX-License-Identifier: MIT
"""``jointbench record``: a whole campaign into a session file, with its model."""

from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.file_access.quoting import named
from jointbench.acquisition.records.recordings import Verdict
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.files.session_place import check_session_name
from jointbench.station.screen.terminal import (
    lasting_console,
    table,
    working,
    write_json,
)
from jointbench.station.sources.recorded_session import (
    RecordedSession,
    record_session_file,
)


def require_bench(source: str) -> None:
    """Refuse a file or folder where a plan or a bench is wanted.

    Raises:
        UsageError: it is there, and is no plan.
    """
    path = Path(source)
    if not path.exists():
        return
    is_a = "a folder" if path.is_dir() else "a file, but no plan of runs"
    raise UsageError(
        f"{named(path)} is {is_a}; 'record' takes a plan whose name ends in '.toml', "
        "or a bench such as 'sim:two-body-campaign' (files of other programs: "
        "'jointbench import')"
    )


def run_record(
    url: str, out: Path, *, overwrite: bool, json_target: str | None
) -> RecordedSession:
    """Record a campaign and list its content.

    Args:
        url: of the bench.
        out: session file to write.
        overwrite: replace an earlier session and its model, after the recording.
        json_target: where the JSON goes.
    """
    check_session_name(out)
    check_outputs([out], [json_target])
    with working(f"recording {url}"):
        written = record_session_file(url, out, overwrite=overwrite)
    _show(written, json_target)
    return written


def _show(written: RecordedSession, json_target: str | None) -> None:
    session = written.session
    hits = [hit for recording in session.recordings for hit in recording.hits]
    accepted = sum(hit.verdict is Verdict.OK for hit in hits)
    preloads = sorted({r.preload for r in session.recordings if r.preload is not None})
    rows = [
        ("recordings", f"{len(session.recordings)}"),
        ("hits", f"{len(hits)}, {accepted} accepted"),
        ("hit points", ", ".join(sorted({hit.point for hit in hits})) or "-"),
        ("preloads", ", ".join(f"{p:g} N" for p in preloads) or "-"),
    ]
    screen = lasting_console(json_target)
    screen.print(table(f"{written.path}", ("session", "content"), rows))
    for words, path in (("model", written.model), ("truth", written.truth)):
        if path is not None:
            screen.print(f"{words}: {path}", soft_wrap=True)
    for words in (
        written.stays,
        "" if written.whole else "the recording was interrupted",
    ):
        if words:
            screen.print(words)
    if written.model is not None:
        screen.print(
            f"\nnext: jointbench gap {written.path} --model {written.model}",
            soft_wrap=True,
        )
    write_json(
        json_target,
        {
            "session": str(written.path),
            "interrupted": not written.whole,
            "model": None if written.model is None else str(written.model),
            "truth": None if written.truth is None else str(written.truth),
            "recordings": len(session.recordings),
            "hits": len(hits),
            "accepted_hits": accepted,
            "preloads_n": preloads,
        },
    )
