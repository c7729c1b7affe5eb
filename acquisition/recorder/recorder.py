# SPDX-License-Identifier: MIT
"""The recording process: read, store, report, and nothing else.

It never waits for the measuring program, unless the device has no clock of its own. If
the program dies, it closes and finishes the file.
"""

import signal
import time
from collections import deque
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from multiprocessing.connection import Connection
from typing import Any

from jointbench.acquisition.basics.errors import InstrumentError, JointbenchError
from jointbench.acquisition.ni.driver import Chassis
from jointbench.acquisition.ni.stream import Block, NiStream, StreamGap, Waiting
from jointbench.acquisition.recorder import replies
from jointbench.acquisition.recorder.news import NewsBox
from jointbench.acquisition.recorder.replies import Reply
from jointbench.acquisition.recorder.requests import (
    Ask,
    CreateFile,
    Log,
    Request,
    Setup,
    Stop,
    TriggerBy,
)
from jointbench.acquisition.session_file.finish import finish_live
from jointbench.acquisition.session_file.live_read import LiveSpan
from jointbench.acquisition.session_file.live_write import LiveSession

_AT_ONCE = (Ask.NEXT, Ask.OPEN_LOOPS)
"""Served, as log entries are, while the stream waits for a lost device."""


class _Ended(Exception):
    """The measuring program ended the recording, or died."""


def run_recorder(link: Connection, setup: Setup) -> None:
    """Record until the measuring program ends it; the entry of the process.

    Args:
        link: to the measuring program.
        setup: what is streamed.
    """
    # A key or a closed terminal reaches every process of its group; the measuring
    # program decides what follows from it.
    for name in ("SIGINT", "SIGHUP", "SIGBREAK"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)
    with suppress(_Ended):
        Recorder(link, setup).run()


