# SPDX-License-Identifier: MIT
"""The terminal: texts from files can neither control it nor imitate our own lines."""

from collections.abc import Iterable
from typing import Any

from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment
from rich.text import Text

from jointbench.acquisition.file_access.quoting import visible
from jointbench.station.screen.text_width import output_width


class Screen(Console):
    """A console that shows texts as they stand: no markup, no control characters.

    Rich separates its own control sequences (colours, moving bars) from the texts, so
    that texts can be escaped at the last step before the terminal.
    """

    def __init__(self, *, stderr: bool = False) -> None:
        super().__init__(stderr=stderr, highlight=False, markup=False, emoji=False)
        if not self.is_terminal:
            self.width = output_width()

    def print(self, *objects: Any, **options: Any) -> None:
        """Print; only line ends at the beginning of a text are kept as line ends."""
        super().print(
            *(one_line(one) if isinstance(one, str) else one for one in objects),
            **options,
        )

    def render(
        self, renderable: RenderableType, options: ConsoleOptions | None = None
    ) -> Iterable[Segment]:
        """Yield the segments to print, with control characters escaped."""
        for segment in super().render(renderable, options):
            if segment.control:
                yield segment
            else:
                lines = (visible(line) for line in segment.text.split("\n"))
                yield Segment("\n".join(lines), segment.style)


def one_line(text: str) -> str:
    """Return a text in one line, below the empty lines that it begins with."""
    rest = text.lstrip("\n")
    return "\n" * (len(text) - len(rest)) + visible(rest)


def seen(text: str, style: str = "") -> Text:
    """Return a text for rich, in one line and without markup."""
    return Text(visible(text), style=style)
