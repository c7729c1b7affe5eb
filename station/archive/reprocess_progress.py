# SPDX-License-Identifier: MIT
"""How far a reprocessing run has come: a bar on a terminal, lines elsewhere."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
)

from jointbench.station.archive.process_file import State
from jointbench.station.screen.escaping_console import Screen

LINE_EVERY = 10.0
"""Between two lines where there is no terminal [s]."""
Counts = dict[State, int]
Tell = Callable[[Counts], None]


@contextmanager
def run_progress(total: int) -> Iterator[Tell]:
    """Show progress with rate and time left; yield the callback for the counts.

    Args:
        total: number of files.
    """
    screen = Screen(stderr=True)
    if not screen.is_terminal:
        yield _lines(screen, total)
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[words]}"),
    )
    begun = time.monotonic()
    with Progress(*columns, console=screen) as bars:
        bar = bars.add_task("files", total=total, words="")

        def tell(counts: Counts) -> None:
            done = sum(counts.values())
            seconds = time.monotonic() - begun
            failed = f"{counts[State.FAILED]} failed"
            words = f"{failed}, {rest_words(counts, total, seconds)}"
            bars.update(bar, completed=done, words=words)

        yield tell


def _lines(screen: Console, total: int) -> Tell:
    begun = time.monotonic()
    last = begun

    def tell(counts: Counts) -> None:
        nonlocal last
        if time.monotonic() - last < LINE_EVERY:
            return
        last = time.monotonic()
        screen.print(progress_line(counts, total, last - begun), soft_wrap=True)

    return tell


def progress_line(counts: Counts, total: int, seconds: float) -> str:
    """Return one line with the progress of a run.

    Args:
        counts: files by what became of them.
        total: number of files.
        seconds: since the run began [s].
    """
    met = sum(counts.values())
    words = ", ".join(f"{counts[state]} {state.value}" for state in State)
    return f"{met}/{total} files: {words}; {rest_words(counts, total, seconds)}"


def rest_words(counts: Counts, total: int, seconds: float) -> str:
    """Return how fast it goes, and how long what is left takes at that rate."""
    worked, left = _worked(counts), total - sum(counts.values())
    time_left = left * seconds / worked if worked else 0.0
    return f"{rate_words(counts, seconds)}, {time_words(time_left)} left"


def rate_words(counts: Counts, seconds: float) -> str:
    """Return files a second, or seconds a file where that is slower."""
    worked = _worked(counts)
    if not worked or seconds <= 0:
        return "- files/s"
    rate = worked / seconds
    return f"{rate:.3g} files/s" if rate >= 1 else f"{1 / rate:.3g} s/file"


def _worked(counts: Counts) -> int:
    """Return the files that took time: skipped files predict nothing of the rest."""
    return sum(counts.values()) - counts[State.SKIPPED] or sum(counts.values())


def time_words(seconds: float) -> str:
    """Write a time as people say it.

    >>> time_words(3725)
    '1 h 2 min'
    """
    if seconds < 60:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 60 else f"{minutes // 60} h {minutes % 60} min"
