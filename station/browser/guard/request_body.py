# SPDX-License-Identifier: MIT
"""The body of a request, of which no more is read than may come."""

from typing import TYPE_CHECKING

from jointbench.acquisition.basics.errors import UsageError

if TYPE_CHECKING:
    from starlette.requests import Request

MOST_RECEIVED = 4096
"""Of a command or a choice [bytes]."""


async def short_body(request: "Request") -> bytes:
    """Return the body of a request.

    Raises:
        UsageError: it is longer than any that the pages send; the rest stays unread.
    """
    parts: list[bytes] = []
    size = 0
    async for part in request.stream():
        size += len(part)
        if size > MOST_RECEIVED:
            raise UsageError(
                f"the request is longer than {MOST_RECEIVED} bytes; no page sends such"
            )
        parts.append(part)
    return b"".join(parts)
