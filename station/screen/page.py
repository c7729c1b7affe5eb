# SPDX-License-Identifier: MIT
"""Rendering of a report to one HTML file that needs no network."""

import re
import secrets
from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

from jointbench.acquisition.file_access.quoting import visible
from jointbench.station.drawing.css_colours import colour_attributes
from jointbench.station.drawing.figure_markup import figure_markup
from jointbench.station.drawing.figure_parts import axis_title
from jointbench.station.drawing.legend_markup import legend_entries, legend_markup
from jointbench.station.drawing.palette import MEANINGS
from jointbench.station.files.output_paths import write_text
from jointbench.station.screen.page_parts import (
    DataTable,
    Item,
    ItemGroup,
    Plot,
    Report,
    Section,
)

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
_MOST_TILES = 6
"""Headline numbers that are not folded."""
_NARROW = 42
"""Characters of a row that a phone shows side by side."""
_GAP = 2


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
            tuple(_placed(item, mark) for item in one.items),
        )
        for one in sections
    ]


def _placed(item: Item, mark: str) -> Item:
    if isinstance(item, Plot):
        return replace(item, identifier=f"{item.identifier}{mark}")
    if isinstance(item, ItemGroup):
        return replace(item, items=tuple(_placed(one, mark) for one in item.items))
    return item


def render(report: Report) -> str:
    """Return `report` as one self-contained HTML document."""
    from jinja2 import Environment

    environment = Environment(
        autoescape=True, trim_blocks=True, lstrip_blocks=True, finalize=_seen
    )
    template = environment.from_string(_asset("report.html.j2"))
    return template.render(
        report=report,
        prose=_PROSE_COLUMNS,
        most_tiles=_MOST_TILES,
        style=_palette() + _asset("report.css"),
        script=_asset("report.js"),
        colours=_colours() if _plots(report) else (),
        drawn=_drawn,
        is_wide=_is_wide,
        shared_legend=_shared_legend,
        nonce=secrets.token_urlsafe(16),
    )


def write_report(report: Report, path: Path) -> None:
    """Write the rendered report to `path`."""
    write_text(path, render(report))


def _asset(name: str) -> str:
    room = files("jointbench.station.screen")
    return room.joinpath(name).read_text(encoding="utf-8")


def _palette() -> str:
    room = files("jointbench.station.drawing")
    return room.joinpath("palette.css").read_text(encoding="utf-8")


def _colours() -> list[dict[str, object]]:
    """Return the legend of colours: classes that share a meaning, and the meaning."""
    found: dict[str, list[str]] = {}
    for role, meaning in MEANINGS.items():
        found.setdefault(meaning, []).append(colour_attributes(role)[0])
    return [{"classes": c, "meaning": m} for m, c in found.items()]


def _plots(report: Report) -> list[Plot]:
    return [plot for section in report.sections for plot in figures_in(section.items)]


def figures_in(items: Sequence[Item]) -> list[Plot]:
    """Return the figures among items, those in groups too, in order."""
    found: list[Plot] = []
    for item in items:
        if isinstance(item, Plot):
            found.append(item)
        elif isinstance(item, ItemGroup):
            found += figures_in(item.items)
    return found


def _drawn(plot: Plot) -> dict[str, object]:
    """Return a figure as markup, with what it shows in words and its own title."""
    from markupsafe import Markup

    layout = plot.figure.get("layout")
    title = axis_title(layout) if isinstance(layout, Mapping) else ""
    markup, words = figure_markup(plot.figure, height=plot.height, caption=plot.caption)
    return {"markup": Markup(markup), "words": words, "title": title}


def _shared_legend(group: ItemGroup) -> object:
    """Return one legend for all figures of a grid."""
    from markupsafe import Markup

    found: dict[str, str] = {}
    for plot in figures_in(group.items):
        found |= legend_entries(plot.figure)
    return Markup(legend_markup(found))


def _is_wide(table: DataTable) -> bool:
    """Return whether a phone shows the rows of a table as blocks of lines."""
    if not table.rows:
        return False
    longest = [
        max(len(row[k]) for row in table.rows if k < len(row))
        for k in range(min(len(row) for row in table.rows))
    ]
    heads = [max((len(w) for w in name.split()), default=0) for name in table.columns]
    letters = sum(map(max, zip(longest, heads, strict=False)))
    return letters + _GAP * len(table.columns) > _NARROW


def _seen(value: object) -> object:
    """Return a value for the template; control characters in texts are escaped."""
    if isinstance(value, str) and not hasattr(value, "__html__"):
        return visible(value)
    return value
