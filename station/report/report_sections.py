# SPDX-License-Identifier: MIT
"""Sections of a session's report as records, so that other packages can add some.

A section is data: texts, tables and plots, never markup. The report escapes every text
and shows every character of it (`visible`); it runs no script but its own.
"""

import json
import logging
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from jointbench.acquisition.basics.registry import Entry
from jointbench.acquisition.file_access.quoting import visible
from jointbench.station.drawing.figure_markup import figure_markup
from jointbench.station.report.session_analysis import SessionAnalysis
from jointbench.station.schemas.bench_model import BenchModel
from jointbench.station.schemas.geometry_file import Geometry
from jointbench.station.screen.page_parts import (
    DataTable,
    Item,
    ItemGroup,
    Plot,
    Section,
    Text,
)

logger = logging.getLogger(__name__)

REPORT_SECTIONS_GROUP = "jointbench.report_sections"
_LONGEST = 200
"""Most characters of a foreign error that a notice quotes."""
_NAME = re.compile(r"[a-z][a-z0-9]*(_[a-z0-9]+)*")


@dataclass(frozen=True, slots=True, eq=False)
class SessionView:
    """What a section is made from; nothing in it can be changed.

    Attributes:
        analysis: the session as recorded, judged hits, modes at each preload, surfaces,
            the contact prediction, identified links, and remarks; arrays are
            read-only and in SI.
        bench: the model of the bench, or None.
        geometry: points and lines to draw shapes on, or None.
    """

    analysis: SessionAnalysis
    bench: BenchModel | None = None
    geometry: Geometry | None = None


@dataclass(frozen=True, slots=True)
class ReportSection:
    """One entry of the report: a name, and a function that makes its sections.

    Attributes:
        name: words in small letters joined by _; the name of the entry point.
        make: from the results to the sections, none where there is nothing to show.
    """

    name: str
    make: Callable[[SessionView], Sequence[Section]]


def section_fault(section: ReportSection) -> str:
    """Return what is wrong with an entry of another package, or an empty text."""
    if not _NAME.fullmatch(section.name):
        return "the name must be words in small letters joined by _"
    return "" if callable(section.make) else "its make must be a function"


def made_sections(
    entry: Entry[ReportSection], view: SessionView
) -> tuple[Section, ...]:
    """Return the sections of one entry; one that fails becomes one line.

    Args:
        entry: built in, or of another package, whose failure must not cost the report.
        view: what the report is about.
    """
    if entry.built_in:
        return tuple(entry.value.make(view))
    try:
        return _checked(entry.value.name, entry.value.make(view))
    except (Exception, SystemExit) as error:  # noqa: BLE001 - it is foreign code
        name = entry.value.name
        words = " ".join(f"{type(error).__name__}: {error}".split())[:_LONGEST]
        failed = (
            f"section {name!r} of package {entry.package} is missing "
            f"({visible(words)}); report it to its author, or uninstall it"
        )
        logger.warning("jointbench: warning: report %s", failed)
        notice = Text(f"Report {failed}.", "notice")
        return (Section(f"added-{name}", name.replace("_", " "), (notice,)),)


def _checked(name: str, sections: Sequence[Section]) -> tuple[Section, ...]:
    """Return sections of another package in the form that the report draws.

    Anchors and identifiers begin with the name of the entry, so that none meets one of
    the station or of another package.

    Raises:
        TypeError: something is no section, item or text, or a figure no plain data.
    """
    found = []
    for number, section in enumerate(sections):
        _require(section, Section)
        mark = f"added-{name}" if number == 0 else f"added-{name}-{number + 1}"
        items = tuple(
            _plain_item(item, f"{mark}-{place}")
            for place, item in enumerate(section.items)
        )
        found.append(Section(mark, _plain(section.title), items))
    return tuple(found)


def _plain_item(item: Item, identifier: str) -> Item:
    if isinstance(item, Text):
        kind = item.kind if item.kind in ("text", "notice") else "text"
        return Text(_plain(item.text), kind)
    if isinstance(item, DataTable):
        return DataTable(
            _plain(item.caption),
            tuple(map(_plain, item.columns)),
            tuple(tuple(map(_plain, row)) for row in item.rows),
            frozenset(map(_plain, item.bad_words)),
        )
    if isinstance(item, ItemGroup):
        parts = tuple(
            _plain_item(one, f"{identifier}-{place}")
            for place, one in enumerate(item.items)
        )
        return ItemGroup(
            _plain(item.title), parts, "grid" if item.kind == "grid" else "fold"
        )
    _require(item, Plot)
    figure = json.loads(json.dumps(item.figure))
    figure_markup(figure, height=int(item.height))  # what cannot be drawn fails here
    return replace(
        item,
        identifier=identifier,
        caption=_plain(item.caption),
        figure=figure,
        height=int(item.height),
        kind="figure",
    )


def _plain(text: str) -> str:
    """Return a text as exactly that; a subclass could pass for safe markup."""
    _require(text, str)
    return str.__str__(text)


def _require(value: object, kind: type) -> None:
    if not isinstance(value, kind):
        raise TypeError(f"a {type(value).__name__} stands where a {kind.__name__} must")
