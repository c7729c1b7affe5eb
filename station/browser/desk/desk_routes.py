# SPDX-License-Identifier: MIT
"""The screens of the modal desk, and what answers them."""

import json
from collections.abc import Awaitable, Callable
from typing import TYPE_CHECKING, Any

from jointbench.acquisition.basics.errors import JointbenchError, UsageError
from jointbench.station.browser.app.screen_part import ScreenPart
from jointbench.station.browser.desk.desk_board import DeskBoard
from jointbench.station.browser.desk.desk_screens import DESK_PAGES
from jointbench.station.browser.guard.open_screens import OpenScreens
from jointbench.station.browser.guard.request_body import short_body
from jointbench.station.desk.desk_findings import findings_beside
from jointbench.station.desk.desk_pages import (
    curves_page,
    diagram_page,
    evidence_page,
    summary_page,
)
from jointbench.station.desk.desk_state import DeskState
from jointbench.station.desk.frf_pages import frf_page, hits_page, matrix_page
from jointbench.station.desk.shape_page import shapes_page

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response
    from starlette.routing import BaseRoute

_OF_A_REPORT = (
    "sandbox allow-scripts; default-src 'none'; script-src 'unsafe-inline'; "
    "style-src 'unsafe-inline'; img-src data:; frame-ancestors 'none'"
)
"""A report is one file with its scripts; the sandbox gives it no cookie, no origin."""
_PAGES: dict[str, Callable[[DeskState], Any]] = {
    "summary": summary_page,
    "diagram": diagram_page,
    "matrix": matrix_page,
    "hits": hits_page,
    "curves": curves_page,
    "shapes": shapes_page,
}
Endpoint = Callable[["Request"], Awaitable["Response"]]


def desk_part(board: DeskBoard) -> ScreenPart:
    """Return the screens of the modal desk.

    Args:
        board: subjects and their states.
    """
    from starlette.routing import Route, WebSocketRoute

    def subjects(request: "Request") -> Any:
        titles = [one.title for one in board.subjects]
        return {"titles": titles, "who": board.who, "waiting": board.waiting}

    routes: list[BaseRoute] = [
        Route("/desk/subjects", _get(subjects)),
        WebSocketRoute("/desk/open", OpenScreens().hold),
        Route("/desk/{number:int}/report.html", _report(board)),
    ]
    for path, make in _answers(board).items():
        routes.append(Route(path, _get(make)))
    for path, take in _orders(board).items():
        routes.append(Route(path, _post(take), methods=["POST"]))
    return ScreenPart(DESK_PAGES, routes)


def _answers(board: DeskBoard) -> dict[str, Callable[["Request"], Any]]:
    """Return what is asked for, by path; each runs in a thread."""

    def page(request: "Request") -> Any:
        make = _PAGES.get(request.path_params["page"])
        return None if make is None else make(_state(board, request))

    def frf(request: "Request") -> Any:
        parts = request.path_params
        return frf_page(_state(board, request), parts["output"], parts["input"])

    def pole(request: "Request") -> Any:
        return evidence_page(_state(board, request), request.path_params["row"])

    def findings(request: "Request") -> Any:
        found = findings_beside(_state(board, request).subject)
        return [
            {
                "kind": one.kind,
                "source": one.source,
                "own": one.own,
                "content": one.content,
            }
            for one in found
        ]

    return {
        "/desk/{number:int}/frf/{output:int}/{input:int}": frf,
        "/desk/{number:int}/pole/{row:int}": pole,
        "/desk/{number:int}/findings": findings,
        "/desk/{number:int}/{page}": page,
    }


def _orders(board: DeskBoard) -> dict[str, Callable[[int, dict[str, Any]], Any]]:
    """Return what is done, by path; each runs in a thread."""

    def choose(number: int, asked: dict[str, Any]) -> Any:
        return summary_page(board.choose(number, asked))

    def resolve(number: int, asked: dict[str, Any]) -> Any:
        return curves_page(board.resolve(number))

    def report(number: int, asked: dict[str, Any]) -> Any:
        target = board.report(number)
        return {"name": target.name, "folder": str(target.parent.resolve())}

    return {
        "/desk/{number:int}/choose": choose,
        "/desk/{number:int}/resolve": resolve,
        "/desk/{number:int}/write-report": report,
    }


def _report(board: DeskBoard) -> Endpoint:
    """Return what serves a written report: alone, without rights of the screen."""
    from starlette.concurrency import run_in_threadpool
    from starlette.responses import HTMLResponse, PlainTextResponse

    async def answer(request: "Request") -> "Response":
        number = request.path_params["number"]
        try:
            text = await run_in_threadpool(board.report_text, number)
        except (JointbenchError, OSError) as error:
            return PlainTextResponse(str(error), 400)
        if text is None:
            return PlainTextResponse("the report is not written yet", 404)
        return HTMLResponse(text, headers={"content-security-policy": _OF_A_REPORT})

    return answer


def _state(board: DeskBoard, request: "Request") -> DeskState:
    return board.state(request.path_params["number"])


def _get(make: Callable[["Request"], Any]) -> Endpoint:
    from starlette.concurrency import run_in_threadpool
    from starlette.responses import JSONResponse, PlainTextResponse

    async def answer(request: "Request") -> "Response":
        try:
            content = await run_in_threadpool(make, request)
        except JointbenchError as error:
            return PlainTextResponse(str(error), 400)
        if content is None:
            return PlainTextResponse("there is no such screen", 404)
        return JSONResponse(content)

    return answer


def _post(take: Callable[[int, dict[str, Any]], Any]) -> Endpoint:
    from starlette.concurrency import run_in_threadpool
    from starlette.responses import JSONResponse, PlainTextResponse

    async def answer(request: "Request") -> "Response":
        try:
            body = await short_body(request)
        except UsageError as error:
            return PlainTextResponse(str(error), 413)
        try:
            asked = json.loads(body or b"{}")
            if not isinstance(asked, dict):
                return PlainTextResponse("a choice is a JSON object", 400)
            number = request.path_params["number"]
            content = await run_in_threadpool(take, number, asked)
        except (JointbenchError, ValueError, RecursionError) as error:
            return PlainTextResponse(str(error), 400)
        return JSONResponse(content)

    return answer
