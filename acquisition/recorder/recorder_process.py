# SPDX-License-Identifier: MIT
"""A recording in a process of its own, as the measuring program sees it.

The process reads the device and writes the session file. This side follows: it reads
stored samples back from the file, so that it judges what was stored, and it may be late
or die without a sample lost.
"""

import multiprocessing
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from multiprocessing.context import BaseContext
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.clean_process import without_main
from jointbench.acquisition.basics.errors import InstrumentError
from jointbench.acquisition.ni.stream_records import (
    Block,
    Counters,
    HardwareTrigger,
    StreamGap,
    Waiting,
)
from jointbench.acquisition.recorder.recorder import run_recorder
from jointbench.acquisition.recorder.replies import (
    Closed,
    Done,
    Failed,
    Item,
    News,
    Ready,
    Reply,
)
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
from jointbench.acquisition.recorder.stored_blocks import StoredBlocks
from jointbench.acquisition.session_file.live_read import LiveSpan

_IDLE = 0.1  # [s] without news after which the caller may look at its keyboard
_LAST_WORD = 30.0  # [s] in which a recording closes its file; it takes milliseconds


class RecorderProcess:
    """One recording; a context manager that ends it.

    Attributes:
        setup: what is streamed.
        sample_rate: actual rate of the device [Hz].
        counters: of the stream, as reported last.
        gaps: all that were reported, passed on or not; once the recording is stopped,
            their samples are those that `counters` calls lost.
        samples: stored samples per channel that were passed on, or skipped, so far.
        interrupted: whether the recording process received a termination signal.
        complete: whether all samples that the setup wants are stored.
    """

    def __init__(
        self, setup: Setup, *, given_up: Callable[[], bool] = lambda: False
    ) -> None:
        """Start the process and its stream.

        Args:
            setup: what is streamed.
            given_up: whether waiting for a reply is pointless by now.

        Raises:
            InstrumentError: the device refuses, or does not answer.
        """
        self.setup, self._given_up = setup, given_up
        self.counters, self.samples = Counters(), 0
        self.interrupted = self.complete = False
        self.gaps: list[StreamGap] = []
        self._blocks: StoredBlocks | None = None
        self._link, far = multiprocessing.Pipe()
        context = _context()
        self._process = context.Process(  # type: ignore[attr-defined]
            target=run_recorder, args=(far, setup), name="jointbench recorder"
        )
        with without_main():
            self._process.start()
        far.close()
        try:
            ready = self._reply()
        except BaseException:
            self._leave()
            raise
        assert isinstance(ready, Ready)
        self.sample_rate = ready.sample_rate

    def __enter__(self) -> "RecorderProcess":
        """Return the recording."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """End the recording if that was not done."""
        with suppress(InstrumentError):
            self.stop(interrupted=True)

    @property
    def process_id(self) -> int:
        """Number of the process in the system."""
        return int(self._process.pid)

    def begin(
        self, path: Path, meta: Mapping[str, object], *, finish: bool = True
    ) -> None:
        """Create the session file; from now on all samples are stored.

        Args:
            path: of a new file.
            meta: data known before the first sample, as JSON types.
            finish: whether the file becomes a finished session where this program dies;
                otherwise it remains a recording, to be recovered.

        Raises:
            UsageError: the file is there, or cannot be written.
            InstrumentError: it cannot be read back.
        """
        self._ask(CreateFile(path, meta, finish))
        self._blocks = StoredBlocks(path, self.setup.settings.block)

    def items(self) -> Iterator[Block | StreamGap | Waiting]:
        """Yield what was recorded, in its order, and at times that nothing was.

        It ends once the recording is complete or interrupted.

        Raises:
            InstrumentError: the device or the disk refuses, or the process died.
        """
        for item in self._news():
            yield from self._passed(item)

    def follow(self) -> Iterator[int]:
        """Yield at times how many samples are stored; none of them is read back.

        It ends once the recording is complete or interrupted.

        Raises:
            InstrumentError: the device or the disk refuses, or the process died.
        """
        for item in self._news():
            if isinstance(item, LiveSpan):
                self.samples = item.past
            yield self.samples

    def change(self, setup: Setup) -> None:
        """Stream something else into the same file.

        Args:
            setup: of as many channels, at the same rate.

        Raises:
            InstrumentError: the device refuses, or does not answer.
        """
        self._send(ChangeSetup(setup))
        ready = self._reply()
        assert isinstance(ready, Ready)
        self.setup, self.sample_rate, self.complete = setup, ready.sample_rate, False

    def _news(self) -> Iterator[Item]:
        while not (self.interrupted or self.complete):
            self._send(Ask.NEXT)
            while not self._link.poll(_IDLE):
                yield Waiting(0)
            news = self._reply()
            assert isinstance(news, News)
            self._enter(news)
            yield from news.items

    def _enter(self, news: News) -> None:
        self.counters, self.interrupted = news.counters, news.interrupted
        self.complete = news.complete
        self.gaps += [item for item in news.items if isinstance(item, StreamGap)]

    def log(self, entry: Mapping[str, object]) -> None:
        """Add an entry to the log of the file.

        It is dated by the samples that were passed on, not by those stored: this side
        may be late.

        Raises:
            InstrumentError: the process died.
        """
        dated = {**entry, "stored": self.samples, "time": round(time.time(), 3)}
        self._send(Log(dated))

    def new_entries(self) -> tuple[dict[str, Any], ...]:
        """Return the entries of the log that reached the file since the last call.

        Raises:
            InstrumentError: the disk refuses.
        """
        return () if self._blocks is None else self._blocks.entries()

    def read_back(self, start: int, stop: int) -> FloatArray:
        """Return stored samples again, shape (n_channels, stop - start).

        Args:
            start: index of the first of them among those stored.
            stop: index one past the last one.

        Raises:
            InstrumentError: the disk refuses.
        """
        assert self._blocks is not None, "begin() comes first"
        parts = self._blocks.read(LiveSpan(0, start, start, stop - start))
        return np.hstack([part.samples for part in parts])

    def pause(self) -> None:
        """Stop the stream on purpose; samples that were not passed on are skipped."""
        self._skip(self._ask(Ask.PAUSE))

    def resume(self) -> None:
        """Start the stream as soon as the device is available.

        Raises:
            InstrumentError: the device refuses, or does not return in time.
        """
        self._ask(Ask.RESUME)

    def trigger_by(self, trigger: HardwareTrigger) -> None:
        """Detect hits on the device from now on.

        Raises:
            InstrumentError: it cannot, or does not return.
        """
        self._skip(self._ask(TriggerBy(trigger)))

    def open_loops(self) -> tuple[str, ...]:
        """Return the channels with a disconnected cable or sensor, if reported."""
        found = self._ask(Ask.OPEN_LOOPS)
        assert isinstance(found, tuple)
        return found

    def stop(self, *, interrupted: bool) -> None:
        """End the recording and close its file; nothing happens the second time.

        Args:
            interrupted: whether it ends before its time, for the log.

        Raises:
            InstrumentError: the disk refused something, or the process died.
        """
        if self._link.closed:
            return
        try:
            self._send(Stop(interrupted))
            last = self._last_word()
        finally:
            self._leave()
        self.counters = last.counters
        self.gaps += last.gaps
        if last.error is not None:
            raise last.error

    def _passed(self, item: Item) -> Iterator[Block | StreamGap | Waiting]:
        if not isinstance(item, LiveSpan):
            yield item
            return
        assert self._blocks is not None, "begin() comes first"
        kept = item.cut(max(item.stored, min(self.samples, item.past)), item.past)
        for block in self._blocks.read(kept):
            if self.samples > item.stored + block.first - item.first:
                continue  # the caller paused the stream meanwhile
            self.samples += block.samples.shape[1]
            yield block

    def _skip(self, stored: object) -> None:
        assert isinstance(stored, int)
        self.samples = stored

    def _ask(self, request: Request) -> object:
        self._send(request)
        reply = self._reply()
        assert isinstance(reply, Done)
        return reply.value

    def _send(self, request: Request) -> None:
        try:
            self._link.send(request)
        except OSError as error:
            raise self._died() from error

    def _reply(self) -> Reply:
        """Return the reply to the last request.

        Raises:
            KeyboardInterrupt: the caller gave up.
            JointbenchError: the request failed.
            InstrumentError: the process died.
        """
        while not self._link.poll(_IDLE):
            if self._given_up():
                raise KeyboardInterrupt
        try:
            reply: Reply = self._link.recv()
        except (EOFError, OSError) as error:
            raise self._died() from error
        if isinstance(reply, Failed):
            raise reply.error
        return reply

    def _last_word(self) -> Closed:
        """Return the reply to `Stop`; of replies that were due before, gaps count.

        Raises:
            InstrumentError: the process died, or does not answer.
        """
        until = time.monotonic() + _LAST_WORD
        while self._link.poll(max(0.0, until - time.monotonic())):
            try:
                reply = self._link.recv()
            except (EOFError, OSError) as error:
                raise self._died() from error
            if isinstance(reply, Closed):
                return reply
            if isinstance(reply, News):
                self._enter(reply)
        raise InstrumentError(
            f"the recording process has not closed its file within {_LAST_WORD:g} s; "
            "what was recorded is safe, `jointbench recover` finishes it"
        )

    def _leave(self) -> None:
        if self._blocks is not None:
            self._blocks.close()
        self._link.close()
        self._process.join(_LAST_WORD)

    def _died(self) -> InstrumentError:
        return InstrumentError(
            "the recording process has died; what was recorded until then is safe: "
            "measure the rest into another file"
        )


def _context() -> BaseContext:
    """Return how the process starts: from a server that has imported its modules."""
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([run_recorder.__module__])
    return context
