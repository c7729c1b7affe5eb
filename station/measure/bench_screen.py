# SPDX-License-Identifier: MIT
"""The bench screen: levels, the last hit, FRF and coherence, progress, keys."""

from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from rich.console import Console, Group, RenderableType
from rich.live import Live
from rich.table import Table
from rich.text import Text

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.file_access.quoting import visible
from jointbench.acquisition.records.recordings import Channel, Verdict
from jointbench.signal.frf.frf import Frf
from jointbench.signal.hits.live_hits import CutHit
from jointbench.station.measure.observer import Command, HitNews, Watcher
from jointbench.station.measure.plan import Condition
from jointbench.station.measure.text_screen import TextScreen, verdict_word
from jointbench.station.screen.escaping_console import seen
from jointbench.station.screen.key_presses import Poll, keyboard

_KEYS = {
    "a": Command.ACCEPT,
    "r": Command.REJECT,
    "u": Command.UNDO,
    "p": Command.REPEAT,
    "n": Command.NEXT,
    "q": Command.QUIT,
}
_KEY_HELP = "a accept  r reject  u undo  p repeat point  n next point  q quit"
_WIDTH = 64
_BARS = " ▁▂▃▄▅▆▇█"
_FRAMES = 8  # a second
_NEAR_FULL = 0.98
_HIT_MS = 6.0  # of the force that is drawn [ms]


@dataclass(slots=True)
class BenchScreen:
    """A `Watcher` that draws.

    Attributes:
        live: where to.
        poll: of the keyboard.
    """

    live: Live
    poll: Poll
    _channels: tuple[Channel, ...] = ()
    _rate: float = 1.0
    _peaks: list[float] = field(default_factory=list)
    _asked: str = ""
    _progress: str = ""
    _news: HitNews | None = None
    _said: deque[str] = field(default_factory=lambda: deque(maxlen=4))

    def begin(self, channels: tuple[Channel, ...], sample_rate: float) -> None:
        """Show the channels."""
        self._channels, self._rate = channels, sample_rate
        self._peaks = [0.0] * len(channels)
        self.say(f"recording at {sample_rate:g} Hz")

    def say(self, line: str) -> None:
        """Show a line among the last ones."""
        self._said.append(line)
        self._draw()

    def block(self, samples: FloatArray) -> None:
        """Show the levels, which fall slowly after a peak."""
        new = np.abs(samples).max(axis=1)
        self._peaks = [
            max(float(n), 0.9 * p) for n, p in zip(new, self._peaks, strict=True)
        ]
        self._draw()

    def ask(self, condition: Condition, done: int, total: int) -> None:
        """Show what to hit next."""
        self._asked = f"HIT {condition.name}"
        self._progress = f"{done} of {total} conditions are done"
        self._draw()

    def hit(self, news: HitNews) -> None:
        """Show a hit with its verdict."""
        self._news = news
        self._draw()

    def command(self) -> Command | None:
        """Return what the key pressed last stands for."""
        return _KEYS.get(self.poll().lower())

    def _draw(self) -> None:
        parts: list[RenderableType] = [
            seen(self._asked, style="bold reverse"),
            Text(self._progress),
            self._levels(),
        ]
        if self._news is not None:
            parts += _hit_lines(self._news, self._rate)
        parts += [seen(line, style="dim") for line in self._said]
        parts.append(Text(_KEY_HELP, style="italic"))
        self.live.update(Group(*parts))

    def _levels(self) -> Table:
        table = Table.grid(padding=(0, 1))
        for channel, peak in zip(self._channels, self._peaks, strict=True):
            table.add_row(*level_row(channel, peak))
        return table


def level_row(channel: Channel, peak: float) -> tuple[Text, Text, Text]:
    """Return name, bar and number of a channel; red where it nears its range."""
    share = peak / channel.range if channel.range else 0.0
    full = share >= _NEAR_FULL
    filled = min(30, round(30 * share))
    style = "bold red" if full else "green"
    lamp = " OVERLOAD" if full else ""
    return (
        seen(channel.name),
        Text("█" * filled + "·" * (30 - filled), style=style),
        Text(f"{100 * share:5.1f} %{lamp}", style=style),
    )


def _hit_lines(news: HitNews, rate: float) -> list[RenderableType]:
    """Return the lines about the last hit: verdict, force, FRF, coherence."""
    trial = news.condition is None and news.hit.verdict is Verdict.OPERATOR
    good = news.hit.verdict is Verdict.OK
    words = f" hit {news.number} {verdict_word(news)} "
    style = "black on green" if good else "black on cyan" if trial else "white on red"
    verdict = seen(words, style=style)
    verdict.append(
        visible(f" {news.good}/{news.wanted}  {news.hit.reason}"), style="default"
    )
    lines: list[RenderableType] = [verdict, Text(_force_line(news.cut, rate))]
    if news.frf is not None:
        lines += [Text(line) for line in _frf_lines(news.frf, news.coherence)]
    return lines


def _force_line(cut: CutHit, rate: float) -> str:
    """Return the force pulse as a line of bars."""
    first = max(0, cut.trigger - round(1e-3 * rate))
    count = max(_WIDTH, round(_HIT_MS * 1e-3 * rate))
    force = cut.samples[0, first : first + count]
    return f"force     {spark(force, 0.0, float(force.max()))} {force.max():.4g} N"


def _frf_lines(frf: Frf, coherence: float | None) -> tuple[str, ...]:
    """Return magnitude [dB] and coherence of the first response as lines of bars."""
    low, high = frf.usable_band or (frf.frequency[0], frf.frequency[-1])
    inside = (frf.frequency >= low) & (frf.frequency <= high)
    size = 20 * np.log10(np.abs(frf.response[0, 0, inside]) + 1e-12)
    top = float(size.max())
    lines = [f"FRF       {spark(size, top - 60.0, top)} {low:.0f} to {high:.0f} Hz"]
    if frf.coherence is not None and coherence is not None:
        values = frf.coherence[0, 0, inside]
        lines.append(f"coherence {spark(values, 0.0, 1.0)} {coherence:.3f}")
    return tuple(lines)


def spark(values: FloatArray, low: float, high: float) -> str:
    """Return values as a line of bars, the largest of each column."""
    edges = np.linspace(0, values.size, _WIDTH + 1).astype(int)
    columns = [values[a : max(b, a + 1)].max() for a, b in pairwise(edges.tolist())]
    share = (np.array(columns) - low) / max(high - low, 1e-30)
    heights = np.clip(np.round(share * (len(_BARS) - 1)), 0, len(_BARS) - 1)
    return "".join(_BARS[int(height)] for height in heights)


@contextmanager
def watching(screen: Console) -> Iterator[Watcher]:
    """Give a session the bench screen where there is a terminal, lines where not."""
    if not screen.is_terminal:
        yield TextScreen(screen)
        return
    with keyboard() as poll, Live(console=screen, refresh_per_second=_FRAMES) as live:
        yield BenchScreen(live, poll)
