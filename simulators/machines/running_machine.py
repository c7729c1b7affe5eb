# SPDX-License-Identifier: MIT
"""The machine while it runs or is shaken, with sensors of many kinds.

The motion is that of the continuous system under forces that are linear between fine
steps, which is exact; an anti-alias filter and the sample clock follow.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.recordings import Channel, Quantity
from jointbench.simulators.machines.machine_design import MachineDesign
from jointbench.simulators.machines.machine_forces import shaker_forces, spindle_forces
from jointbench.simulators.measuring.converter import AntiAlias, decimate

_GRAVITY = 9.80665  # [m/s^2]
_PIECE = 4096  # samples
_NAMES = ("bed", "column", "headstock", "spindle")
_NOISE = (0.01, *[2e-4] * 4, 2e-3, 5e-4, 2e-2, 1e-6, 2e-9, 1e-9)
"""Of each channel, in its unit."""


@dataclass(frozen=True, slots=True)
class RunningMachine:
    """A source of samples: the machine with what is plugged into the chassis.

    Attributes:
        sample_rate: [Hz].
        shaker: signal of the shaker, ``"random"`` or ``"sweep"``; None for an operating
            run.
        rpm: speed of the spindle in an operating run [1/min].
        seed: of forces and noise.
        design: masses, springs and dampers.
    """

    sample_rate: float = 2048.0
    shaker: str | None = None
    rpm: float = 3000.0
    seed: int = 1
    design: MachineDesign = field(default_factory=MachineDesign)

    @property
    def name(self) -> str:
        """Of the source."""
        return "sim:spindle" if self.shaker is None else "sim:shaker"

    @property
    def simulated(self) -> bool:
        """True: it is a simulation."""
        return True

    @property
    def channels(self) -> tuple[Channel, ...]:
        """Of the sensors by input, the load cell of the shaker first."""
        return (
            _channel("force", Quantity.FORCE, 11.2e-3, 400.0),
            *(
                _channel(n, Quantity.ACCELERATION, 0.1 / _GRAVITY, 450.0)
                for n in _NAMES
            ),
            _channel("microphone", Quantity.PRESSURE, 50e-3, 90.0),
            _channel("tacho", Quantity.TACHO, 1.0, 5.0),
            _channel("air", Quantity.TEMPERATURE, 10e-3, 100.0),
            _channel("vibrometer", Quantity.VELOCITY, 100.0, 0.05),
            _channel("gap", Quantity.DISPLACEMENT, 1e4, 5e-4),
            _channel("gauge", Quantity.STRAIN, 1e4, 5e-4),
        )

    def blocks(self) -> Iterator[FloatArray]:
        """Yield samples without end, SI units, shape (n_channels, n)."""
        rng = np.random.default_rng([self.seed, 73])
        noise = np.array(_NOISE)[:, None]
        filter_ = AntiAlias()
        first = 0
        for block in decimate(self._signals(filter_.oversampling), filter_):
            samples = block + noise * rng.standard_normal(block.shape)
            samples[6] += self._pulses(first, block.shape[1])
            samples[7] += 21.0 + 0.3 * np.sin(
                2 * np.pi * (first + np.arange(block.shape[1])) / self.sample_rate / 900
            )
            first += block.shape[1]
            yield samples

    def _signals(self, oversampling: int) -> Iterator[FloatArray]:
        """Yield what the sensors see, in fine steps; tacho and temperature are zero."""
        rate, count = oversampling * self.sample_rate, oversampling * _PIECE
        forces = (
            spindle_forces(count, rate, seed=self.seed, rpm=self.rpm)
            if self.shaker is None
            else shaker_forces(count, rate, seed=self.seed, signal=self.shaker)
        )
        motion = _Motion(self.design, rate)
        for force, measured in _measured(forces):
            place, speed, push = motion.piece(force, measured)
            zero = np.zeros((1, push.shape[1]))
            load = measured[2:3] if self.shaker is not None else zero
            sound = 0.05 * push[3:] + 0.01 * push[1:2]
            stretch = (place[1:2] - place[:1]) / 0.8
            yield np.concatenate(
                (load, push, sound, zero, zero, speed[3:], place[1:2], stretch)
            )

    def _pulses(self, first: int, count: int) -> FloatArray:
        """Return the pulses of the tacho [V]: a tenth of each turn is high."""
        turns = self.rpm / 60 * (first + np.arange(count)) / self.sample_rate
        return np.where(turns % 1.0 < 0.1, 4.0, 0.0)


def _measured(
    forces: Iterator[FloatArray],
) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Yield each piece of the forces, and the samples that a load cell has of it.

    Lines between samples have less at high frequencies than the samples themselves,
    by sinc^2 of frequency over rate. A load cell measures the lines.
    """
    force, before = next(forces), None
    for following in forces:
        before = np.zeros_like(force[:, :1]) if before is None else before
        longer = np.concatenate((before, force, following[:, :1]), axis=1)
        yield force, (longer[:, :-2] + 10 * longer[:, 1:-1] + longer[:, 2:]) / 12
        force, before = following, force[:, -1:]


class _Motion:
    """Motion of the masses under forces that are linear between steps."""

    def __init__(self, design: MachineDesign, rate: float) -> None:
        mass, damping, stiffness = design.matrices()
        self._mass, self._damping, self._stiffness = mass, damping, stiffness
        count = len(mass)
        system = np.zeros((2 * count, 2 * count))
        system[:count, count:] = np.eye(count)
        system[count:, :count] = -np.linalg.solve(mass, stiffness)
        system[count:, count:] = -np.linalg.solve(mass, damping)
        drive = np.zeros((2 * count, count))
        drive[count:] = np.linalg.inv(mass)
        roots, self._vectors = np.linalg.eig(system)
        self._into = np.linalg.solve(self._vectors, drive.astype(complex))
        step = roots / rate
        self._decay = np.exp(step)
        # Integrals of exp(root (T - t)) over a step, with t/T and with 1 - t/T.
        all_of_it = np.expm1(step) / roots
        late = (np.expm1(step) - step) / (roots * step)
        self._weights = all_of_it - late, late
        self._state = np.zeros(2 * count, complex)
        self._last = np.zeros((count, 1))

    def piece(
        self, force: FloatArray, measured: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return displacement, velocity and acceleration of the masses, (4, n) each.

        Args:
            force: at the ends of the steps, linear between them.
            measured: samples of it, which the acceleration follows at once.
        """
        from scipy.signal import lfilter

        before = np.concatenate((self._last, force[:, :-1]), axis=1)
        self._last = force[:, -1:]
        early, late = self._weights
        driven = early[:, None] * (self._into @ before)
        driven += late[:, None] * (self._into @ force)
        states = np.empty_like(driven)
        for n, decay in enumerate(self._decay):
            states[n], _ = lfilter(
                [1.0], [1.0, -decay], driven[n], zi=[decay * self._state[n]]
            )
        self._state = states[:, -1].copy()
        motion = (self._vectors @ states).real
        count = len(self._mass)
        place, speed = motion[:count], motion[count:]
        rest = measured - self._damping @ speed - self._stiffness @ place
        return place, speed, np.linalg.solve(self._mass, rest)


def _channel(name: str, quantity: Quantity, sensitivity: float, full: float) -> Channel:
    return Channel(name, quantity, sensitivity=sensitivity, range=full)
