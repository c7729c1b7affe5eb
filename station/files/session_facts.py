# SPDX-License-Identifier: MIT
"""What a session says of itself: the columns by which an archive is sorted."""

import re
from pathlib import Path

from jointbench.acquisition.file_access.quoting import visible
from jointbench.acquisition.records.session import Session

_SPECIMEN = re.compile(r"\bspecimen\s*[:=]\s*([^;,\n]+)", re.IGNORECASE)


def session_facts(session: Session, path: Path) -> dict[str, str | float | bool | None]:
    """Return when, by whom, on what and at which torque a session was recorded.

    Args:
        session: as recorded.
        path: of its file.

    Returns:
        ``session`` (uuid), ``recorded``, ``operator``, ``specimen``, ``source``,
        ``simulated``, ``torque`` [N m] and ``preload`` [N] (None where not given).
    """
    joint = session.joint
    return {
        "session": session.uuid,
        "recorded": session.created,
        "operator": session.operator,
        "specimen": specimen_of(session, path),
        "source": session.source,
        "simulated": session.simulated,
        "torque": _torque(session),
        "preload": None if joint is None else joint.preload,
    }


def specimen_of(session: Session, path: Path) -> str:
    """Return what the notes call the specimen ("specimen: P7"), else its folder."""
    named = _SPECIMEN.search(session.notes)
    return named[1].strip() if named else visible(path.absolute().parent.name)


def _torque(session: Session) -> float | None:
    """Return the torque on each bolt [N m], if it was one and the same."""
    if session.joint is not None and session.joint.torque is not None:
        return session.joint.torque
    torques = {
        float(value)
        for recording in session.recordings
        for step in recording.provenance
        for name, value in step.detail
        if name == "torque" and not isinstance(value, str)
    }
    return torques.pop() if len(torques) == 1 else None
