# SPDX-License-Identifier: MIT
"""Messages from a session to its observer, and commands back."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.recordings import Channel, Hit
from jointbench.signal.frf.frf import Frf
from jointbench.signal.hits.live_hits import CutHit
from jointbench.station.measure.plan import Condition


class Command(StrEnum):
    """What the operator may say."""

    ACCEPT = "accept"
    REJECT = "reject"
    UNDO = "undo"
    REPEAT = "repeat"
    NEXT = "next"
    QUIT = "quit"


@dataclass(frozen=True, slots=True, eq=False)
class HitNews:
    """One hit, just judged.

    Attributes:
        number: since the session began, from 1.
        cut: its samples.
        hit: verdict, number and reason.
        condition: that it belongs to, None for a trial hit.
        good: accepted hits of the condition so far, this one included.
        wanted: accepted hits that the condition needs.
        frf: average of the condition so far, None without any.
        coherence: of that average [-], None with fewer than two hits.
    """

    number: int
    cut: CutHit
    hit: Hit
    condition: Condition | None
    good: int
    wanted: int
    frf: Frf | None
    coherence: float | None


class Watcher(Protocol):
    """A screen, lines of text, or no one."""

    def begin(self, channels: tuple[Channel, ...], sample_rate: float) -> None:
        """Report that recording has begun."""
        ...

    def say(self, line: str) -> None:
        """Report one message."""
        ...

    def block(self, samples: FloatArray) -> None:
        """Show a block that was just stored, SI units."""
        ...

    def ask(self, condition: Condition, done: int, total: int) -> None:
        """Ask for hits under a condition; `done` of `total` conditions are over."""
        ...

    def hit(self, news: HitNews) -> None:
        """Show a hit."""
        ...

    def command(self) -> Command | None:
        """Return what the operator said since the last call, if anything."""
        ...


class Operator(Protocol):
    """The operator: a person who reads the screen, or a simulated one."""

    def ask(self, condition: Condition) -> None:
        """Request one hit; a person needs only the screen."""
        ...


class BenchOperator:
    """A person."""

    def ask(self, condition: Condition) -> None:
        """Do nothing: the screen says it."""
