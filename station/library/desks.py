# SPDX-License-Identifier: MIT
"""The modal desk from Python: choose poles, refit, take back, save."""

import getpass
from dataclasses import dataclass, replace
from pathlib import Path

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.formats.frfs.frf_format import FrfOptions
from jointbench.acquisition.formats.samples.sample_format import SampleOptions
from jointbench.signal.modal.chosen_poles.pole_evidence import PoleEvidence
from jointbench.station.desk.desk_choice import ChoiceAction, plain_who
from jointbench.station.desk.desk_results import (
    choice_lines,
    opened_desk,
    save_choices,
)
from jointbench.station.desk.desk_state import (
    DeskState,
    decided,
    evidence,
    made_choice,
)
from jointbench.station.desk.desk_subject import DeskRequest, desk_subjects
from jointbench.station.desk.frf_pages import hits_page
from jointbench.station.library.argument_checks import (
    checked_band,
    require_texts,
)
from jointbench.station.library.measurements import Files, paths_of
from jointbench.station.library.mode_results import IdentifiedModes
from jointbench.station.library.result_view import ResultView, Shown
from jointbench.station.pipeline.modal_options import modal_settings


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ModalDesk(Shown):
    """A session on the modal desk; every choice returns another desk.

    Attributes:
        state: the diagram, what is chosen, and the log of choices.
        who: makes the choices.
    """

    state: DeskState
    who: str

    def choose(self, frequency: float, order: int = 0) -> "ModalDesk":
        """Choose the pole nearest a frequency [Hz]; of any order, or of one."""
        return self._after(ChoiceAction.CHOOSE, frequency=frequency, order=order)

    def clear(self, low: float, high: float) -> "ModalDesk":
        """Clear the chosen poles between two frequencies [Hz]."""
        return self._after(ChoiceAction.CLEAR, frequency=low, second=high)

    def merge(self, one: float, other: float) -> "ModalDesk":
        """Make two chosen poles, given by their frequencies [Hz], one."""
        return self._after(ChoiceAction.MERGE, frequency=one, second=other)

    def pin(self, frequency: float, order: int) -> "ModalDesk":
        """Choose a pole, and keep its frequency and damping as they are at an order."""
        return self._after(ChoiceAction.PIN, frequency=frequency, order=order)

    def drop_hit(self, number: int) -> "ModalDesk":
        """Leave a hit out of the average, counted from 1, and compute again."""
        known = hits_page(self.state)
        if not 1 <= number <= len(known):
            raise UsageError(f"there are {len(known)} hits on the desk, no {number}")
        hit = known[number - 1]
        name, time = hit["recording"], hit["time_s"]
        return self._after(ChoiceAction.DROP_HIT, name=name, time=time)

    def undo(self) -> "ModalDesk":
        """Take the last choice back."""
        return self._after(ChoiceAction.UNDO)

    def evidence(self, row: int) -> PoleEvidence:
        """Return uncertainty and collinearity of one pole of the diagram."""
        return evidence(self.state, row)

    def save(self) -> Path:
        """Write the choices to the results beside the session; return that file.

        Raises:
            UsageError: nothing was chosen.
        """
        written = save_choices(self.state)
        if written is None:
            raise UsageError("nothing was chosen; there is nothing to write")
        return written

    @property
    def modes(self) -> IdentifiedModes:
        """The modes as chosen."""
        return IdentifiedModes(self.state.chain)

    @property
    def view(self) -> ResultView:
        """One row a mode, and the choices that led to them."""
        shown = self.modes.view
        said = (*self.state.remarks, *choice_lines(self.state.log))
        return replace(shown, remarks=(*said, *shown.remarks))

    def _after(self, action: ChoiceAction, **what: float | int | str) -> "ModalDesk":
        choice = made_choice(action, self.who, **what)
        return ModalDesk(decided(self.state, choice), self.who)


def desk(
    files: Files,
    *,
    band: tuple[float, float] | None = None,
    order: int | None = None,
    estimator: str = "H1",
    columns: str | None = None,
    preload: float | None = None,
    who: str | None = None,
) -> ModalDesk:
    """Put a session or files of FRFs on the modal desk.

    Earlier choices that the results beside it hold are made again.

    Args:
        files: one session, or files of FRFs or hits.
        band: lowest and highest frequency [Hz]; None lets the data choose.
        order: highest model order; None lets the data choose.
        estimator: of the FRF: ``"H1"``, ``"H2"`` or ``"Hv"``.
        columns: of plain tables, with units.
        preload: which one, of a session at several [N].
        who: makes the choices; None for the user of this computer.

    Returns:
        The desk with the automatic modes, or with those chosen before.

    Raises:
        NoModeFound: there is none to begin with.
        BadData: no accepted hit, or a file cannot be read.
        UsageError: several sessions, or one at several preloads.
    """
    require_texts("'H1'", estimator=estimator, columns=columns, who=who)
    band = checked_band(band)
    asked = None if band is None else f"{band[0]}:{band[1]}"
    request = DeskRequest(
        modal_settings(asked, order, estimator or "H1", (), ()),
        FrfOptions(columns),
        SampleOptions(columns, "1"),
    )
    found = [
        one
        for one in desk_subjects(paths_of(files), request)
        if preload is None or one.preload == preload
    ]
    if len(found) != 1:
        known = ", ".join(f"{one.title!r}" for one in found) or "nothing"
        raise UsageError(
            f"the desk holds one thing at a time, and {known} was given; name one "
            "session, and preload= for one at several"
        )
    name = plain_who(who or getpass.getuser())
    return ModalDesk(opened_desk(found[0]), name)
