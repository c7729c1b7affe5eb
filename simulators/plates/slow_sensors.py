# SPDX-License-Identifier: MIT
"""Load washers under the bolts of the plates, and a thermometer at the joint.

What the bolts really have is drawn, and stated to no reader: each bolt has a friction
of its own, drawn again every time it is tightened, and relaxes from then on; each
washer deviates from its data sheet; the joint warms up slowly.
"""

from dataclasses import dataclass, field

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray

FORCE_PER_VOLT = 20e3
"""Of a load washer with its amplifier, by the data sheet [N/V]."""
VOLTS_PER_DEGREE = 10e-3
"""Of the thermometer [V/degC]."""
_DIAMETER = 16e-3  # of the bolts [m]
_NUT_FACTOR, _NUT_SD = 0.21, 0.02
_SCALE_SD = 0.01  # of a washer against its data sheet [-]
_RELAXATION = 0.01  # share of the force lost in each decade of time [-]
_FIRST = 60.0  # [s] from which relaxation counts its decades
_START, _WARMING = 21.0, 1.5  # [degC], [K] that the joint warms up by in the end
_SLOW = 1800.0  # [s] of the warming
_FORCE_NOISE, _TEMPERATURE_NOISE = 2e-4, 5e-4  # [V]


@dataclass(slots=True)
class SlowSensors:
    """Sensors of what changes slowly, at the inputs after those of the hits.

    Attributes:
        washers: how many bolts have one.
        thermometer: whether there is one.
        seed: of all draws.
    """

    washers: int
    thermometer: bool
    seed: int
    _tightened: int = 0
    _torque: float = 0.0
    _since: float = 0.0
    _friction: FloatArray = field(default_factory=lambda: np.zeros(0))

    @property
    def inputs(self) -> int:
        """Number of inputs they take."""
        return self.washers + self.thermometer

    def tighten(self, torque: float, time: float) -> None:
        """Tighten all bolts to a torque [N m] at a time [s], unless they have it."""
        if torque == self._torque:
            return
        self._tightened += 1
        self._torque, self._since = torque, time
        rng = np.random.default_rng([self.seed, 17, self._tightened])
        self._friction = rng.normal(_NUT_FACTOR, _NUT_SD, self.washers)

    def forces(self, time: float) -> FloatArray:
        """Return the true force of each bolt with a washer [N], shape (washers,)."""
        age = max(time - self._since, 0.0)
        left = 1.0 - _RELAXATION * np.log10(1.0 + age / _FIRST)
        return np.asarray(self._torque * left / (self._friction * _DIAMETER))

    def temperature(self, time: float) -> float:
        """Return the true temperature of the joint [degC]."""
        return float(_START + _WARMING * -np.expm1(-max(time, 0.0) / _SLOW))

    def volts(self, time: float, count: int, piece: tuple[int, int]) -> FloatArray:
        """Return a piece of all inputs [V], shape (inputs, count).

        Args:
            time: of its first sample [s].
            count: of samples.
            piece: numbers of stream and piece, for the noise.
        """
        scale = np.random.default_rng([self.seed, 19]).normal(1, _SCALE_SD, 64)
        levels = list(scale[: self.washers] * self.forces(time) / FORCE_PER_VOLT)
        noises = [_FORCE_NOISE] * self.washers
        if self.thermometer:
            levels.append(VOLTS_PER_DEGREE * self.temperature(time))
            noises.append(_TEMPERATURE_NOISE)
        rng = np.random.default_rng([self.seed, 23, *piece])
        noise = rng.standard_normal((self.inputs, count))
        return np.asarray(np.array(levels)[:, None] + np.array(noises)[:, None] * noise)
