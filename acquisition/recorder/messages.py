# SPDX-License-Identifier: MIT
"""Messages between a measuring program and its recording process.

The program sends one request at a time and waits for its reply; only `Log` has none,
and `Stop` may be sent while a reply is due. Samples never travel: they are read from
the session file.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from jointbench.acquisition.ni.sensors import Sensor
from jointbench.acquisition.ni.stream import Counters, HardwareTrigger, StreamGap
from jointbench.acquisition.ni.stream_records import StreamSettings, Waiting
from jointbench.acquisition.session_file.live_read import LiveSpan

Item = LiveSpan | StreamGap | Waiting
"""Stored samples, missing samples, or time without samples."""


@dataclass(frozen=True, slots=True)
class Setup:
    """What a recording process streams.

    Attributes:
        address: ``host:port`` of a device server, None for the driver of this computer.
        sensors: the channel table.
        settings: of the stream.
    """

    address: str | None
    sensors: tuple[Sensor, ...]
    settings: StreamSettings


@dataclass(frozen=True, slots=True)
class Begin:
    """Create the session file and store what arrives.

    Attributes:
        path: of a new file.
        meta: data known before the first sample, as JSON types.
    """

    path: Path
    meta: Mapping[str, object]


@dataclass(frozen=True, slots=True)
class Log:
    """Add an entry to the log of the file; without a reply."""

    entry: Mapping[str, object]


@dataclass(frozen=True, slots=True)
class Next:
    """Reply with `News` as soon as there are any."""


@dataclass(frozen=True, slots=True)
class Pause:
    """Stop the stream on purpose; the reply is the number of samples stored."""


@dataclass(frozen=True, slots=True)
class Resume:
    """Start the paused stream as soon as the device is available."""


@dataclass(frozen=True, slots=True)
class TriggerBy:
    """Let the device detect hits; the reply is the number of samples stored."""

    trigger: HardwareTrigger


@dataclass(frozen=True, slots=True)
class OpenLoops:
    """Reply with the channels whose cable or sensor is disconnected."""


@dataclass(frozen=True, slots=True)
class Stop:
    """End the recording and close the file; the reply is `Stopped`.

    Attributes:
        interrupted: whether it ends before its time, for the log.
    """

    interrupted: bool


Request = Begin | Log | Next | Pause | Resume | TriggerBy | OpenLoops | Stop


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
    """

    items: tuple[Item, ...]
    counters: Counters
    interrupted: bool = False


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
class Stopped:
    """The recording has ended and its file is closed.

    Attributes:
        counters: of the stream, final.
        error: of the disk while the file was closed, if any.
    """

    counters: Counters
    error: Exception | None = None


Reply = Ready | News | Done | Failed | Stopped
