# SPDX-License-Identifier: MIT
"""Events of a session about its way through the plan, its recording and its end."""

from dataclasses import dataclass
from typing import ClassVar


@dataclass(frozen=True, slots=True)
class RunBegun:
    """A recording of its own begins: trial hits, or a condition.

    Attributes:
        name: of the recording.
        purpose: ``"trial"`` or ``"measurement"`` of hits, ``"pause"``; ``"operating"``,
            ``"shaker"`` or ``"plain"`` for a timed run.
        point: to strike.
        torque: on each bolt [N m], None if not given.
        preload: [N], None if not given.
        level: peak force to aim at [N], None for any.
        duration: of a timed run [s], None for others.
    """

    kind: ClassVar[str] = "run"
    name: str
    purpose: str
    point: str
    torque: float | None = None
    preload: float | None = None
    level: float | None = None
    duration: float | None = None


@dataclass(frozen=True, slots=True)
class Asked:
    """The operator is asked for hits.

    Attributes:
        name: of the condition.
        point: to strike.
        done: conditions that are over.
        planned: conditions of the plan.
    """

    kind: ClassVar[str] = "ask"
    name: str
    point: str
    done: int
    planned: int


@dataclass(frozen=True, slots=True)
class ConditionDone:
    """A condition is over.

    Attributes:
        name: of the condition.
        given_up: whether it is incomplete.
    """

    kind: ClassVar[str] = "condition"
    name: str
    given_up: bool


@dataclass(frozen=True, slots=True)
class Said:
    """A message to the operator.

    Attributes:
        words: one line.
    """

    kind: ClassVar[str] = "message"
    words: str


@dataclass(frozen=True, slots=True)
class Warned:
    """A warning; it stays in the session.

    Attributes:
        words: one line.
    """

    kind: ClassVar[str] = "warning"
    words: str


@dataclass(frozen=True, slots=True)
class CableChanged:
    """Sensors were disconnected, or all are connected again.

    Attributes:
        channels: names, or words that all are closed.
    """

    kind: ClassVar[str] = "cable"
    channels: str


@dataclass(frozen=True, slots=True)
class SamplesMissing:
    """Samples are missing between two blocks, as the recording process states it.

    Attributes:
        what: as in `StreamGap`.
        segment: number of the segment that ends or continues.
        first_sample: index of the first sample that is missing in it.
        samples: number known to be missing.
        seconds: duration without samples [s].
        words: message of the driver.
    """

    kind: ClassVar[str] = "gap"
    what: str
    segment: int
    first_sample: int
    samples: int
    seconds: float
    words: str


@dataclass(frozen=True, slots=True)
class SessionEnded:
    """The recording has ended.

    Attributes:
        interrupted: whether it ended before its time.
        reason: why, empty if not given.
    """

    kind: ClassVar[str] = "end"
    interrupted: bool
    reason: str = ""
