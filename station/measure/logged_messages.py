# SPDX-License-Identifier: MIT
"""A screen whose messages and requests are in the log of the session as well."""

from dataclasses import dataclass

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.recorder.recorder_process import RecorderProcess
from jointbench.acquisition.records.recordings import Channel
from jointbench.station.measure.observer import Command, HitNews, Watcher
from jointbench.station.measure.plan import Condition
from jointbench.station.session_events.event_codec import to_entry
from jointbench.station.session_events.flow_events import Asked, Said


@dataclass(slots=True)
class LoggedMessages:
    """A `Watcher` that logs messages to the operator, and passes them on.

    Attributes:
        watcher: shows it.
        recorder: logs it.
    """

    watcher: Watcher
    recorder: RecorderProcess
    _asked: Asked | None = None

    def begin(self, channels: tuple[Channel, ...], sample_rate: float) -> None:
        """Pass on that recording has begun."""
        self.watcher.begin(channels, sample_rate)

    def say(self, line: str) -> None:
        """Log a message."""
        self.recorder.log(to_entry(Said(line)))
        self.watcher.say(line)

    def block(self, samples: FloatArray) -> None:
        """Pass a block on."""
        self.watcher.block(samples)

    def ask(self, condition: Condition, done: int, total: int) -> None:
        """Log a request, once for each condition."""
        asked = Asked(condition.name, condition.point, done, total)
        if asked != self._asked:
            self._asked = asked
            self.recorder.log(to_entry(asked))
        self.watcher.ask(condition, done, total)

    def hit(self, news: HitNews) -> None:
        """Pass a hit on; its verdict is logged where it is entered."""
        self.watcher.hit(news)

    def command(self) -> Command | None:
        """Return what the operator said."""
        return self.watcher.command()
