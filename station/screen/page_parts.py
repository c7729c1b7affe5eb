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
    """One paragraph; a notice is set apart."""

    text: str
    kind: Literal["text", "notice"] = "text"


@dataclass(frozen=True, slots=True)
class DataTable:
    """A table; cells found in `bad_words` are shown as failures."""

    caption: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    bad_words: frozenset[str] = frozenset()
    kind: Literal["table"] = "table"


@dataclass(frozen=True, slots=True)
class Plot:
    """A figure under an identifier that is unique within the page."""

    identifier: str
    caption: str
    figure: Figure
    height: int = 380
    kind: Literal["figure"] = "figure"


Item = Text | DataTable | Plot


@dataclass(frozen=True, slots=True)
class Section:
    """A titled part of the page."""

    anchor: str
    title: str
    items: tuple[Item, ...]


@dataclass(frozen=True, slots=True)
class Report:
    """Everything that a page shows."""

    title: str
    lead: str
    software: str
    simulated: bool
    tiles: tuple[Tile, ...]
    sections: tuple[Section, ...] = field(default=())
