# SPDX-License-Identifier: MIT
"""A report as data: tiles, sections, and the texts, tables and plots in them."""

from dataclasses import dataclass, field
from typing import Literal

from jointbench.station.screen.figures import Figure


@dataclass(frozen=True, slots=True)
class Tile:
    """One headline number."""

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


Item = Text | DataTable | Plot


@dataclass(frozen=True, slots=True)
class Section:
    """A titled part of the report."""

    anchor: str
    title: str
    items: tuple[Item, ...]


@dataclass(frozen=True, slots=True)
class Report:
    """The whole content of a report."""

    title: str
    lead: str
    software: str
    simulated: bool
    tiles: tuple[Tile, ...]
    sections: tuple[Section, ...] = field(default=())
