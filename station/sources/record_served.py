# SPDX-License-Identifier: MIT
"""Recording of simulated runs through the recording process, each from its chassis."""

from collections.abc import Mapping
from contextlib import AbstractContextManager, ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol, runtime_checkable

from jointbench.acquisition.basics.errors import InstrumentError
from jointbench.acquisition.recorder.recorder_process import RecorderProcess
from jointbench.acquisition.recorder.requests import Setup
from jointbench.acquisition.records.recordings import Channel, Quantity
from jointbench.acquisition.records.source import Run
from jointbench.station.sources.open_source import RunSequence


@dataclass(slots=True)
class Progress:
    """How far a recording has come.

    Attributes:
        interrupted: whether a stop was requested.
    """

    interrupted: bool = False


@runtime_checkable
class ServedRun(Protocol):
    """A run that a chassis delivers."""

    def served(self) -> AbstractContextManager[Setup]:
        """Serve the chassis, and yield what is streamed from it."""
        ...


def record_served(
    sequence: RunSequence, path: Path, meta: Mapping[str, object], progress: Progress
) -> None:
    """Record runs of simulated chassis into one file.

    Args:
        sequence: an opened source; its runs are `ServedRun`.
        path: of a file that is not there yet.
        meta: data known before the first sample, as JSON types.
        progress: is interrupted from outside.

    Raises:
        InstrumentError: a run has other channels than the first, or the recording
            process died; the file holds what was recorded until then.
        UsageError: the file cannot be written.
    """
    recorder: RecorderProcess | None = None
    with ExitStack() as stack:
        before = stack.enter_context(ExitStack())
        for run in sequence.runs:
            require_same(sequence.runs[0], run)
            present = stack.enter_context(ExitStack())
            assert isinstance(run, ServedRun)
            setup = present.enter_context(run.served())
            if recorder is None:
                recorder = stack.enter_context(
                    RecorderProcess(setup, given_up=lambda: progress.interrupted)
                )
                recorder.begin(path, meta, finish=False)
            else:
                recorder.change(setup)
            before.close()
            before = present
            recorder.log(run_entry(run))
            _follow(recorder, progress)
            if progress.interrupted:
                break
        if recorder is not None:
            recorder.stop(interrupted=progress.interrupted)


def _follow(recorder: RecorderProcess, progress: Progress) -> None:
    for _ in recorder.follow():
        if progress.interrupted:
            return
    progress.interrupted |= recorder.interrupted


def run_entry(run: Run) -> dict[str, object]:
    """Return the entry of the log that begins a run."""
    return {
        "kind": "run",
        "name": run.name,
        "purpose": "measurement",
        "point": _struck(run.channels),
        "preload": run.preload,
        "start_time": run.start_time,
    }


def _struck(channels: tuple[Channel, ...]) -> str:
    """Return the point of the hammer, empty where there is none."""
    points = (c.point for c in channels if c.quantity is Quantity.FORCE)
    return next(points, "")


def require_same(first: Run, run: Run) -> None:
    """Refuse a run that a file of the first one's channels cannot hold."""
    same = [replace(channel, point="") for channel in first.channels]
    if (
        run.sample_rate != first.sample_rate
        or [replace(channel, point="") for channel in run.channels] != same
    ):
        raise InstrumentError(
            f"run {run.name!r} has other channels or another rate than "
            f"{first.name!r}; record it into a session of its own"
        )
