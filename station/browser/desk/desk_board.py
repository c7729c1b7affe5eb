# SPDX-License-Identifier: MIT
"""What the screens of the desk share: subjects, their states, one choice at a time."""

import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from threading import Lock
from typing import Any, TypeVar

from jointbench.acquisition.basics.errors import UsageError
from jointbench.station.desk.desk_choice import ChoiceAction
from jointbench.station.desk.desk_results import (
    DeskConflict,
    opened_desk,
    save_choices,
)
from jointbench.station.desk.desk_state import (
    DeskState,
    decided,
    made_choice,
    with_curves,
)
from jointbench.station.desk.desk_subject import DeskSubject
from jointbench.station.files.input_files import is_session_name
from jointbench.station.pipeline.stage_store import StageRun
from jointbench.station.report.frf_analysis import report_path
from jointbench.station.report.session_report import session_page
from jointbench.station.screen.page import write_report

_NUMBERS = ("frequency", "damping_ratio", "second", "time")
_LONGEST = 200
Shown = TypeVar("Shown")


class DeskBoard:
    """States of the subjects; each is read when it is first asked for.

    Attributes:
        subjects: to choose the modes of.
        who: makes the choices.
        waiting: why there is no subject, for people.
    """

    def __init__(
        self,
        subjects: Sequence[DeskSubject],
        who: str,
        geometry: Path | None = None,
        *,
        waiting: str = "",
    ) -> None:
        """Lay subjects out.

        Args:
            subjects: to choose the modes of.
            who: makes the choices.
            geometry: for the report.
            waiting: why there is no subject, for people.
        """
        self.subjects = tuple(subjects)
        self.who, self.waiting = who, waiting
        self._geometry = geometry
        self._states: dict[int, DeskState] = {}
        self._locks = [Lock() for _ in self.subjects]

    def state(self, number: int, run: StageRun | None = None) -> DeskState:
        """Return the state of a subject.

        Raises:
            UsageError: there is no such subject.
            BadData: it cannot be read, or no mode rises above the noise.
        """
        self._require(number)
        with self._locks[number]:
            return self._opened(number, run)

    def choose(self, number: int, asked: Mapping[str, Any]) -> DeskState:
        """Make a choice, write it, and return the state after it.

        A choice that cannot be written is not made.

        Args:
            number: of the subject.
            asked: ``action`` and what belongs to it, as the browser sent it.

        Raises:
            UsageError: it is no choice, or cannot be made.
        """
        action, what = _choice(asked)
        choice = made_choice(action, self.who, **what)
        return self._changed(number, lambda state: decided(state, choice))

    def resolve(self, number: int) -> DeskState:
        """Resolve the chosen modes over their amplitude, and write the curves."""
        return self._changed(number, with_curves)

    def report(self, number: int) -> Path:
        """Write the report of a subject's file, and return where it is.

        Raises:
            UsageError: FRFs of several files have no common report.
        """
        state = self.state(number)
        files = state.subject.files
        if len(files) > 1 or not files[0].exists():
            raise UsageError(
                "the report is of one session or one file of FRFs; open it alone"
            )
        source, target = files[0], report_path(files[0])
        if not is_session_name(source) and not state.subject.results.is_file():
            raise UsageError(
                "choose a pole first: the report of FRFs shows the results beside them"
            )
        page, _ = session_page(source, geometry=self._geometry)
        write_report(page, target)
        return target

    def report_text(self, number: int) -> bytes | None:
        """Return the report of a subject as it was written; None without one."""
        target = report_path(self.state(number).subject.files[0])
        return target.read_bytes() if target.is_file() else None

    def _changed(
        self, number: int, change: Callable[[DeskState], DeskState]
    ) -> DeskState:
        self._require(number)
        with self._locks[number]:
            state = change(self._opened(number, None))
            try:
                save_choices(state)
            except DeskConflict:
                del self._states[number]  # the page shows what is written now
                raise
            self._states[number] = state
            return state

    def _opened(self, number: int, run: StageRun | None) -> DeskState:
        if number not in self._states:
            self._states[number] = opened_desk(self.subjects[number], run)
        return self._states[number]

    def _require(self, number: int) -> None:
        if not 0 <= number < len(self.subjects):
            raise UsageError(
                f"there are {len(self.subjects)} subjects on the desk, no {number}"
            )


def _choice(asked: Mapping[str, Any]) -> tuple[ChoiceAction, dict[str, Any]]:
    """Return action and values of a choice that came from a browser.

    Raises:
        UsageError: it is none.
    """
    try:
        action = ChoiceAction(str(asked.get("action")))
    except ValueError:
        known = ", ".join(ChoiceAction)
        raise UsageError(f"a choice is one of {known}") from None
    what: dict[str, Any] = {}
    for name in _NUMBERS:
        value = asked.get(name)
        if value is None:
            continue
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise UsageError(f"{name} must be a number")
        if not abs(value) <= sys.float_info.max:
            raise UsageError(f"{name} must be finite")
        what[name] = float(value)
    order = asked.get("order", 0)
    if isinstance(order, bool) or not isinstance(order, int):
        raise UsageError("order must be a whole number")
    what["order"] = order
    text = asked.get("name", "")
    if not isinstance(text, str) or len(text) > _LONGEST:
        raise UsageError(f"name must be a text of at most {_LONGEST} characters")
    what["name"] = text
    return action, what
