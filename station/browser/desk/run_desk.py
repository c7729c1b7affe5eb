# SPDX-License-Identifier: MIT
"""``jointbench desk``: the modal desk in the browser."""

import getpass
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from jointbench.station.browser.app.screen_extra import require_screen_extra
from jointbench.station.browser.app.serve_screen import serve_screen
from jointbench.station.browser.desk.desk_board import DeskBoard
from jointbench.station.browser.desk.desk_routes import desk_part
from jointbench.station.desk.desk_choice import plain_who
from jointbench.station.desk.desk_subject import DeskRequest, desk_subjects
from jointbench.station.pipeline.stage_store import StageRun
from jointbench.station.screen.terminal import console, progress_bar


@dataclass(frozen=True, slots=True)
class DeskScreen:
    """How the desk is shown.

    Attributes:
        port: TCP port; 0 for any that is free.
        browser: whether to open the browser.
        who: makes the choices; None for the user of this computer.
    """

    port: int = 0
    browser: bool = True
    who: str | None = None


def run_desk(files: Sequence[Path], request: DeskRequest, screen: DeskScreen) -> None:
    """Serve the modal desk until it is interrupted.

    Args:
        files: sessions, files of FRFs, or files of hits.
        request: options of the modes.
        screen: port, browser, and who chooses.

    Raises:
        BadData: a file cannot be read, or no mode rises above the noise.
        UsageError: the extra is not installed, or the port is taken.
    """
    require_screen_extra()
    subjects = desk_subjects(files, request)
    who = plain_who(screen.who or getpass.getuser())
    board = DeskBoard(subjects, who, request.geometry)
    # What cannot be read is refused here, before a browser opens.
    with progress_bar("fitting poles") as progress:
        board.state(0, StageRun(progress=progress))
    serve_screen(
        (desk_part(board),),
        say=lambda line: console(None).print(line, soft_wrap=True),
        port=screen.port,
        browser=screen.browser,
    )
