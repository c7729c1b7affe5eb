# SPDX-License-Identifier: MIT
"""The desk of a session that is measured: its subjects come when it has ended."""

import getpass
from pathlib import Path

from jointbench.acquisition.basics.errors import JointbenchError
from jointbench.station.browser.desk.desk_board import DeskBoard
from jointbench.station.desk.desk_choice import plain_who
from jointbench.station.desk.desk_subject import DeskRequest, desk_subjects

_MEASURED = "The session is being measured. Its poles can be chosen once it has ended."


class SessionDesk:
    """Lays a session on the desk once its file is whole.

    Attributes:
        board: of the desk, without subjects before.
    """

    def __init__(self, geometry: Path | None) -> None:
        """Begin while the session is measured.

        Args:
            geometry: file of the points, None without.
        """
        self._geometry = geometry
        self.board = DeskBoard((), plain_who(getpass.getuser()), geometry)
        self.board.waiting = _MEASURED

    def finished(self, session: Path) -> None:
        """Lay the session out; where nothing can be chosen, the pages state why."""
        try:
            request = DeskRequest(geometry=self._geometry)
            self.board.lay_out(desk_subjects([session], request))
            self.board.waiting = ""
        except (JointbenchError, OSError) as error:
            self.board.waiting = f"There is nothing to choose poles from: {error}"
