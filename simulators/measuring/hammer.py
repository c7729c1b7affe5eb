# SPDX-License-Identifier: MIT
"""A simulated hammer: pulses that scatter, bounce and are sometimes too strong."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.recordings import Verdict


@dataclass(frozen=True, slots=True)
class Pulse:
    """One contact between hammer tip and structure.

    Attributes:
        start: of the contact [s].
        width: duration of the contact [s].
        peak: largest force [N].
        exponent: 1 is a half sine; more rounds the foot of the pulse [-].
        skew: 0 is symmetric, a positive one rises slower than it falls [-].
    """

    start: float
    width: float
    peak: float
    exponent: float = 1.5
    skew: float = 0.0


@dataclass(frozen=True, slots=True)
class Hammer:
    """Parameters of the simulated hammer hits.

    Attributes:
        level: usual peak force [N].
        level_scatter: relative standard deviation of the peak [-].
        width: usual contact time [s].
        width_scatter: relative standard deviation of the contact time [-].
        interval: usual time between hits [s].
        interval_scatter: relative standard deviation of that time [-].
        point_scatter: relative standard deviation of the force that acts along the
            measured direction, because point and direction vary a little [-].
        double_rate: share of hits in which the hammer bounces [-].
        overload_rate: share of hits that are too strong for the force channel [-].
        overload_level: full scale of the force channel [N].
    """

    level: float = 300.0
    level_scatter: float = 0.15
    width: float = 0.8e-3
    width_scatter: float = 0.06
    interval: float = 1.5
    interval_scatter: float = 0.1
    point_scatter: float = 5e-4
    double_rate: float = 0.1
    overload_rate: float = 0.1
    overload_level: float = 1000.0

    def __post_init__(self) -> None:
        """Refuse rates outside 0..1 and sizes that are not positive."""
        for name in ("level", "width", "interval", "overload_level"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0):
                raise UsageError(f"hammer {name} is {value!r}, it must be positive")
        for name in ("double_rate", "overload_rate"):
            value = getattr(self, name)
            if not 0 <= value <= 1:
                raise UsageError(f"hammer {name} is {value!r}, it must be in 0..1")
        if self.double_rate + self.overload_rate > 1:
            raise UsageError(
                "double_rate and overload_rate together exceed 1; lower one of them"
            )


@dataclass(frozen=True, slots=True)
class SimulatedHit:
    """One hammer hit, with its verdict.

    Attributes:
        pulses: the first contact, then the bounces.
        effectiveness: acting over measured force [-].
        verdict: `OK`, `DOUBLE` or `OVERLOAD`, by the truth.
    """

    pulses: tuple[Pulse, ...]
    effectiveness: float
    verdict: Verdict

    @property
    def start(self) -> float:
        """First contact [s]."""
        return self.pulses[0].start

    @property
    def peak_force(self) -> float:
        """Largest force before any clipping [N]."""
        return max(pulse.peak for pulse in self.pulses)


def swing(hammer: Hammer, *, hits: int, seed: int) -> tuple[SimulatedHit, ...]:
    """Simulate a number of hits.

    Args:
        hammer: parameters of the hits.
        hits: number of hits.
        seed: of the scatter; the first n hits do not depend on `hits`.

    Returns:
        The hits in order of time, the first half an interval after zero.
    """
    rng = np.random.default_rng([seed, 1])
    now = 0.5 * hammer.interval
    swings: list[SimulatedHit] = []
    for _ in range(hits):
        swings.append(_one_swing(hammer, now, rng))
        stretch = 1 + hammer.interval_scatter * rng.standard_normal()
        now += hammer.interval * float(np.clip(stretch, 0.6, 1.6))
    return tuple(swings)


def _one_swing(hammer: Hammer, now: float, rng: np.random.Generator) -> SimulatedHit:
    """Draw one hit; the number of draws is fixed, so hits stay independent."""
    scatter = np.clip(rng.standard_normal(3), -2.5, 2.5)
    exponent, skew, fate, strength, bounce, late = rng.uniform(size=6).tolist()
    verdict = _fate(hammer, fate)
    if verdict is Verdict.OVERLOAD:
        peak = hammer.overload_level * (1.15 + 0.85 * strength)
    else:
        peak = hammer.level * float(np.exp(hammer.level_scatter * scatter[0]))
    first = Pulse(
        start=now,
        width=hammer.width * float(np.exp(hammer.width_scatter * scatter[1])),
        peak=peak,
        exponent=1.3 + 0.6 * exponent,
        skew=0.16 * (skew - 0.5),
    )
    pulses: tuple[Pulse, ...] = (first,)
    if verdict is Verdict.DOUBLE:
        # A light hammer comes back after 8 to 40 ms with part of its speed.
        again = Pulse(
            start=now + 8e-3 + 32e-3 * late,
            width=1.1 * first.width,
            peak=first.peak * (0.15 + 0.5 * bounce),
            exponent=first.exponent,
            skew=first.skew,
        )
        pulses = (first, again)
    effectiveness = 1 + hammer.point_scatter * float(scatter[2])
    return SimulatedHit(pulses, effectiveness, verdict)


def _fate(hammer: Hammer, fate: float) -> Verdict:
    if fate < hammer.double_rate:
        return Verdict.DOUBLE
    if fate < hammer.double_rate + hammer.overload_rate:
        return Verdict.OVERLOAD
    return Verdict.OK


def pulse_force(pulses: Sequence[Pulse], time: FloatArray) -> FloatArray:
    """Return the force of some pulses at ascending times [s], in N, same shape."""
    force = np.zeros_like(time)
    for pulse in pulses:
        first, last = np.searchsorted(time, (pulse.start, pulse.start + pulse.width))
        phase = (time[first:last] - pulse.start) / pulse.width
        # A power of the phase skews the pulse and keeps its foot and its height.
        warped = phase ** np.exp(pulse.skew)
        force[first:last] += pulse.peak * np.sin(np.pi * warped) ** pulse.exponent
    return force
