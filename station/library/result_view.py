# SPDX-License-Identifier: MIT
"""How a result shows itself: as text, and as HTML in a notebook."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape


@dataclass(frozen=True, slots=True)
class ResultView:
    """Title, table and remarks of a result, and its plots as SVG."""

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    remarks: tuple[str, ...] = ()
    plots: tuple[str, ...] = ()

    def text(self) -> str:
        """Return title, aligned table and remarks as lines of text."""
        lines = [self.columns, *self.rows]
        wide = [max(len(line[i]) for line in lines) for i in range(len(self.columns))]
        body = [
            "  ".join(
                cell.ljust(width) if i == 0 else cell.rjust(width)
                for i, (cell, width) in enumerate(zip(line, wide, strict=True))
            ).rstrip()
            for line in lines
        ]
        return "\n".join([self.title, *body, *self.remarks])

    def html(self) -> str:
        """Return the result as HTML; names that come from files are escaped."""
        head = "".join(f"<th>{escape(word)}</th>" for word in self.columns)
        body = "".join(f"<tr>{_cells(row)}</tr>" for row in self.rows)
        notes = "".join(f"<li>{escape(words)}</li>" for words in self.remarks)
        return (
            f"<div><b>{escape(self.title)}</b>"
            f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
            + (f"<ul>{notes}</ul>" if notes else "")
            + "".join(self.plots)
            + "</div>"
        )


class Shown(ABC):
    """A result that prints its `view` and displays it in a notebook."""

    __slots__ = ()

    @property
    @abstractmethod
    def view(self) -> ResultView:
        """Title, table, remarks and plots of the result."""

    def __str__(self) -> str:
        """Return the result as text."""
        return self.view.text()

    def _repr_html_(self) -> str:
        return self.view.html()


def _cells(row: Sequence[str]) -> str:
    return "".join(f"<td>{escape(cell)}</td>" for cell in row)
