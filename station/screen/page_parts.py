# SPDX-License-Identifier: MIT
"""A report as data: findings, sections, and the texts, tables and plots in them."""

from dataclasses import dataclass, field
from typing import Literal

from jointbench.station.screen.figures import Figure


@dataclass(frozen=True, slots=True)
class Tile:
    """One headline number; its interval stands in the note."""

    label: str
    value: str
    note: str = ""


@dataclass(frozen=True, slots=True)
class Text:
    """One paragraph; a notice is highlighted."""

    text: str
    kind: Literal["text", "notice"] = "text"


@dataclass(frozen=True, slots=True)
class DataTable:
    """A table; cells that equal one of `bad_words` are marked as failures."""

    caption: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    bad_words: frozenset[str] = frozenset()
    kind: Literal["table"] = "table"


@dataclass(frozen=True, slots=True)
class Plot:
    """A figure with an identifier that is unique in the report."""

    identifier: str
    caption: str
    figure: Figure
    height: int = 380
    kind: Literal["figure"] = "figure"


@dataclass(frozen=True, slots=True)
class ItemGroup:
    """Items that belong together: folded under a title, or small figures in a grid."""

    title: str
    items: tuple["Item", ...]
    kind: Literal["fold", "grid"] = "fold"


Item = Text | DataTable | Plot | ItemGroup


@dataclass(frozen=True, slots=True)
class Section:
    """A titled part of the report."""

    anchor: str
    title: str
    items: tuple[Item, ...]


@dataclass(frozen=True, slots=True)
class Report:
    """The whole content of a report.

    Attributes:
        title: of the report.
        lead: what it is about and where it comes from.
        software: that made it.
        simulated: whether instruments were simulated.
        tiles: numbers with their intervals, the most important first; the report shows
            six and folds the rest.
        sections: evidence, in order.
        findings: what was found, in sentences; they stand before everything else.
    """

    title: str
    lead: str
    software: str
    simulated: bool
    tiles: tuple[Tile, ...]
    sections: tuple[Section, ...] = field(default=())
    findings: tuple[str, ...] = field(default=())
