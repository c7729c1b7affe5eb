# SPDX-License-Identifier: MIT
"""The recording process: read, store, report, and nothing else.

It never waits for the measuring program, unless the device has no clock of its own. If
the program dies, it closes and finishes the file.
"""

import signal
import time
from collections import deque
from contextlib import suppress
from multiprocessing.connection import Connection
from typing import Any

from jointbench.acquisition.basics.errors import InstrumentError, JointbenchError
from jointbench.acquisition.basics.steady_memory import keep_memory_steady
from jointbench.acquisition.ni.stream import StreamGap
from jointbench.acquisition.recorder import replies
from jointbench.acquisition.recorder.news import NewsBox
from jointbench.acquisition.recorder.replies import Reply
from jointbench.acquisition.recorder.requests import (
    Ask,
    ChangeSetup,
    CreateFile,
    Log,
    Request,
    Setup,
    Stop,
    TriggerBy,
)
from jointbench.acquisition.recorder.stored_stream import StoredStream
from jointbench.acquisition.session_file.finish import finish_live

_REST = 5.0
"""Time in which the rest of the device's buffer is stored at the end [s]."""
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
    keep_memory_steady()
    with suppress(_Ended):
        Recorder(link, setup).run()


class Recorder:
    """One recording, served to one measuring program."""

    def __init__(self, link: Connection, setup: Setup) -> None:
        """Prepare a recording; nothing is opened yet."""
        self._link, self._setup = link, setup
        self._file: CreateFile | None = None
        self._news = NewsBox()
        self._asked = self._terminated = False
        self._failure: Exception | None = None
        self._later: deque[Request] = deque()
        self._stop: Stop | None = None
        self._paused = self._over = False

    def run(self) -> None:
        """Open the device, record, close."""
        signal.signal(signal.SIGTERM, self._terminate)
        try:
            self._stream = StoredStream(self._setup, self._sleep)
        except JointbenchError as error:
            self._send(replies.Failed(error))
            return
        try:
            self._send(self._ready())
            with suppress(_Ended):
                self._record()
            self._end()
        finally:
            self._stream.close()

    def _terminate(self, number: int, frame: object) -> None:
        self._terminated = True

    def _ready(self) -> replies.Ready:
        return replies.Ready(self._stream.sample_rate, self._stream.in_step)

    def _record(self) -> None:
        """Serve and read in turn.

        Raises:
            _Ended: the measuring program wants no more, or died.
        """
        while True:
            self._serve_all()
            self._take()
            self._report()

    def _take(self) -> None:
        try:
            self._news.add(self._stream.take())
        except (JointbenchError, OSError) as error:
            self._failure = error

    def _serve_all(self) -> None:
        """Serve what was requested; wait where nothing may be read without a request.

        Raises:
            _Ended: see `_record`.
        """
        while self._later or self._must_wait() or self._link.poll():
            self._serve(self._later.popleft() if self._later else self._receive())

    def _must_wait(self) -> bool:
        if self._file is None or self._paused or self._failure or self._terminated:
            return True
        return self._stream.complete or (self._stream.in_step and not self._asked)

    def _receive(self) -> Request:
        try:
            request: Request = self._link.recv()
        except (EOFError, OSError):
            self._over = True
            raise _Ended from None
        if isinstance(request, Stop):
            self._stop, self._over = request, True
            raise _Ended
        return request

    def _sleep(self, seconds: float) -> None:
        """Wait for a lost device; serve meanwhile what does not change the stream.

        Raises:
            _Ended: see `_record`.
        """
        if self._over:
            raise _Ended
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
                self._stream.log(request.entry)
        else:
            try:
                self._send(self._carry_out(request))
            except JointbenchError as error:
                self._send(replies.Failed(error))

    def _carry_out(self, request: Request) -> Reply:
        stream = self._stream
        if isinstance(request, CreateFile):
            stream.create(request)
            self._file = request
            return replies.Done()
        if request is Ask.OPEN_LOOPS:
            return replies.Done(stream.open_loops())
        if request is Ask.RESUME:
            stream.resume()
            self._paused = False
            return replies.Done()
        self._take_rest()
        if isinstance(request, ChangeSetup):
            self._note(stream.change(request.setup))
            self._paused = False
            return self._ready()
        if isinstance(request, TriggerBy):
            self._note(stream.trigger_by(request.trigger))
        else:
            self._paused = True
            self._note(stream.pause())
        return replies.Done(stream.stored)

    def _note(self, gap: StreamGap | None) -> None:
        if gap is not None:
            self._news.add(gap)

    def _report(self) -> None:
        """Answer the measuring program, if it asked and there is something to say."""
        if not self._asked:
            return
        complete = self._stream.complete
        if self._news or self._terminated or complete:
            self._asked = False
            counters = self._stream.counters
            self._send(
                replies.News(self._news.take(), counters, self._terminated, complete)
            )
        elif self._failure is not None:
            self._asked = False
            self._send(replies.Failed(self._failure))

    def _end(self) -> None:
        """Store the rest, close the account and the file; finish it in a dead end."""
        failure: Exception | None = None
        with suppress(_Ended):
            self._take_rest()
        self._note(self._stream.settle())
        try:
            self._close_file(interrupted=self._stop is None or self._stop.interrupted)
        except JointbenchError as error:
            failure = error
        if self._stop is not None:
            items = self._news.take()
            gaps = tuple(item for item in items if isinstance(item, StreamGap))
            self._send(replies.Closed(self._stream.counters, gaps, failure))
        elif self._file is not None and self._file.finish:
            with suppress(JointbenchError):
                finish_live(self._file.path, self._file.path, overwrite=True)

    def _take_rest(self) -> None:
        """Store what the device had made when the end, or a pause, was requested.

        A request is served between two blocks of one read, which may hold seconds.

        Raises:
            _Ended: see `_record`.
        """
        until = time.monotonic() + _REST
        while not self._must_wait() and self._stream.lags():
            if time.monotonic() > until:
                return
            self._take()

    def _close_file(self, *, interrupted: bool) -> None:
        live = self._stream.live
        if live is None:
            return
        end: dict[str, Any] = {"kind": "end", "interrupted": interrupted}
        if self._stop is None:
            end["reason"] = "the measuring program ended without a message"
        try:
            self._stream.log_account()
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
