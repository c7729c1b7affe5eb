# SPDX-License-Identifier: MIT
"""A session in lines of text, for where there is no terminal."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from rich.console import Console

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.station.bench_view.verdict_words import verdict_word
from jointbench.station.session_events.command_codec import Command
from jointbench.station.session_events.event_codec import Event, Stamped
from jointbench.station.session_events.flow_events import (
    Asked,
    CableChanged,
    Said,
    SamplesMissing,
    Warned,
)
from jointbench.station.session_events.hit_events import SettingProposed
from jointbench.station.session_events.operator_events import CommandAnswered
from jointbench.station.session_events.session_state import SessionState, state_after
from jointbench.station.session_events.view_events import (
    BoltAsked,
    HitAveraged,
    SessionBegun,
)


@dataclass(slots=True)
class TextScreen:
    """A `LiveView` that prints a line for each event.

    Attributes:
        screen: where to.
    """

    screen: Console
    _state: SessionState = field(default_factory=SessionState)

    def follow(self, events: Sequence[Stamped]) -> None:
        """Print the events that an operator needs."""
        for stamped in events:
            self._state = state_after(self._state, (stamped,))
            line = self._line(stamped.event)
            if line:
                self._print(line)

    def level(self, samples: FloatArray) -> None:
        """Print nothing: levels are for a screen."""

    def command(self) -> Command | None:
        """Return None: there is no keyboard."""
        return None

    def _line(self, event: Event) -> str:
        match event:
            case SessionBegun(channels=channels, sample_rate=rate):
                names = ", ".join(str(row["name"]) for row in channels)
                return f"recording {names} at {rate:g} Hz"
            case Said(words=words):
                return words
            case Warned(words=words):
                return f"warning: {words}"
            case Asked(name=name, done=done, planned=planned):
                return f"[{done + 1}/{planned}] hit {name}"
            case SettingProposed(name=name, value=value, reason=reason):
                return f"{name} {value:.4g}: {reason}"
            case HitAveraged():
                return self._hit_line(event)
            case BoltAsked(bolt=bolt, bolts=bolts, target=target):
                return f"tighten bolt {bolt} of {bolts} to {target:g} N m"
            case CommandAnswered(words=words):
                return words
            case CableChanged() | SamplesMissing():
                return ""  # a warning or a message says it
        return ""

    def _hit_line(self, event: HitAveraged) -> str:
        hit = self._state.hits[event.hit]
        mean = event.mean_coherence
        coherence = "" if mean is None else f", coherence {mean:.3f}"
        word = verdict_word(hit, trial=event.trial)
        return (
            f"hit {event.hit + 1} {word} {event.good}/{event.wanted}{coherence}: "
            f"{hit.reason}"
        )

    def _print(self, line: str) -> None:
        self.screen.print(line, soft_wrap=True, markup=False)
