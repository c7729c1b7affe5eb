# SPDX-License-Identifier: MIT
"""Output of a command: progress and tables for the terminal, JSON for programs.

Tables go to standard output, unless the JSON goes there; progress to standard error.
"""

import json
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence, Set
from contextlib import contextmanager, suppress
from math import isfinite
from pathlib import Path
from typing import IO, cast

from rich.console import Console, Group, RenderableType
from rich.markup import escape
from rich.progress import BarColumn, Progress, TextColumn
from rich.text import Text

from jointbench.station.files.output_paths import write_text
from jointbench.station.screen.escaping_console import Screen, seen
from jointbench.station.screen.fitted_table import FittedTable

_Jsonable = Mapping[str, object]


def console(json_target: str | None = None) -> Console:
    """Return the console for tables: standard error when JSON takes standard output."""
    return Screen(stderr=json_target == "-")


def lasting_console(json_target: str | None = None) -> Console:
    """Return a console that a closed terminal or pipe does not break.

    A measurement continues to its end without a reader.
    """
    screen = console(json_target)
    screen.file = cast("IO[str]", LastingText(screen.file))
    return screen


class LastingText:
    """A text stream that ignores errors of a closed terminal or pipe."""

    def __init__(self, stream: IO[str]) -> None:
        self._stream = stream

    def __getattr__(self, name: str) -> object:
        """Return an attribute of the stream."""
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        """Write; text that the stream refuses is dropped."""
        with suppress(OSError):
            return self._stream.write(text)
        return len(text)

    def flush(self) -> None:
        """Flush, if the stream is still open."""
        with suppress(OSError):
            self._stream.flush()


@contextmanager
def working(message: str) -> Iterator[None]:
    """Show a message on a terminal while the work lasts."""
    progress = Screen(stderr=True)
    if not progress.is_terminal:
        yield
        return
    with progress.status(seen(f"{message} ...")):
        yield


@contextmanager
def progress_bar(first: str) -> Iterator[Callable[[str, float], None]]:
    """Show a progress bar on a terminal.

    Yields:
        A function that takes the description of the step and the fraction done [-].
    """
    target = Screen(stderr=True)
    if not target.is_terminal:
        yield lambda _what, _fraction: None
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(bar_width=None),
        TextColumn("{task.percentage:>3.0f} %"),
    )
    with Progress(*columns, console=target, transient=True, expand=True) as bars:
        task = bars.add_task(first, total=1.0)
        yield lambda what, fraction: bars.update(
            task, description=escape(what), completed=fraction
        )


def table(
    title: str,
    columns: Sequence[str],
    rows: Sequence[Sequence[str]],
    *,
    words: Set[int] = frozenset({0}),
) -> RenderableType:
    """Return a titled table; columns of text are left-aligned, others right-aligned.

    Cells are texts without markup: brackets are units. They wrap where the terminal is
    too narrow.

    Args:
        title: above the table.
        columns: heads.
        rows: cells.
        words: numbers of the columns of text.
    """
    content = FittedTable(tuple(columns), tuple(map(tuple, rows)), frozenset(words))
    return Group(Text(), seen(title, style="bold"), content)


def write_json(target: str | None, content: _Jsonable) -> None:
    """Write `content` to a file, or to standard output when `target` is ``-``."""
    if target is None:
        return
    text = json.dumps(_plain(content), indent=2, allow_nan=False) + "\n"
    if target == "-":
        sys.stdout.write(text)
    else:
        write_text(Path(target), text)


def _plain(value: object) -> object:
    """Replace numbers that JSON cannot hold by null, and keys by text."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float):
        return value if isfinite(value) else None
    return value
