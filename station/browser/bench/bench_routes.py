# SPDX-License-Identifier: MIT
"""The pages of a running session, and what answers them."""

import json
from collections.abc import Awaitable, Callable, Mapping
from typing import TYPE_CHECKING, Any

from jointbench.acquisition.basics.errors import FormatError, UsageError
from jointbench.station.browser.app.screen_part import ScreenPage, ScreenPart
from jointbench.station.browser.bench.live_socket import LiveSocket
from jointbench.station.browser.bench.session_feed import SessionFeed
from jointbench.station.browser.guard.open_screens import OpenScreens
from jointbench.station.browser.guard.request_body import short_body
from jointbench.station.session_events.command_codec import (
    command_from_json,
    command_to_json,
)

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response

MEASURE = ScreenPage("/measure", "Measure", "measure.js", ("bench.css",))
SETUP = ScreenPage("/setup", "Setup", "setup.js", ("bench.css",))

Submit = Callable[[Mapping[str, object]], Awaitable[Mapping[str, Any]]]
"""Submits a command as JSON types; returns its answer."""


def bench_part(
    feed: SessionFeed,
    submit: Submit,
    screens: OpenScreens,
    geometry: Mapping[str, Any] | None,
) -> ScreenPart:
    """Return the screens of a session that is measured.

    Args:
        feed: of the session.
        submit: of commands to the measuring program.
        screens: counts those that are open.
        geometry: ``points`` by name and ``lines`` as JSON types; None without.
    """
    from starlette.responses import JSONResponse, PlainTextResponse, Response
    from starlette.routing import Route, WebSocketRoute

    async def command(request: "Request") -> "Response":
        try:
            asked = _command(await short_body(request))
        except UsageError as error:
            return PlainTextResponse(str(error), 413)
        except (ValueError, RecursionError, FormatError) as error:
            return PlainTextResponse(str(error), 400)
        return JSONResponse(await submit(asked))

    async def hit(request: "Request") -> "Response":
        picture = feed.picture(request.path_params["number"])
        if picture is None:
            return PlainTextResponse("its samples are not available", 404)
        return Response(picture, media_type="application/json")

    async def places(request: "Request") -> "Response":
        return JSONResponse(geometry)

    return ScreenPart(
        pages=(SETUP, MEASURE),
        routes=(
            Route("/bench/command", command, methods=["POST"]),
            Route("/bench/hit/{number:int}", hit),
            Route("/bench/geometry", places),
            WebSocketRoute("/bench/live", LiveSocket(feed, screens).serve),
        ),
        running=feed.running,
    )


def _command(body: bytes) -> Mapping[str, object]:
    """Return a command that was checked.

    Raises:
        FormatError: it is none.
        ValueError: it is no JSON.
    """
    content = json.loads(body)
    if not isinstance(content, dict):
        raise FormatError("a command is a JSON object")
    return command_to_json(command_from_json(content))
