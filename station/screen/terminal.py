# SPDX-License-Identifier: MIT
"""What a command shows: progress and tables on the terminal, JSON for programs.

Tables go to standard output, unless the JSON goes there; progress to standard error.
"""

import json
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from math import isfinite
from pathlib import Path
from typing import IO, cast

from rich.console import Console, Group, RenderableType
from rich.markup import escape
from rich.progress import Progress
from rich.table import Table
from rich.text import Text

from jointbench.station.files.output_paths import write_text
from jointbench.station.screen.escaping_console import Screen, seen

_Jsonable = Mapping[str, object]


def console(json_target: str | None = None) -> Console:
    """Return the console for tables: standard error when JSON takes standard output."""
    return Screen(stderr=json_target == "-")


def lasting_console(json_target: str | None = None) -> Console:
    """Return a console that a closed terminal or pipe does not break.

    A measurement goes on, and is finished, where nobody reads any more.
    """
    screen = console(json_target)
    screen.file = cast("IO[str]", LastingText(screen.file))
    return screen


class LastingText:
    """A text stream that takes what it is given even where that goes nowhere."""

    def __init__(self, stream: IO[str]) -> None:
        self._stream = stream

    def __getattr__(self, name: str) -> object:
        """Return what the stream has."""
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        """Write; what nobody takes is dropped."""
        with suppress(OSError):
            return self._stream.write(text)
        return len(text)

    def flush(self) -> None:
        """Flush, if there is somewhere to flush to."""
        with suppress(OSError):
            self._stream.flush()


@contextmanager
def working(message: str) -> Iterator[None]:
    """Show on a terminal what is being done, for as long as it takes."""
    progress = Screen(stderr=True)
    if not progress.is_terminal:
        yield
        return
    with progress.status(seen(f"{message} ...")):
        yield


@contextmanager
def progress_bar(first: str) -> Iterator[Callable[[str, float], None]]:
    """Show a bar on a terminal; yield what moves it: words and the share done."""
    target = Screen(stderr=True)
    if not target.is_terminal:
        yield lambda _what, _share: None
        return
    with Progress(console=target, transient=True) as bars:
        task = bars.add_task(first, total=1.0)
        yield lambda what, share: bars.update(
            task, description=escape(what), completed=share
        )


def table(
    title: str, columns: Sequence[str], rows: Sequence[Sequence[str]]
) -> RenderableType:
    """Return a titled table, its first column left-aligned, the others right-aligned.

    Cells are texts as they stand, in one line: brackets are units, not markup.
    """
    result = Table(box=None, pad_edge=False)
    for number, column in enumerate(columns):
        result.add_column(seen(column), justify="left" if number == 0 else "right")
    for row in rows:
        result.add_row(*(seen(cell) for cell in row))
    return Group(Text(), seen(title, style="bold"), result)


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
    """Turn numbers that JSON cannot hold into null, and keys into text."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float):
        return value if isfinite(value) else None
    return value
