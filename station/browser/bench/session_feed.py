# SPDX-License-Identifier: MIT
"""A session as the server of a screen follows it: from its file alone, like `watch`."""

import asyncio
import json
import shutil
import time
from collections import OrderedDict
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jointbench.acquisition.basics.errors import JointbenchError
from jointbench.acquisition.records.recordings import Quantity
from jointbench.acquisition.session_file.follow_log import read_log
from jointbench.acquisition.session_file.follow_recording import (
    RecordingTail,
    recording_tail,
)
from jointbench.station.browser.bench.bench_state import bench_state
from jointbench.station.browser.bench.envelope_ring import EnvelopeRing
from jointbench.station.browser.bench.hit_pictures import hit_picture
from jointbench.station.session_events.condition_states import seconds_left
from jointbench.station.session_events.event_codec import from_log
from jointbench.station.session_events.hit_events import HitJudged
from jointbench.station.session_events.session_state import SessionState, state_after

_EVERY = 0.02  # [s] between looks at the file
_AFTER_SAMPLES = 0.045  # [s] after samples came; a block of the recorder is 50 ms
_UNWATCHED = 0.2  # [s] between looks where no screen is open, or no file is there
_STATED = 1.0  # [s] that a state is shared for; its clocks show seconds
WINDOW = 2.0
"""Time that the live view of the signals shows [s]."""
_BINS = 800  # of that time
_PICTURES = 200  # of hits that are kept
_STORED_UNIT = {
    Quantity.FORCE.value: "N",
    Quantity.ACCELERATION.value: "m/s²",
    Quantity.VELOCITY.value: "m/s",
    Quantity.DISPLACEMENT.value: "m",
    Quantity.PRESSURE.value: "Pa",
    Quantity.VOLTAGE.value: "V",
    Quantity.TEMPERATURE.value: "°C",
    Quantity.TACHO.value: "V",
}
_DISK_EVERY = 5.0  # [s] between looks at the disk


@dataclass(frozen=True, slots=True)
class StateMessage:
    """The state as it is sent to every screen.

    Attributes:
        number: of the message.
        text: JSON.
    """

    number: int
    text: str


