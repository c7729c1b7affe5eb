# SPDX-License-Identifier: MIT
"""Tables that fit the width they are printed in: cells wrap, nothing is cut off."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, RenderResult
from rich.table import Table

from jointbench.station.screen.escaping_console import seen

_GAP = 2
"""Blanks between two columns."""


@dataclass(frozen=True, slots=True)
class FittedTable:
    """A table whose columns narrow with the width of the console.

    Heads wrap first, then the cells of the widest columns, both between words. Where
    even the longest words do not fit, each row becomes a block of lines.

    Attributes:
        columns: heads.
        rows: cells, as many in each as there are heads.
        words: numbers of the columns of text, which are left-aligned.
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    words: frozenset[int] = frozenset({0})

    def __rich_console__(
        self, console: Console, options: ConsoleOptions
    ) -> RenderResult:
        """Yield the table in the width of the console."""
        widths = fitted_widths(self.columns, self.rows, options.max_width)
        if widths is None:
            yield from (seen(line) for line in self._blocks())
        elif widths:
            yield self._table(widths)

    def _table(self, widths: Sequence[int]) -> Table:
        table = Table(box=None, pad_edge=False)
        for number, (head, width) in enumerate(zip(self.columns, widths, strict=True)):
            table.add_column(
                seen(head),
                justify="left" if number in self.words else "right",
                width=width,
                overflow="fold",
            )
        for row in self.rows:
            table.add_row(*(seen(cell) for cell in row))
        return table

    def _blocks(self) -> Iterator[str]:
        for row in self.rows:
            first, *rest = zip(self.columns, row, strict=True)
            yield f"{first[0]}: {first[1].strip()}"
            yield from (f"  {head}: {cell.strip()}" for head, cell in rest if cell)


def fitted_widths(
    columns: Sequence[str], rows: Sequence[Sequence[str]], width: int
) -> tuple[int, ...] | None:
    """Return the width of each column, or None where the words do not fit.

    Args:
        columns: heads.
        rows: cells.
        width: of the whole table [columns].
    """
    free = width - _GAP * max(len(columns) - 1, 0)
    cells = [list(each) for each in zip(*rows, strict=True)] or [[] for _ in columns]
    least = [_longest_word([head, *c]) for head, c in zip(columns, cells, strict=True)]
    whole = [
        max(_longest_word([head]), max(map(cell_len, c), default=0))
        for head, c in zip(columns, cells, strict=True)
    ]
    full = [max(n, cell_len(head)) for head, n in zip(columns, whole, strict=True)]
    steps = (full, whole, least)
    if sum(least) > free:
        return None
    for larger, smaller in pairwise(steps):
        if sum(smaller) <= free:
            return _narrowed(larger, smaller, free)
    return None


def _narrowed(
    larger: Sequence[int], smaller: Sequence[int], free: int
) -> tuple[int, ...]:
    """Narrow the widest column that can be narrowed until all of them fit."""
    widths = list(larger)
    while sum(widths) > free:
        spare = [
            (width, number)
            for number, width in enumerate(widths)
            if width > smaller[number]
        ]
        widths[max(spare)[1]] -= 1
    return tuple(widths)


def _longest_word(texts: Sequence[str]) -> int:
    return max((cell_len(word) for text in texts for word in text.split()), default=0)
