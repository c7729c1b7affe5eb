# SPDX-License-Identifier: MIT
"""Headers of every answer: what the browser may load, and from where."""

from collections.abc import Mapping

from jointbench.station.browser.guard.screen_access import ScreenAccess


def page_headers(access: ScreenAccess) -> Mapping[str, str]:
    """Return the headers; scripts and styles come from the screen's own files alone.

    Args:
        access: of the screen.
    """
    sockets = " ".join(f"ws://{host}" for host in access.hosts)
    policy = (
        "default-src 'none'",
        "script-src 'self'",
        "style-src 'self'",
        "img-src 'self' blob:",
        f"connect-src 'self' {sockets}",
        "frame-src 'self'",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'self'",
    )
    return {
        "content-security-policy": "; ".join(policy),
        "x-content-type-options": "nosniff",
        "referrer-policy": "no-referrer",
        "cache-control": "no-store",
        "cross-origin-opener-policy": "same-origin",
        "cross-origin-resource-policy": "same-origin",
    }
