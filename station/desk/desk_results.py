# SPDX-License-Identifier: MIT
"""Choices in the results beside a session: written after each, read at the start."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.file_access.file_lock import locked
from jointbench.acquisition.file_access.quoting import visible
from jointbench.acquisition.file_access.text_files import file_digest
from jointbench.station.desk.desk_choice import DeskChoice, choices_of
from jointbench.station.desk.desk_state import DeskState, desk_state
from jointbench.station.desk.desk_subject import DeskSubject
from jointbench.station.pipeline.chain import ModalChain
from jointbench.station.pipeline.stage_store import StageRun
from jointbench.station.results.results_file import results_path, write_results
from jointbench.station.results.results_modes import StoredModes, read_run


class DeskConflict(UsageError):
    """Another desk has changed the choices of the same session."""


def opened_desk(subject: DeskSubject, run: StageRun | None = None) -> DeskState:
    """Return the state of a subject, with the choices that its results hold.

    Curves over amplitude are taken from the results where they belong to these modes.

    Raises:
        BadData: there is no FRF, or no mode rises above the noise.
        CorruptedFile: the results are not what their digest says.
    """
    stored = _stored(subject)
    log = () if stored is None else choices_of(stored.steps)
    state = desk_state(subject, log, run)
    if stored is None or not stored.amplitude:
        return state
    now = state.chain.result.model.natural_frequency
    then = stored.result.model.natural_frequency
    if now.shape != then.shape or not np.allclose(now, then, rtol=1e-6):
        return state
    chain = replace(state.chain, amplitude=stored.amplitude)
    return replace(state, chain=chain)


def save_choices(state: DeskState) -> Path | None:
    """Write FRF, modes and the log of choices; nothing before the first choice.

    Returns:
        The results file, or None.

    Raises:
        UsageError: it cannot be written there.
        DeskConflict: another desk has chosen meanwhile; nothing is written.
    """
    if not state.log and not state.chain.amplitude:
        return None
    target = state.subject.results
    with locked(target):
        stored = _stored(state.subject)
        if stored is None:
            if len(state.log) == 1:
                set_aside(target)  # choices on an earlier content of the file
        else:
            _require_followed(choices_of(stored.steps), state.log)
        write_results(target, state.chain, state.subject.files)
    return target


def _require_followed(stored: Sequence[DeskChoice], log: Sequence[DeskChoice]) -> None:
    """Do nothing where a log continues the stored one.

    Raises:
        DeskConflict: another desk has chosen meanwhile.
    """
    marks = [(one.when, one.who, one.action) for one in stored]
    if marks == [(one.when, one.who, one.action) for one in log[: len(marks)]]:
        return
    last = stored[-1]
    raise DeskConflict(
        f"another desk has chosen meanwhile ({last.when} {visible(last.who)} "
        f"{visible(last.words())}); this choice was not made: look at the modes "
        "as they are now, and choose again"
    )


def chosen_at_desk(files: Sequence[Path]) -> ModalChain | None:
    """Return the modes that were chosen at the desk, where the results hold some.

    Args:
        files: one session or one file of FRFs; of several, none was on the desk alone.

    Returns:
        FRF and modes, their choices in the provenance; None where there are none, or
        where the file has changed since.
    """
    if len(files) != 1:
        return None
    blank = _modes_of(files[0], results_path(files[0]))
    if blank is None or not choices_of(blank.steps):
        return None
    return blank.with_recordings(())


def set_aside(target: Path) -> Path | None:
    """Keep results that hold choices from being written over: they get another name.

    Args:
        target: about to be written.

    Returns:
        The new name, or None where there is nothing to keep.
    """
    if not target.is_file() or not any(
        choices_of(modes.steps) for modes in read_run(target).modes
    ):
        return None
    stem = target.name.removesuffix(".results.h5")
    number = 1
    while (kept := target.with_name(f"{stem}.desk-{number}.results.h5")).exists():
        number += 1
    target.rename(kept)
    return kept


def choice_lines(log: Sequence[DeskChoice]) -> tuple[str, ...]:
    """Return a log for people, one line a choice."""
    return tuple(f"{c.when} {visible(c.who)} {visible(c.words())}" for c in log)


def _stored(subject: DeskSubject) -> StoredModes | None:
    return _modes_of(subject.files[0], subject.results)


def _modes_of(source: Path, results: Path) -> StoredModes | None:
    """Return the modes of a results file that was made of a file as it is now."""
    if not results.is_file():
        return None
    run = read_run(results)
    if file_digest(source) not in run.inputs or not run.modes:
        return None
    return run.modes[0]
