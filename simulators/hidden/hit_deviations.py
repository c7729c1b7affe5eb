# SPDX-License-Identifier: MIT
"""How single hits deviate: gains of each channel, timing, bad hits, correlation."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import UsageError


@dataclass(frozen=True, slots=True)
class ScatterWays:
    """Ways in which hits scatter beyond strength and joint stiffness.

    Attributes:
        channel: sd of the gain of each channel in each hit [-], as aim and tilt of a
            hammer cause it.
        delay: sd of the time between force and accelerations in each hit [s].
        tail: degrees of freedom of Student's t that the draws follow; 0 for normal.
        memory: correlation between successive hits [-].
        bad: deviation of the gain of one hit [-], drawn among all; 0 for none.
    """

    channel: float = 0.0
    delay: float = 0.0
    tail: float = 0.0
    memory: float = 0.0
    bad: float = 0.0

    def __post_init__(self) -> None:
        """Refuse values out of range."""
        limits = {
            "channel": 0.1,
            "delay": 1e-4,
            "tail": 1e3,
            "memory": 0.99,
            "bad": 0.9,
        }
        for name, largest in limits.items():
            value = getattr(self, name)
            if not 0.0 <= value <= largest:
                raise UsageError(
                    f"scatter {name} is {value!r}; give 0 to {largest:g} (0: none)"
                )


@dataclass(frozen=True, slots=True, eq=False)
class HitDeviations:
    """Deviation of each hit.

    Attributes:
        gain: of each channel over its true one [-], shape (n_hits, 2).
        delay: of the recorded force [s], shape (n_hits,).
    """

    gain: FloatArray
    delay: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "gain", "delay")


def draw_deviations(seed: int, hits: int, ways: ScatterWays) -> HitDeviations:
    """Draw how each hit deviates.

    Args:
        seed: of the draw.
        hits: number of hits, in their order.
        ways: kinds and sizes of the scatter.

    Source:
        Correlated draws: first-order autoregression, Box and Jenkins 1976, sec. 3.2.
    """
    rng = np.random.default_rng([seed, 14])
    drawn = rng.standard_normal((hits, 3))
    if ways.tail > 0.0:
        drawn *= np.sqrt(ways.tail / rng.chisquare(ways.tail, drawn.shape))
    fresh = np.sqrt(1.0 - ways.memory**2)
    for i in range(1, hits):
        drawn[i] = ways.memory * drawn[i - 1] + fresh * drawn[i]
    gain = 1.0 + ways.channel * drawn[:, :2]
    which, sign = int(rng.integers(hits)), float(rng.choice([-1.0, 1.0]))
    gain[which] += sign * ways.bad
    return HitDeviations(gain, ways.delay * drawn[:, 2])
