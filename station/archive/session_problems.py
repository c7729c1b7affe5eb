# SPDX-License-Identifier: MIT
"""Problems of a session file that its own content shows."""

from pathlib import Path

from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.file_access.file_lock import is_held
from jointbench.acquisition.file_access.hdf5_guards import open_guarded
from jointbench.acquisition.file_access.netcdf_read import read_attribute
from jointbench.acquisition.records.provenance import Step
from jointbench.acquisition.records.session import Session
from jointbench.acquisition.session_file.live_read import LiveContent, read_live
from jointbench.acquisition.session_file.live_write import LIVE_SCHEMA
from jointbench.acquisition.session_file.open_session import (
    open_session,
    read_all_samples,
)
from jointbench.acquisition.session_file.session_limits import SESSION_LIMITS
from jointbench.acquisition.session_file.store import damage_named


def is_live(file: Path) -> bool:
    """Return whether a file is a recording that was not finished."""
    with open_guarded(file, limits=SESSION_LIMITS) as opened, damage_named(file):
        return read_attribute(opened, "schema") == LIVE_SCHEMA


def live_content(file: Path) -> LiveContent | None:
    """Return what a recording's file holds, None for a file of another layout."""
    with open_guarded(file, limits=SESSION_LIMITS) as opened, damage_named(file):
        if read_attribute(opened, "schema") != LIVE_SCHEMA:
            return None
        return read_live(opened)


def problems_of(file: Path) -> list[str]:
    """Return what is wrong with a session, a line each, once all of it was read."""
    content = live_content(file)
    if content is not None:
        state = "is being recorded right now" if is_held(file) else "was cut off"
        found = [f"the recording {state}; `jointbench recover` saves what is there"]
        if content.damaged:
            found.append(f"{content.damaged} blocks have a wrong checksum")
        return found
    try:
        read_all_samples(file)
        return _session_problems(open_session(file))
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
    gaps = [dict(s.detail) for s in session.provenance if s.name == "gap"]
    missing = sum(int(gap.get("samples", 0)) for gap in gaps)
    for step in session.provenance:
        found += _step_problems(step, stored, missing)
    return found


def _step_problems(step: Step, stored: int, missing: int) -> list[str]:
    detail = dict(step.detail)
    if step.name == "recovered":
        damaged = int(detail.get("damaged_blocks", 0))
        words = f"recovered after a crash, {damaged} damaged blocks left out"
        return [words] if damaged else []
    if step.name != "continuity":
        return []
    found = []
    lost = detail.get("lost", 0)
    if lost:
        found.append(f"{lost} samples per channel were lost at the device")
    if lost != missing:
        found.append(f"the gaps state {missing} missing samples, the device {lost}")
    if detail.get("stored_samples") != stored:
        found.append(f"{stored} samples are there, {detail.get('stored_samples')} were")
    return found
