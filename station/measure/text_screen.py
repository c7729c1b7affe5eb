# SPDX-License-Identifier: MIT
"""A session in lines of text, for where there is no terminal."""

from dataclasses import dataclass

from rich.console import Console

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.recordings import Channel, Verdict
from jointbench.station.measure.observer import Command, HitNews
from jointbench.station.measure.plan import Condition


def verdict_word(news: HitNews) -> str:
    """Return what became of a hit, in the operator's words."""
    if news.condition is None and news.hit.verdict is Verdict.OPERATOR:
        return "trial"
    return news.hit.verdict.value.replace("_", " ")


@dataclass(slots=True)
class TextScreen:
    """Print what happens, a line each.

    Attributes:
        screen: where to.
    """

    screen: Console
    _asked: str = ""

    def begin(self, channels: tuple[Channel, ...], sample_rate: float) -> None:
        """Say that recording has begun."""
        names = ", ".join(channel.name for channel in channels)
        self._print(f"recording {names} at {sample_rate:g} Hz")

    def say(self, line: str) -> None:
        """Print a line."""
        self._print(line)

    def block(self, samples: FloatArray) -> None:
        """Print nothing: levels are for a screen."""

    def ask(self, condition: Condition, done: int, total: int) -> None:
        """Print which condition comes next, once."""
        if condition.name != self._asked:
            self._asked = condition.name
            self._print(f"[{done + 1}/{total}] hit {condition.name}")

    def hit(self, news: HitNews) -> None:
        """Print a verdict with its reason."""
        coherence = ""
        if news.coherence is not None:
            coherence = f", coherence {news.coherence:.3f}"
        self._print(
            f"hit {news.number} {verdict_word(news)} {news.good}/{news.wanted}"
            f"{coherence}: {news.hit.reason}"
        )

    def command(self) -> Command | None:
        """Return None: there is no keyboard."""
        return None

    def _print(self, line: str) -> None:
        self.screen.print(line, soft_wrap=True, markup=False)
