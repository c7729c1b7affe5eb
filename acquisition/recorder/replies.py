# SPDX-License-Identifier: MIT
"""What a recording process replies to requests."""

from dataclasses import dataclass

from jointbench.acquisition.ni.stream_records import Counters, StreamGap, Waiting
from jointbench.acquisition.session_file.live_read import LiveSpan

Item = LiveSpan | StreamGap | Waiting
"""Stored samples, missing samples, or time without samples."""


@dataclass(frozen=True, slots=True)
class Ready:
    """The stream has started.

    Attributes:
        sample_rate: actual rate of the device [Hz].
        in_step: whether the device has no clock and waits for its reader, as a
            simulation does that runs as fast as it is read.
    """

    sample_rate: float
    in_step: bool


@dataclass(frozen=True, slots=True)
class News:
    """What was recorded since the news before.

    Attributes:
        items: in their order; spans that follow each other are joined.
        counters: of the stream.
        interrupted: whether a termination signal reached the recording process.
        complete: whether all samples that were wanted are stored.
    """

    items: tuple[Item, ...]
    counters: Counters
    interrupted: bool = False
    complete: bool = False


@dataclass(frozen=True, slots=True)
class Done:
    """A request was carried out.

    Attributes:
        value: of the reply; None where there is nothing to say.
    """

    value: object = None


@dataclass(frozen=True, slots=True)
class Failed:
    """A request, or the recording itself, failed.

    Attributes:
        error: raised again in the measuring program.
    """

    error: Exception


@dataclass(frozen=True, slots=True)
class Closed:
    """The recording has ended and its file is closed.

    Attributes:
        counters: of the stream, final.
        gaps: that were in no news.
        error: of the disk while the file was closed, if any.
    """

    counters: Counters
    gaps: tuple[StreamGap, ...] = ()
    error: Exception | None = None


Reply = Ready | News | Done | Failed | Closed
