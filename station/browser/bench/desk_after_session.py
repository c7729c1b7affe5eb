# SPDX-License-Identifier: MIT
"""The desk on the server of a session that is measured; it opens when it has ended.

What fits poles is loaded then: the screen of a session has to be there at once.
"""

import getpass
from pathlib import Path
from typing import TYPE_CHECKING, cast

from jointbench.acquisition.basics.errors import JointbenchError
from jointbench.station.browser.app.screen_part import ScreenPart
from jointbench.station.browser.desk.desk_screens import DESK_PAGES
from jointbench.station.browser.guard.open_screens import OpenScreens

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response
    from starlette.types import ASGIApp, Receive, Scope, Send

    from jointbench.station.browser.desk.desk_board import DeskBoard

_MEASURED = "The session is being measured. Its poles can be chosen once it has ended."


class DeskAfterSession:
    """Opens a session on the desk once its file is whole."""

    def __init__(self, geometry: Path | None, screens: OpenScreens) -> None:
        """Begin while the session is measured.

        Args:
            geometry: file of the points, None without.
            screens: counts those that are open.
        """
        self._geometry, self._screens = geometry, screens
        self._session: Path | None = None
        self._app: ASGIApp | None = None

    def finished(self, session: Path) -> None:
        """Take note that the file of the session is whole."""
        self._session = session

    def part(self) -> ScreenPart:
        """Return the screens of the desk."""
        from starlette.routing import Route, WebSocketRoute

        return ScreenPart(
            DESK_PAGES,
            (
                WebSocketRoute("/desk/open", self._screens.hold),
                Route("/desk/subjects", self._subjects),
                Route("/desk/{rest:path}", self._answer, methods=["GET", "POST"]),
            ),
        )

    async def _subjects(self, request: "Request") -> "Response":
        from starlette.responses import JSONResponse

        if self._session is None:
            return JSONResponse({"titles": [], "who": "", "waiting": _MEASURED})
        return await self._answer(request)

    async def _answer(self, request: "Request") -> "Response":
        from starlette.concurrency import run_in_threadpool
        from starlette.responses import PlainTextResponse

        if self._session is None:
            return PlainTextResponse(_MEASURED, 400)
        if self._app is None:
            self._app = await run_in_threadpool(self._desk, self._session)
        return cast("Response", _Passed(self._app))

    def _desk(self, session: Path) -> "ASGIApp":
        from starlette.applications import Starlette

        from jointbench.station.browser.desk.desk_routes import desk_part

        return Starlette(routes=list(desk_part(self._board(session)).routes))

    def _board(self, session: Path) -> "DeskBoard":
        from jointbench.station.browser.desk.desk_board import DeskBoard
        from jointbench.station.desk.desk_choice import plain_who
        from jointbench.station.desk.desk_subject import DeskRequest, desk_subjects

        who = plain_who(getpass.getuser())
        try:
            subjects = desk_subjects([session], DeskRequest(geometry=self._geometry))
        except (JointbenchError, OSError) as error:
            return DeskBoard(
                (), who, waiting=f"There is nothing to choose poles from: {error}"
            )
        return DeskBoard(subjects, who, self._geometry)


class _Passed:
    """An answer that another application gives."""

    def __init__(self, app: "ASGIApp") -> None:
        self._app = app

    async def __call__(self, scope: "Scope", receive: "Receive", send: "Send") -> None:
        await self._app(scope, receive, send)
