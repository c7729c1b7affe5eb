# SPDX-License-Identifier: MIT
"""What a view of a running session is: a client of its events."""

from collections.abc import Sequence
from typing import Protocol

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
