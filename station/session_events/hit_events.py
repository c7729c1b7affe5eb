# SPDX-License-Identifier: MIT
"""Events of a session about hits, settings, checks and bolts."""

from dataclasses import dataclass, field
from typing import ClassVar


@dataclass(frozen=True, slots=True)
class HitJudged:
    """A hit with its first verdict.

    Attributes:
        number: of the hit, from 0.
        start: index of its first sample among those stored.
        trigger: index of the sample at its edge.
        stop: index one past its last sample.
        point: that was struck.
        peak_force: [N].
        verdict: as in `Verdict`.
        measure: number that the verdict rests on.
        reason: one line.
        temperature: mean over the hit [degC], None where none is measured.
    """

    kind: ClassVar[str] = "hit"
    number: int
    start: int
    trigger: int
    stop: int
    point: str
    peak_force: float
    verdict: str
    measure: float
    reason: str
    temperature: float | None = None


@dataclass(frozen=True, slots=True)
class VerdictChanged(HitJudged):
    """A later verdict on a hit; the latest one counts."""

    kind: ClassVar[str] = "verdict"


@dataclass(frozen=True, slots=True)
class GainForecast:
    """What further hits at a condition would buy, after a hit.

    Attributes:
        hit: number of the hit, from 0.
        more: number of further hits.
        peaks: of each resonance ``frequency`` [Hz] and ``damping`` (ratio) [-], their
            standard deviations now, ``frequency_sd`` [Hz] and ``damping_sd`` (relative)
            [-], and those with the further hits, ``frequency_sd_after`` and
            ``damping_sd_after``.
    """

    kind: ClassVar[str] = "gain"
    hit: int
    more: int
    peaks: list[dict[str, float]] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class SettingProposed:
    """A setting that trial hits proposed.

    Attributes:
        name: with its unit.
        value: in that unit.
        reason: one line.
    """

    kind: ClassVar[str] = "setting"
    name: str
    value: float
    reason: str


@dataclass(frozen=True, slots=True)
class CheckDone:
    """A check on the part: a driving point or reciprocity.

    Attributes:
        name: of the check.
        value: found [-].
        limit: of a good value [-].
        passed: whether it is good.
    """

    kind: ClassVar[str] = "check"
    name: str
    value: float
    limit: float
    passed: bool


@dataclass(frozen=True, slots=True)
class BoltRead:
    """A reading of the torque tester.

    Attributes:
        bolt: number of the bolt, from 1.
        target: asked for [N m].
        torque: read [N m].
        kept: whether the reading counts.
        raw: answer of the tester.
    """

    kind: ClassVar[str] = "bolt"
    bolt: int
    target: float
    torque: float
    kept: bool
    raw: str


@dataclass(frozen=True, slots=True)
class PreloadRead:
    """The preload of the joint by the bolts whose force is measured, at a condition.

    Attributes:
        name: of the condition.
        torque: on each bolt [N m], None if not given.
        preload: of all bolts together [N].
        preload_sd: its standard uncertainty [N].
        bolts: of each measured bolt its number ``bolt``, ``force`` and ``force_sd``
            [N], and ``way``, ``"load washer"`` or ``"elongation"``.
    """

    kind: ClassVar[str] = "preload"
    name: str
    torque: float | None
    preload: float
    preload_sd: float
    bolts: list[dict[str, object]] = field(default_factory=list)
