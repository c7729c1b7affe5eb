# SPDX-License-Identifier: MIT
"""``jointbench verify`` and ``jointbench recover``: is a session whole, and if not."""

from dataclasses import replace
from pathlib import Path

from jointbench.acquisition.errors import BadData, UsageError
from jointbench.acquisition.guards import open_guarded
from jointbench.acquisition.netcdf_read import read_attribute
from jointbench.acquisition.records import Step
from jointbench.acquisition.session import Session
from jointbench.acquisition.session_file import (
    damage_named,
    read_session,
    write_session,
)
from jointbench.acquisition.session_finish import Finished, finish_live
from jointbench.acquisition.session_live import LIVE_SCHEMA
from jointbench.acquisition.session_live_read import LiveContent, read_live
from jointbench.acquisition.session_lock import is_held
from jointbench.acquisition.session_recover import recovered_path
from jointbench.acquisition.session_replace import require_replaceable
from jointbench.station.output import console, table, write_json
from jointbench.station.outputs import check_outputs
from jointbench.station.record_live import HITS_LATER, with_hits


def run_verify(file: Path, *, json_target: str | None) -> bool:
    """Read every sample of a session, checksums included, and say what is wrong.

    Args:
        file: a session, finished or not.
        json_target: where the JSON goes.

    Returns:
        True where nothing is.

    Raises:
        BadData: it cannot be read at all.
    """
    check_outputs([file], [json_target])
    problems = problems_of(file)
    session = read_session(file)
    screen = console(json_target)
    rows = [
        ("recordings", f"{len(session.recordings)}"),
        (
            "samples per channel",
            f"{sum(r.samples.shape[1] for r in session.recordings)}",
        ),
        ("hits", f"{sum(len(r.hits) for r in session.recordings)}"),
        ("surfaces", f"{len(session.surfaces)}"),
        ("verdict", "whole" if not problems else "LOOK AT IT"),
    ]
    screen.print(table(f"{file}", ("session", "holds"), rows))
    for problem in problems:
        screen.print(problem, soft_wrap=True)
    write_json(json_target, {"whole": not problems, "problems": problems})
    return not problems


def run_recover(
    file: Path, *, out: Path | None, overwrite: bool, json_target: str | None
) -> Path:
    """Save what is left of a recording that did not come to its end.

    Args:
        file: of the recording; it is left as it is.
        out: where to; beside it as ``*.recovered.h5`` by default.
        overwrite: replace a file that is there.
        json_target: where the JSON goes.

    Raises:
        UsageError: it is being recorded right now, or is a finished session.
        BadData: nothing of it can be read.
    """
    if is_held(file):
        raise UsageError(f"'{file}' is being recorded right now; wait until it is done")
    if not _is_live(file):
        raise UsageError(
            f"'{file}' is a finished session, there is nothing to recover; "
            "`jointbench verify` reads it through"
        )
    target = out or recovered_path(file)
    check_outputs([file, target], [json_target])
    if target.resolve() == file.resolve():
        raise UsageError(f"'{target}' is an input; recover to another file")
    if target.exists() and overwrite:
        require_replaceable(target)
    done = _recover(file, target, overwrite=overwrite)
    console(json_target).print(
        f"{target}: {done.samples} samples per channel, {done.hits} hits, "
        f"{done.damaged} damaged blocks left out",
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
    """Finish a recording beside it; hits that were to be judged later are judged."""
    done = finish_live(file, target, overwrite=overwrite)
    content = _live_content(file)
    if content is None or not content.meta.items() >= HITS_LATER.items():
        return done
    session = with_hits(read_session(target))
    write_session(session, target, overwrite=True)
    return replace(done, hits=sum(len(r.hits) for r in session.recordings))


def _is_live(file: Path) -> bool:
    with open_guarded(file) as opened, damage_named(file):
        return read_attribute(opened, "schema") == LIVE_SCHEMA


def _live_content(file: Path) -> LiveContent | None:
    """Return what a recording's file holds, None for a file of another layout."""
    with open_guarded(file) as opened, damage_named(file):
        if read_attribute(opened, "schema") != LIVE_SCHEMA:
            return None
        return read_live(opened)


def problems_of(file: Path) -> list[str]:
    """Return what is wrong with a session, a line each, once all of it was read."""
    content = _live_content(file)
    if content is not None:
        state = "is being recorded right now" if is_held(file) else "was cut off"
        found = [f"the recording {state}; `jointbench recover` saves what is there"]
        if content.damaged:
            found.append(f"{content.damaged} blocks have a wrong checksum")
        return found
    try:
        return _session_problems(read_session(file))
    except BadData as error:
        return [str(error)]


def _session_problems(session: Session) -> list[str]:
    found = []
    for recording in session.recordings:
        count = recording.samples.shape[1]
        for number, hit in enumerate(recording.hits, 1):
            if not 0 <= hit.start <= hit.trigger < hit.stop <= count:
                found.append(
                    f"{recording.name}: hit {number} lies outside its {count} samples"
                )
    stored = sum(recording.samples.shape[1] for recording in session.recordings)
    for step in session.provenance:
        found += _step_problems(step, stored)
    return found


def _step_problems(step: Step, stored: int) -> list[str]:
    detail = dict(step.detail)
    if step.name == "recovered":
        return [f"recovered after a crash, {detail['damaged_blocks']} damaged blocks"]
    if step.name != "continuity":
        return []
    found = []
    if detail.get("lost"):
        found.append(f"{detail['lost']} samples per channel were lost at the device")
    if detail.get("stored_samples") != stored:
        found.append(f"{stored} samples are there, {detail.get('stored_samples')} were")
    return found
