# SPDX-License-Identifier: MIT
"""The guard before the pages: an ASGI application around another one."""

from collections.abc import Mapping
from typing import TYPE_CHECKING
from urllib.parse import urlencode

from jointbench.station.browser.guard.page_headers import page_headers
from jointbench.station.browser.guard.request_checks import (
    Asking,
    RequestRefused,
    refusal,
)
from jointbench.station.browser.guard.screen_access import TOKEN, ScreenAccess

if TYPE_CHECKING:
    from starlette.requests import HTTPConnection
    from starlette.types import ASGIApp, Message, Receive, Scope, Send

_POLICY_VIOLATED = 1008  # of a WebSocket that is closed


class ScreenGuard:
    """Passes good requests on, and adds the headers of every answer."""

    def __init__(self, app: "ASGIApp", access: ScreenAccess) -> None:
        """Stand before an application.

        Args:
            app: to be guarded.
            access: of the screen.
        """
        self._app, self._access = app, access
        self._headers = page_headers(access)

    async def __call__(self, scope: "Scope", receive: "Receive", send: "Send") -> None:
        """Serve one request, socket or start-up."""
        from starlette.requests import HTTPConnection
        from starlette.responses import PlainTextResponse, RedirectResponse

        if scope["type"] not in {"http", "websocket"}:
            await self._app(scope, receive, send)
            return
        connection = HTTPConnection(scope)
        refused = refusal(_asking(connection), self._access)
        if scope["type"] == "websocket":
            await self._socket(refused, scope, receive, send)
            return
        answering = _with_headers(send, self._headers)
        if refused is not None:
            answer = PlainTextResponse(refused.words + "\n", refused.status)
            await answer(scope, receive, answering)
        elif TOKEN in connection.query_params:
            # The secret leaves the address line, and with it the history.
            come = RedirectResponse(_without_token(connection), 303)
            if self._access.use(connection.query_params.get(TOKEN)):
                come.set_cookie(
                    self._access.cookie,
                    self._access.admission,
                    httponly=True,
                    samesite="strict",
                )
            await come(scope, receive, answering)
        else:
            await self._app(scope, receive, answering)

    async def _socket(
        self,
        refused: RequestRefused | None,
        scope: "Scope",
        receive: "Receive",
        send: "Send",
    ) -> None:
        if refused is None:
            await self._app(scope, receive, send)
            return
        await receive()
        await send({"type": "websocket.close", "code": _POLICY_VIOLATED})


def _asking(connection: "HTTPConnection") -> Asking:
    return Asking(
        method=connection.scope.get("method", ""),
        headers=connection.headers,
        cookies=connection.cookies,
        token=connection.query_params.get(TOKEN),
    )


def _without_token(connection: "HTTPConnection") -> str:
    rest = [(k, v) for k, v in connection.query_params.multi_items() if k != TOKEN]
    path = "/" + connection.url.path.lstrip("/")  # never the name of another host
    return f"{path}?{urlencode(rest)}" if rest else path


def _with_headers(send: "Send", headers: Mapping[str, str]) -> "Send":
    """Return a sender that adds headers; what an answer states itself stays."""
    added = [(k.encode("latin-1"), v.encode("latin-1")) for k, v in headers.items()]

    async def sending(message: "Message") -> None:
        if message["type"] == "http.response.start":
            stated = {name.lower() for name, _ in message["headers"]}
            message["headers"] = [
                *message["headers"],
                *((k, v) for k, v in added if k not in stated),
            ]
        await send(message)

    return sending
