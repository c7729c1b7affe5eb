# SPDX-License-Identifier: MIT
"""Requests of a measuring program to its recording process.

The program sends one request at a time and waits for its reply; only `Log` has none,
and `Stop` may be sent while a reply is due. Samples never travel: they are read from
the session file.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

from jointbench.acquisition.ni.sensors import Sensor
from jointbench.acquisition.ni.stream_records import HardwareTrigger, StreamSettings


@dataclass(frozen=True, slots=True)
class Setup:
    """What a recording process streams.

    Attributes:
        address: ``host:port`` of a device server, None for the driver of this computer.
        sensors: the channel table.
        settings: of the stream.
        samples: per channel, after which the recording is complete; None for until it
            is stopped.
    """

    address: str | None
    sensors: tuple[Sensor, ...]
    settings: StreamSettings
    samples: int | None = None


@dataclass(frozen=True, slots=True)
class CreateFile:
    """Create the session file, and store what arrives.

    Attributes:
        path: of a new file.
        meta: data known before the first sample, as JSON types.
        finish: whether the recording process turns the file into a finished session
            where the program dies; otherwise it remains a recording, to be recovered.
    """

    path: Path
    meta: Mapping[str, object]
    finish: bool = True


@dataclass(frozen=True, slots=True)
class Log:
    """Add an entry to the log of the file; without a reply."""

    entry: Mapping[str, object]


class Ask(Enum):
    """Requests without an argument."""

    NEXT = "next"
    """Reply with `News` as soon as there are any."""
    PAUSE = "pause"
    """Store what the device has made by now and stop the stream on purpose; the reply
    is the number of samples stored."""
    RESUME = "resume"
    """Start the paused stream as soon as the device is available."""
    OPEN_LOOPS = "open loops"
    """Reply with the channels whose cable or sensor is disconnected."""


@dataclass(frozen=True, slots=True)
class TriggerBy:
    """Let the device detect hits; the reply is the number of samples stored."""

    trigger: HardwareTrigger


@dataclass(frozen=True, slots=True)
class ChangeSetup:
    """Stream something else into the same file; the reply is `Ready`.

    Attributes:
        setup: of as many channels, at the same rate.
    """

    setup: Setup


@dataclass(frozen=True, slots=True)
class Stop:
    """End the recording and close the file; the reply is `Closed`.

    Attributes:
        interrupted: whether it ends before its time, for the log.
    """

    interrupted: bool


Request = Ask | CreateFile | Log | TriggerBy | ChangeSetup | Stop
