# SPDX-License-Identifier: MIT
"""Rendering of a report to one HTML file that needs no network."""

import json
import re
import secrets
from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

from jointbench.acquisition.file_access.quoting import visible
from jointbench.station.files.output_paths import write_text
from jointbench.station.screen.page_parts import Plot, Report, Section

_PROSE_COLUMNS = frozenset(
    {
        "reason",
        "detail",
        "step",
        "verdict",
        "what it does",
        "how it was set",
        "verdicts of 20 campaigns that change",
    }
)
"""Columns of text, which are left-aligned."""
# plotly.js interprets tags in texts, links included; our own have no attributes.
_FOREIGN_TAG = re.compile(r"<(?!/?(?:br|b|i|sub|sup|extra)/?>)")


def placed_sections(sections: Sequence[Section], at: str) -> list[Section]:
    """Return sections with unique titles and anchors.

    Args:
        sections: of one preload, for example.
        at: words that distinguish them, with a leading blank; empty to change
            nothing.
    """
    if not at:
        return list(sections)
    mark = re.sub(r"\W+", "-", at)
    return [
        Section(
            f"{one.anchor}{mark}",
            f"{one.title}{at}",
            tuple(
                replace(item, identifier=f"{item.identifier}{mark}")
                if isinstance(item, Plot)
                else item
                for item in one.items
            ),
        )
        for one in sections
    ]


def render(report: Report) -> str:
    """Return `report` as one self-contained HTML document."""
    from jinja2 import Environment
    from plotly.offline import get_plotlyjs

    room = files("jointbench.station.screen")
    environment = Environment(
        autoescape=True, trim_blocks=True, lstrip_blocks=True, finalize=_seen
    )
    template = environment.from_string(
        room.joinpath("report.html.j2").read_text(encoding="utf-8")
    )
    return template.render(
        report=report,
        prose=_PROSE_COLUMNS,
        style=room.joinpath("report.css").read_text(encoding="utf-8"),
        plotly=get_plotlyjs(),
        figures=_script_safe(_figures(report)),
        nonce=secrets.token_urlsafe(16),
    )


def write_report(report: Report, path: Path) -> None:
    """Write the rendered report to `path`."""
    write_text(path, render(report))


def _figures(report: Report) -> str:
    plots = [
        item
        for section in report.sections
        for item in section.items
        if isinstance(item, Plot)
    ]
    return json.dumps({plot.identifier: _seen_below(plot.figure) for plot in plots})


def _seen(value: object) -> object:
    """Return a value for the template; control characters in texts are escaped."""
    if isinstance(value, str) and not hasattr(value, "__html__"):
        return visible(value)
    return value


def _seen_below(value: object) -> object:
    """Return a figure with escaped control characters and without links."""
    if isinstance(value, str):
        return _FOREIGN_TAG.sub("&lt;", visible(value))
    if isinstance(value, Mapping):
        return {visible(str(key)): _seen_below(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_seen_below(one) for one in value]
    return value


def _script_safe(text: str) -> str:
    """Escape characters that could end a script element early."""
    return text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e")
