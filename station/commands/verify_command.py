# SPDX-License-Identifier: MIT
"""``jointbench verify`` and ``jointbench recover`` for one session."""

from dataclasses import replace
from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.file_access.file_lock import is_held
from jointbench.acquisition.session_file.finish import Finished, finish_live
from jointbench.acquisition.session_file.open_session import open_session
from jointbench.acquisition.session_file.overwrite_guard import require_replaceable
from jointbench.acquisition.session_file.recovery import recovered_path
from jointbench.acquisition.session_file.store import (
    read_session,
    write_session,
)
from jointbench.station.archive.session_problems import (
    is_live,
    live_content,
    problems_of,
)
from jointbench.station.files.output_paths import check_outputs
from jointbench.station.screen.terminal import console, progress_bar, table, write_json
from jointbench.station.sources.record_live import HITS_LATER, with_hits


def run_verify(file: Path, *, json_target: str | None) -> bool:
    """Read every sample of a session, checksums included, and list the problems.

    Args:
        file: a session, finished or not.
        json_target: where the JSON goes.

    Returns:
        True if there is no problem.

    Raises:
        BadData: the file cannot be read at all.
    """
    check_outputs([file], [json_target])
    problems = problems_of(file)
    session = open_session(file)
    screen = console(json_target)
    rows = [
        ("recordings", f"{len(session.recordings)}"),
        (
            "samples per channel",
            f"{sum(r.samples.shape[1] for r in session.recordings)}",
        ),
        ("hits", f"{sum(len(r.hits) for r in session.recordings)}"),
        ("surfaces", f"{len(session.surfaces)}"),
        ("verdict", "intact" if not problems else "DAMAGED"),
    ]
    screen.print(table(f"{file}", ("session", "content"), rows))
    for problem in problems:
        screen.print(problem, soft_wrap=True)
    write_json(json_target, {"whole": not problems, "problems": problems})
    return not problems


def run_recover(
    file: Path, *, out: Path | None, overwrite: bool, json_target: str | None
) -> Path:
    """Recover a session from an interrupted recording.

    Args:
        file: of the recording; it is not changed.
        out: session file; ``*.recovered.h5`` next to the recording by default.
        overwrite: replace an existing file.
        json_target: where the JSON goes.

    Raises:
        UsageError: the recording is still running, or is a finished session.
        BadData: no part of it can be read.
    """
    if is_held(file):
        raise UsageError(
            f"'{file}' is still being recorded; wait until the recording ends"
        )
    if not is_live(file):
        raise UsageError(
            f"'{file}' is a finished session and needs no recovery; "
            "check it with `jointbench verify`"
        )
    target = out or recovered_path(file)
    check_outputs([file, target], [json_target])
    if target.resolve() == file.resolve():
        raise UsageError(f"'{target}' is the input file; choose another --out")
    if target.exists() and overwrite:
        require_replaceable(target)
    done = _recover(file, target, overwrite=overwrite)
    console(json_target).print(
        f"{target}: {done.samples} samples per channel, {done.hits} hits, "
        f"{done.damaged} damaged blocks excluded",
        soft_wrap=True,
    )
    write_json(
        json_target,
        {
            "session": str(target),
            "samples": done.samples,
            "hits": done.hits,
            "damaged_blocks": done.damaged,
            "finished": done.ended,
        },
    )
    return target


def _recover(file: Path, target: Path, *, overwrite: bool) -> Finished:
    """Write the recovered session; judge hits that the recording left unjudged."""
    with progress_bar("recovering") as bar:
        done = finish_live(
            file,
            target,
            overwrite=overwrite,
            progress=lambda share: bar("recovering", share),
        )
    content = live_content(file)
    if content is None or not content.meta.items() >= HITS_LATER.items():
        return done
    session = with_hits(read_session(target))
    write_session(session, target, overwrite=True)
    return replace(done, hits=sum(len(r.hits) for r in session.recordings))
