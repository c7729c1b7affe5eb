# SPDX-License-Identifier: MIT
"""What recordings of a session are for: hits, an operating run, a shaker run."""

from collections.abc import Sequence

from jointbench.acquisition.records.recordings import Recording


def purpose_of(recording: Recording) -> str:
    """Return the purpose that was stored with a recording, empty where none was."""
    purposes = (dict(step.detail).get("purpose") for step in recording.provenance)
    return next((str(purpose) for purpose in purposes if purpose), "")


def shaker_runs(recordings: Sequence[Recording]) -> tuple[Recording, ...]:
    """Return the runs with a shaker."""
    return tuple(r for r in recordings if purpose_of(r) == "shaker")


def operating_runs(recordings: Sequence[Recording]) -> tuple[Recording, ...]:
    """Return the operating runs."""
    return tuple(r for r in recordings if purpose_of(r) == "operating")