class Recorder:
    """One recording, served to one measuring program."""

    def __init__(self, link: Connection, setup: Setup) -> None:
        """Prepare a recording; nothing is opened yet."""
        self._link, self._setup = link, setup
        self._live: LiveSession | None = None
        self._news = NewsBox()
        self._asked = self._terminated = False
        self._failure: Exception | None = None
        self._later: deque[Request] = deque()
        self._stop: Stop | None = None
        self._paused = False

    def run(self) -> None:
        """Open the device, record, close."""
        signal.signal(signal.SIGTERM, self._terminate)
        chassis = Chassis(self._setup.address)
        try:
            settings = replace(self._setup.settings, sleep=self._sleep)
            self._stream = NiStream(chassis, self._setup.sensors, settings)
            self._in_step = not chassis.has_clock()
            self._stream.start()
        except JointbenchError as error:
            chassis.close()
            self._send(replies.Failed(error))
            return
        try:
            self._send(replies.Ready(self._stream.sample_rate, self._in_step))
            with suppress(_Ended):
                self._record()
            self._end()
        finally:
            self._stream.close()
            chassis.close()

    def _terminate(self, number: int, frame: object) -> None:
        self._terminated = True

    def _record(self) -> None:
        """Serve and read in turn.

        Raises:
            _Ended: the measuring program wants no more, or died.
        """
        items = self._stream.items()
        while True:
            self._serve_all()
            try:
                self._take(next(items))
            except (JointbenchError, OSError) as error:
                self._failure = error
            self._report()

    def _serve_all(self) -> None:
        """Serve what was requested; wait where nothing may be read without a request.

        Raises:
            _Ended: see `_record`.
        """
        while self._later or self._must_wait() or self._link.poll():
            self._serve(self._later.popleft() if self._later else self._receive())

    def _must_wait(self) -> bool:
        if self._live is None or self._paused or self._failure or self._terminated:
            return True
        return self._in_step and not self._asked

    def _receive(self) -> Request:
        try:
            request: Request = self._link.recv()
        except (EOFError, OSError):
            raise _Ended from None
        if isinstance(request, Stop):
            self._stop = request
            raise _Ended
        return request

    def _sleep(self, seconds: float) -> None:
        """Wait for a lost device; serve meanwhile what does not change the stream.

        Raises:
            _Ended: see `_record`.
        """
        if self._terminated:
            self._report()
        until = time.monotonic() + seconds
        while self._link.poll(max(0.0, until - time.monotonic())):
            request = self._receive()
            if isinstance(request, Log) or request in _AT_ONCE:
                self._serve(request)
            else:
                self._later.append(request)

    def _serve(self, request: Request) -> None:
        """Carry out a request and reply."""
        if request is Ask.NEXT:
            self._asked = True
            self._report()
        elif isinstance(request, Log):
            with suppress(InstrumentError):  # reported at the next block
                self._log(request.entry)
        else:
            try:
                self._send(replies.Done(self._carry_out(request)))
            except JointbenchError as error:
                self._send(replies.Failed(error))

    def _carry_out(self, request: Request) -> object:
        stream = self._stream
        if isinstance(request, CreateFile):
            self._create(request)
            return None
        if request is Ask.OPEN_LOOPS:
            return stream.open_loops()
        if request is Ask.RESUME:
            stream.resume()
            self._paused = False
            return None
        if isinstance(request, TriggerBy):
            stream.trigger_by(request.trigger)
        else:
            self._paused = True
            stream.pause()
        return 0 if self._live is None else self._live.samples

    def _create(self, new: CreateFile) -> None:
        self._live = LiveSession(
            new.path,
            new.meta,
            channels=sum(len(sensor.axes) for sensor in self._setup.sensors),
            block=self._setup.settings.block,
        )

    def _take(self, item: Block | StreamGap | Waiting) -> None:
        """Store an item; it is news once it is in the file."""
        assert self._live is not None
        if isinstance(item, Block):
            stored, count = self._live.samples, item.samples.shape[1]
            self._live.append(item.samples, segment=item.segment, first=item.first)
            self._live.written()
            self._news.add(LiveSpan(item.segment, item.first, stored, count))
            return
        if isinstance(item, StreamGap):
            self._log(gap_entry(item))
        self._news.add(item)

    def _report(self) -> None:
        """Answer the measuring program, if it asked and there is something to say."""
        if not self._asked:
            return
        if self._news or self._terminated:
            self._asked = False
            counters = replace(self._stream.counters)
            news = replies.News(self._news.take(), counters, self._terminated)
            self._send(news)
        elif self._failure is not None:
            self._asked = False
            self._send(replies.Failed(self._failure))

    def _log(self, entry: Mapping[str, object]) -> None:
        if self._live is not None:
            self._live.log(entry)

    def _end(self) -> None:
        """Close the books and the file; finish it where the program died."""
        failure: Exception | None = None
        with suppress(InstrumentError):
            self._stream.count()
        try:
            self._close_file(interrupted=self._stop is None or self._stop.interrupted)
        except JointbenchError as error:
            failure = error
        if self._stop is not None:
            self._send(replies.Closed(self._stream.counters, failure))
        elif self._live is not None:
            with suppress(JointbenchError):
                finish_live(self._live.path, self._live.path, overwrite=True)

    def _close_file(self, *, interrupted: bool) -> None:
        live, counters = self._live, self._stream.counters
        if live is None:
            return
        end: dict[str, Any] = {"kind": "end", "interrupted": interrupted}
        if self._stop is None:
            end["reason"] = "the measuring program ended without a message"
        try:
            live.log(
                {
                    "kind": "continuity",
                    "acquired": counters.acquired,
                    "unread": counters.unread,
                    "unwanted": counters.unwanted,
                    "stored_samples": live.samples,
                    "lost": counters.lost,
                }
            )
            live.log(end)
        finally:
            live.close()

    def _send(self, reply: Reply) -> None:
        """Reply.

        Raises:
            _Ended: the measuring program died.
        """
        try:
            self._link.send(reply)
        except OSError:
            raise _Ended from None


def gap_entry(gap: StreamGap) -> dict[str, object]:
    """Return the log entry of missing samples."""
    return {
        "kind": "gap",
        "what": gap.kind,
        "segment": gap.segment,
        "first_sample": gap.first,
        "samples": gap.samples,
        "seconds": round(gap.seconds, 3),
        "words": gap.words,
    }
