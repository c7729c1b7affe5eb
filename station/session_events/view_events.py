# SPDX-License-Identifier: MIT
"""Events that hold what a view shows: the plan, and the average after each hit."""

from dataclasses import dataclass, field
from typing import Any, ClassVar


@dataclass(frozen=True, slots=True)
class SessionBegun:
    """What is known before the first sample.

    Attributes:
        operator: name, empty if not given.
        source: URL of the chassis.
        simulated: whether it is a simulation.
        sample_rate: [Hz].
        direction: in which the hammer strikes, ``"+z"`` and the like.
        repeats: good hits that a condition needs.
        channels: name and full scale [SI unit] of each, in the order of the samples.
        conditions: name, point, torque [N m] and level [N] of each, in the order of
            the plan.
    """

    kind: ClassVar[str] = "session"
    operator: str
    source: str
    simulated: bool
    sample_rate: float
    direction: str
    repeats: int
    channels: list[dict[str, Any]] = field(default_factory=list)
    conditions: list[dict[str, Any]] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class HitAveraged:
    """The average of a condition after a hit, drawn small.

    Attributes:
        hit: number of the hit, from 0.
        good: accepted hits of the condition so far.
        wanted: accepted hits that the condition needs.
        trial: whether it was a trial hit, which is not averaged.
        pulse: force at equal steps [N].
        pulse_time: duration of the pulse that is drawn [s].
        band: lowest and highest frequency of the FRF [Hz]; empty without one.
        frf: magnitude of each response at equal steps of frequency [dB].
        phase: of each response where its magnitude is largest within each step [deg].
        coherence: of each response, the lowest within each step [-].
        mean_coherence: over band and responses [-], None with fewer than two hits.
    """

    kind: ClassVar[str] = "average"
    hit: int
    good: int
    wanted: int
    trial: bool
    pulse: list[float]
    pulse_time: float
    band: list[float] = field(default_factory=list)
    frf: dict[str, list[float]] = field(default_factory=dict)
    coherence: dict[str, list[float]] = field(default_factory=dict)
    mean_coherence: float | None = None
    phase: dict[str, list[float]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class BoltAsked:
    """The operator is asked to tighten a bolt.

    Attributes:
        bolt: number of the bolt, from 1.
        bolts: how many there are.
        target: [N m].
    """

    kind: ClassVar[str] = "tighten"
    bolt: int
    bolts: int
    target: float


@dataclass(frozen=True, slots=True)
class FileFinishing:
    """The file of a recording that has ended becomes a finished session.

    It comes after the end of the log, so it is shown and not stored.

    Attributes:
        share: of the samples that are written [-].
    """

    kind: ClassVar[str] = "finishing"
    share: float
