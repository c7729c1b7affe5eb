# SPDX-License-Identifier: MIT
"""The full-screen view of a session on a terminal, with keys and bell."""

import shutil
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from rich.console import Console, Group
from rich.live import Live

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.station.bench_view.bell import Bell
from jointbench.station.bench_view.level_meter import LevelMeter
from jointbench.station.bench_view.live_view import LiveView
from jointbench.station.bench_view.operator_keys import (
    KEYS,
    RUN_KEYS,
    OperatorKeys,
)
from jointbench.station.bench_view.session_screen import (
    Look,
    ViewContext,
    session_lines,
)
from jointbench.station.bench_view.text_screen import TextScreen
from jointbench.station.screen.key_presses import Poll, keyboard
from jointbench.station.session_events.command_codec import Command
from jointbench.station.session_events.event_codec import Stamped
from jointbench.station.session_events.session_state import SessionState, state_after
from jointbench.station.session_events.view_events import HitAveraged

_EVERY = 0.25  # [s] between frames where only levels and clocks change
_DISK_EVERY = 5.0  # [s] between looks at the disk


@dataclass(slots=True)
class TerminalView:
    """A `LiveView` that draws.

    Attributes:
        live: where to.
        poll: of the keyboard.
        file: of the session.
        clock: time since 1970 [s].
        state: what the events amount to.
    """

    live: Live
    poll: Poll
    file: Path
    clock: Callable[[], float] = time.time
    state: SessionState = field(default_factory=SessionState)
    keys: OperatorKeys = field(default_factory=OperatorKeys)
    _meter: LevelMeter = field(default_factory=LevelMeter)
    _bell: Bell = field(init=False)
    _key_lines: tuple[str, ...] = KEYS
    _drawn: float = float("-inf")
    _free: tuple[float, int | None] = (float("-inf"), None)

    def __post_init__(self) -> None:
        """Connect the bell."""
        self._bell = Bell(self.live.console.bell)

    def follow(self, events: Sequence[Stamped]) -> None:
        """Show further events."""
        for stamped in events:
            self.state = state_after(self.state, (stamped,))
            if isinstance(stamped.event, HitAveraged):
                self._bell.hit(self.state.hits[stamped.event.hit], stamped.event)
        self._draw()

    def join(self, events: Sequence[Stamped]) -> None:
        """Show a session that runs already; what is past rings no bell."""
        self.state = state_after(self.state, events)
        self._draw()

    def show_keys(self, lines: tuple[str, ...]) -> None:
        """Show other lines about the keys."""
        self._key_lines = lines

    def level(self, samples: FloatArray) -> None:
        """Show the levels of a block."""
        if self.state.begun is not None:
            self._meter.feed(samples, sample_rate=self.state.begun.sample_rate)

    def command(self) -> Command | None:
        """Return what the keys pressed since the last call amount to."""
        pressed = self.poll()
        command = self.keys.press(pressed, self.state)
        self._bell.tick()
        if pressed or time.monotonic() - self._drawn > _EVERY:
            self._draw()
        return command

    def _draw(self) -> None:
        self._drawn = time.monotonic()
        begun = self.state.begun
        levels = () if begun is None else self._meter.levels(begun.channels)
        around = ViewContext(str(self.file), self._room(), self.clock(), levels)
        size = self.live.console.size
        look = Look(
            width=size.width,
            height=size.height,
            channel=self.keys.channel,
            prompt=self.keys.prompt,
            keys=self._usable_keys(),
        )
        lines = session_lines(self.state, around, look)
        self.live.update(Group(*lines), refresh=True)

    def _usable_keys(self) -> tuple[str, ...]:
        """Return the lines about the keys that do something now."""
        if self._key_lines is not KEYS:
            return self._key_lines
        if self.state.begun is None or self.state.ended is not None:
            return ()
        return KEYS if self.state.begun.conditions else RUN_KEYS

    def _room(self) -> int | None:
        looked, free = self._free
        if self._drawn - looked > _DISK_EVERY:
            try:
                free = shutil.disk_usage(self.file.parent).free
            except OSError:
                free = None
            self._free = self._drawn, free
        return free


@contextmanager
def viewing(screen: Console, file: Path) -> Iterator[LiveView]:
    """Give a session the full screen where there is a terminal, lines where not.

    Args:
        screen: where to.
        file: of the session.
    """
    if not screen.is_terminal:
        yield TextScreen(screen)
        return
    with (
        keyboard() as poll,
        Live(console=screen, screen=True, auto_refresh=False) as live,
    ):
        yield TerminalView(live, poll, file)