class SessionFeed:
    """State, envelope and hits of one session; many screens may read them.

    What they are sent is encoded once for all of them. Where no screen is open, the
    samples are left unread, and the log is looked at less often.

    Attributes:
        path: of the session.
        meta: head of the recording, empty before.
        sensors: entries of the log about them, by name.
        state: after the last event.
        ring: envelope of the signals, None before the first sample.
        turn: counts the news.
    """

    def __init__(self, path: Path) -> None:
        """Follow a session, which may not be there yet.

        Args:
            path: of the session.
        """
        self.path = path
        self.meta: dict[str, Any] = {}
        self.sensors: dict[str, dict[str, Any]] = {}
        self.state = SessionState()
        self.ring: EnvelopeRing | None = None
        self.turn = 0
        self._tail: RecordingTail | None = None
        self._entries = self._stored = 0
        self._pictures: OrderedDict[int, bytes] = OrderedDict()
        self._news = asyncio.Event()
        self._told = self._stated = float("-inf")
        self._watching = 0
        self._free: tuple[float, int | None] = (float("-inf"), None)
        self._message = StateMessage(0, "")
        self._content = ""

    @asynccontextmanager
    async def running(self) -> AsyncIterator[None]:
        """Follow the session within the context."""
        task = asyncio.create_task(self._follow())
        try:
            yield
        finally:
            task.cancel()
            with suppress(asyncio.CancelledError):
                await task
            self._close()

    @contextmanager
    def watched(self) -> Iterator[None]:
        """Read samples for a screen within the context."""
        self._watching += 1
        try:
            yield
        finally:
            self._watching -= 1

    async def news(self, turn: int) -> None:
        """Return when there is something newer than at a turn, or after a second."""
        if self.turn == turn:
            await self._news.wait()

    def message(self) -> StateMessage:
        """Return the state for all screens, made again by an event or a second."""
        now = time.monotonic()
        changed = self._content == ""
        if changed:
            self._content = _json(self._state())
        if changed or now - self._stated >= _STATED:
            self._stated = now
            text = f'{{"state":{self._content[:-1]},{_json(self._clocks())[1:]}}}'
            self._message = StateMessage(self._message.number + 1, text)
        return self._message

    def _state(self) -> dict[str, Any]:
        """Return what only entries of the log change."""
        return {
            **bench_state(self.state),
            "file": str(self.path),
            "window": WINDOW,
            "channels": self._channels(),
            "notes_of_plan": self.meta.get("notes", ""),
            "sensors": self.sensors,
        }

    def _clocks(self) -> dict[str, Any]:
        now = time.time()
        return {
            "now": now,
            "seconds_left": seconds_left(self.state, now),
            "free": self._room(),
        }

    def picture(self, number: int) -> bytes | None:
        """Return a hit as JSON; None where its samples are not available.

        Args:
            number: of the hit, from 0.
        """
        if number not in self._pictures and number in self.state.hits:
            self._draw(self.state.hits[number])
        return self._pictures.get(number)

    async def _follow(self) -> None:
        while True:
            fresh, pause = False, _UNWATCHED
            if self.state.ended is not None:
                self._close()
            elif self._tail is not None or self._open():
                try:
                    fresh, pause = self._look()
                except (OSError, RuntimeError):  # the finished file takes its place
                    self._close()
            if fresh or time.monotonic() - self._told >= _STATED:
                self._tell()
            await asyncio.sleep(pause)

    def _tell(self) -> None:
        """Wake whoever waits; an event that is set and cleared wakes all of them."""
        self._told = time.monotonic()
        self.turn += 1
        self._news.set()
        self._news.clear()

    def _open(self) -> bool:
        """Open the recording, or read a finished one; return whether it is open."""
        self._tail = recording_tail(self.path)
        if self._tail is not None:
            self.meta = self._tail.meta
            self._entries, self._content = 0, ""
            return True
        with suppress(JointbenchError):
            entries, live = read_log(self.path)
            if entries and not live:
                self._take(entries[self._entries :])
                self._tell()
        return False

    def _look(self) -> tuple[bool, float]:
        """Take what is new in the file; return whether there was any, and a pause [s].

        Samples come in blocks: a look sooner after one would find none.
        """
        tail = self._tail
        assert tail is not None
        stored, before = tail.stored() if self._watching else 0, self._stored
        if stored > before:
            self._envelope(tail, stored)
        entries = tail.entries()
        if entries:
            # What they judge is in the file; the length read before may be older.
            tail.stored()
            self._take(entries)
        if not self._watching:
            return bool(entries), _UNWATCHED
        if stored > before:
            return True, _AFTER_SAMPLES
        return bool(entries), _EVERY

    def _take(self, entries: tuple[dict[str, Any], ...]) -> None:
        """Take entries of the log; a hit is drawn while its samples are available."""
        first, self._entries = self._entries, self._entries + len(entries)
        self._content = ""
        for entry in entries:
            if entry.get("kind") == "sensor":
                self.sensors[str(entry.get("name"))] = entry
        known = self.state.last
        events = [e for e in from_log(entries, first=first) if e.id > known]
        self.state = state_after(self.state, events)
        for stamped in events[-4:]:
            if isinstance(stamped.event, HitJudged):
                self._draw(stamped.event)

    def _envelope(self, tail: RecordingTail, stored: int) -> None:
        rate = float(self.meta["sample_rate"])
        if self.ring is None:
            per_bin = max(1, round(WINDOW * rate / _BINS))
            self.ring = EnvelopeRing(
                len(self.meta["channels"]), per_bin=per_bin, kept=_BINS
            )
        late = stored - self._stored - round(WINDOW * rate)
        if late > 0:
            self.ring.skip(late)
            self._stored += late
        self.ring.feed(tail.read(self._stored, stored))
        self._stored = stored

    def _draw(self, hit: HitJudged) -> None:
        if self._tail is None or hit.number in self._pictures:
            return
        with suppress(OSError, RuntimeError):
            samples = self._tail.read(hit.start, hit.stop)
            if samples.shape[1] == hit.stop - hit.start:
                picture = hit_picture(
                    hit,
                    samples,
                    self.meta["channels"],
                    float(self.meta["sample_rate"]),
                )
                self._pictures[hit.number] = _json(picture).encode()
        while len(self._pictures) > _PICTURES:
            self._pictures.popitem(last=False)

    def _channels(self) -> list[dict[str, Any]]:
        """Return the channels, each with the unit that its samples are stored in."""
        return [
            {**row, "si": _STORED_UNIT.get(str(row["quantity"]), "")}
            for row in self.meta.get("channels", [])
        ]

    def _room(self) -> int | None:
        looked, free = self._free
        if time.monotonic() - looked > _DISK_EVERY:
            free = None
            with suppress(OSError):
                free = shutil.disk_usage(self.path.parent).free
            self._free = time.monotonic(), free
        return free

    def _close(self) -> None:
        if self._tail is not None:
            with suppress(OSError, RuntimeError):
                self._tail.close()
            self._tail = None


def _json(content: object) -> str:
    return json.dumps(content, separators=(",", ":"))
