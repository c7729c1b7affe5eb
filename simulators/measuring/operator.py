# SPDX-License-Identifier: MIT
"""The operator of the simulated bench, who strikes on request or unrequested.

Every stroke has its own random stream, so that the same requests give the same strokes.
"""

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.measuring.hammer import Pulse


class Fate(StrEnum):
    """Outcome of a stroke."""

    GOOD = "good"
    DOUBLE = "double"
    OVERLOAD = "overload"
    WEAK = "weak"


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulatedOperator:
    """Parameters of the simulated operator.

    Attributes:
        seed: of the scatter.
        width: contact time [s].
        level: default peak force [N].
        level_scatter: relative scatter of the peak force [-].
        reaction: time from a request to the stroke [s].
        interval: between unrequested strokes [s]; None waits for requests.
        overload_force: peak force of a stroke that is too strong [N].
        weak_share: peak force of a weak stroke over the requested one [-].
        fates: of the strokes in turn, repeated from the first.
    """

    seed: int = 1
    width: float = 0.45e-3
    level: float = 150.0
    level_scatter: float = 0.1
    reaction: float = 0.25
    interval: float | None = None
    overload_force: float = 4000.0
    weak_share: float = 0.12
    fates: tuple[Fate, ...] = field(default=(Fate.GOOD,))

    def __post_init__(self) -> None:
        """Refuse parameters out of range."""
        for name in ("width", "level", "reaction", "overload_force"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0):
                raise UsageError(f"{name} is {value!r}; give one above zero")
        if self.interval is not None and not self.interval > 0:
            raise UsageError(f"interval is {self.interval!r} s; give one above zero")
        if not self.fates:
            raise UsageError(
                "fates is empty; leave it out, or name at least one stroke"
            )


def swing_once(
    operator: SimulatedOperator,
    *,
    number: int,
    after: float,
    level: float | None = None,
) -> tuple[tuple[Pulse, ...], Fate]:
    """Return the pulses of one stroke.

    Args:
        operator: its parameters.
        number: of the stroke since the bench was set up, from 0.
        after: time of the request, or when the operator is free again [s].
        level: requested peak force [N]; None for the default.

    Returns:
        Its pulses and its outcome.
    """
    rng = np.random.default_rng([operator.seed, 11, number])
    draws, uniform = np.clip(rng.standard_normal(2), -2.5, 2.5), rng.uniform(size=5)
    fate = operator.fates[number % len(operator.fates)]
    peak = (level or operator.level) * float(np.exp(operator.level_scatter * draws[0]))
    if fate is Fate.OVERLOAD:
        peak = operator.overload_force * (1 + 0.5 * float(uniform[0]))
    elif fate is Fate.WEAK:
        peak *= operator.weak_share
    first = Pulse(
        start=after + operator.reaction * (1 + 0.4 * float(uniform[1])),
        width=operator.width * float(np.exp(0.05 * draws[1])),
        peak=peak,
        exponent=1.8 + 0.4 * float(uniform[2]),
    )
    if fate is not Fate.DOUBLE:
        return (first,), fate
    again = Pulse(
        start=first.start + 8e-3 + 22e-3 * float(uniform[3]),
        width=1.1 * first.width,
        peak=peak * (0.15 + 0.4 * float(uniform[4])),
        exponent=first.exponent,
    )
    return (first, again), fate
