# SPDX-License-Identifier: MIT
"""The terminal: nothing that a file says can command it, or pass for a line of ours."""

from collections.abc import Iterable
from typing import Any

from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment
from rich.text import Text

from jointbench.acquisition.file_access.quoting import visible

WIDTH_WITHOUT_TERMINAL = 120


class Screen(Console):
    """A console that shows texts as they stand: no markup, no control characters.

    The console's own control sequences (colours, bars that move) are set apart by rich
    from the texts, which is what makes this possible at the last step before the
    terminal, whatever rich was given to print.
    """

    def __init__(self, *, stderr: bool = False) -> None:
        super().__init__(stderr=stderr, highlight=False, markup=False, emoji=False)
        if not self.is_terminal:
            self.width = WIDTH_WITHOUT_TERMINAL

    def print(self, *objects: Any, **options: Any) -> None:
        """Print; of a text only the line ends at its beginning are line ends."""
        super().print(
            *(one_line(one) if isinstance(one, str) else one for one in objects),
            **options,
        )

    def render(
        self, renderable: RenderableType, options: ConsoleOptions | None = None
    ) -> Iterable[Segment]:
        """Yield what is printed, made visible."""
        for segment in super().render(renderable, options):
            if segment.control:
                yield segment
            else:
                lines = (visible(line) for line in segment.text.split("\n"))
                yield Segment("\n".join(lines), segment.style)


def one_line(text: str) -> str:
    """Return a text that takes one line, below the empty lines it begins with."""
    rest = text.lstrip("\n")
    return "\n" * (len(text) - len(rest)) + visible(rest)


def seen(text: str, style: str = "") -> Text:
    """Return a text as rich sets it, in one line and without markup."""
    return Text(visible(text), style=style)
