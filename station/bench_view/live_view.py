# SPDX-License-Identifier: MIT
"""What a view of a running session is: a client of its events."""

from collections.abc import Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Protocol

from rich.console import Console

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.station.session_events.command_codec import Command
from jointbench.station.session_events.event_codec import Stamped


class LiveView(Protocol):
    """A screen, or lines of text."""

    def follow(self, events: Sequence[Stamped]) -> None:
        """Show further events of the log, in their order."""
        ...

    def level(self, samples: FloatArray) -> None:
        """Show the levels of samples just stored, SI units, (n_channels, n)."""
        ...

    def command(self) -> Command | None:
        """Return what the operator asked for since the last call, if anything."""
        ...


class Viewing(Protocol):
    """Opens the view of a session."""

    def __call__(
        self, screen: Console, file: Path, /
    ) -> AbstractContextManager[LiveView]:
        """Show a session as long as the context lasts.

        Args:
            screen: terminal, or where lines go.
            file: of the session, which may not be there yet.
        """
        ...
