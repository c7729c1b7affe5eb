# SPDX-License-Identifier: MIT
"""The HTML of a page: its head and the navigation; a module of the page fills it.

Nothing that comes from a file stands in it: such text reaches the page as JSON and is
written by ``textContent`` alone.
"""

from collections.abc import Sequence
from html import escape

from jointbench.station.browser.app.screen_assets import COLOUR_STYLES
from jointbench.station.browser.app.screen_part import ScreenPage

_STYLES = (*COLOUR_STYLES, "screen.css", "vendor/uPlot.min.css")


def page_shell(page: ScreenPage, pages: Sequence[ScreenPage]) -> str:
    """Return the HTML of one page.

    Args:
        page: to be shown.
        pages: all pages of the navigation.
    """
    styles = "".join(
        f'<link rel="stylesheet" href="/assets/{escape(style)}">\n'
        for style in (*_STYLES, *page.styles)
    )
    links = "".join(_link(one, current=one == page) for one in pages)
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>{escape(page.title)} - jointbench</title>
<link rel="icon" href="/assets/icon.svg" type="image/svg+xml">
{styles}<script type="module" src="/assets/{escape(page.script)}"></script>
</head>
<body>
<a class="skip" href="#content">Skip to the content</a>
<header class="top">
<nav aria-label="Screens"><ul>{links}</ul></nav>
<div id="status" class="status"></div>
</header>
<main id="content" tabindex="-1"><p class="waiting">Loading…</p></main>
<div id="spoken" class="unseen" aria-live="assertive" role="status"></div>
</body>
</html>
"""


def _link(page: ScreenPage, *, current: bool) -> str:
    mark = ' aria-current="page"' if current else ""
    return f'<li><a href="{escape(page.path)}"{mark}>{escape(page.title)}</a></li>'
