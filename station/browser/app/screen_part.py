# SPDX-License-Identifier: MIT
"""What a screen is made of: pages in its navigation, and what answers them."""

from collections.abc import Callable, Sequence
from contextlib import AbstractAsyncContextManager, nullcontext
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from starlette.routing import BaseRoute


@dataclass(frozen=True, slots=True)
class ScreenPage:
    """One page of the navigation.

    Attributes:
        path: of its link, ``"/measure"``.
        title: in the navigation.
        script: module in ``assets/`` that builds it, ``"measure.js"``.
        styles: further style sheets in ``assets/``.
    """

    path: str
    title: str
    script: str
    styles: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class ScreenPart:
    """Pages that belong together, with their routes.

    Attributes:
        pages: in the order of the navigation.
        routes: of data, commands and sockets; the pages have theirs already.
        running: gives what runs as long as the screen is served.
    """

    pages: tuple[ScreenPage, ...]
    routes: "Sequence[BaseRoute]" = ()
    running: Callable[[], AbstractAsyncContextManager[object]] = nullcontext
