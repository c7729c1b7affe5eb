# SPDX-License-Identifier: MIT
"""The application of a screen: pages, files and the routes of its parts."""

from collections.abc import AsyncIterator, Sequence
from contextlib import AsyncExitStack, asynccontextmanager
from typing import TYPE_CHECKING

from jointbench.station.browser.app.page_shell import page_shell
from jointbench.station.browser.app.screen_assets import Asset, screen_assets
from jointbench.station.browser.app.screen_part import ScreenPage, ScreenPart
from jointbench.station.browser.guard.screen_access import ScreenAccess
from jointbench.station.browser.guard.screen_guard import ScreenGuard

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response
    from starlette.routing import BaseRoute, Route
    from starlette.types import ASGIApp


def screen_app(parts: Sequence[ScreenPart], access: ScreenAccess) -> "ASGIApp":
    """Return the guarded application of a screen; ``/`` is its first page.

    Args:
        parts: of the screen, in the order of the navigation.
        access: of the screen.
    """
    from starlette.applications import Starlette
    from starlette.responses import RedirectResponse
    from starlette.routing import Route

    pages = [page for part in parts for page in part.pages]

    async def first(request: "Request") -> "Response":
        return RedirectResponse(pages[0].path, 303)

    @asynccontextmanager
    async def running(app: "Starlette") -> AsyncIterator[None]:
        async with AsyncExitStack() as stack:
            for part in parts:
                await stack.enter_async_context(part.running())
            yield

    # In the order of how often they are asked for: a request is compared with each.
    routes: list[BaseRoute] = [
        *(route for part in parts for route in part.routes),
        Route("/", first),
        *(_page(page, pages, access) for page in pages),
        *(_asset(asset) for asset in screen_assets()),
    ]
    return ScreenGuard(Starlette(routes=routes, lifespan=running), access)


def _page(
    page: ScreenPage, pages: Sequence[ScreenPage], access: ScreenAccess
) -> "Route":
    from starlette.responses import HTMLResponse
    from starlette.routing import Route

    html = page_shell(page, pages)

    async def show(request: "Request") -> "Response":
        access.page_sent()
        return HTMLResponse(html)

    return Route(page.path, show)


def _asset(asset: Asset) -> "Route":
    from starlette.responses import Response
    from starlette.routing import Route

    async def give(request: "Request") -> "Response":
        return Response(asset.content, media_type=asset.type)

    return Route(f"/assets/{asset.name}", give)
