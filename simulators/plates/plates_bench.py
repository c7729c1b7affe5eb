# SPDX-License-Identifier: MIT
"""The plates with operator, hammer and sensors: volts at the inputs of the chassis.

The assignment of sensors to inputs is fixed; the settings of the measuring program are
independent of it, as at a real bench.
"""

import threading
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.measuring.operator import Fate, SimulatedOperator, swing_once
from jointbench.simulators.mechanics.modal_response import Poles
from jointbench.simulators.plates.calibration_mass import CalibrationMass, mass_poles
from jointbench.simulators.plates.plates import POINTS, PlatesDesign, plates_poles
from jointbench.simulators.plates.plates_strike import Stroke, signal_piece, stroke
from jointbench.simulators.plates.slow_sensors import SlowSensors

STANDARD_GRAVITY = 9.80665  # [m/s^2]
# Samples generated together, so that sample k does not depend on the reads. A piece is
# shorter than the operator's reaction: no stroke falls into an existing one.
_PIECE = 1024
_KEPT = 64  # pieces


@dataclass(frozen=True, slots=True)
class PluggedSensor:
    """A sensor in an input of the chassis; the first is the hammer.

    Attributes:
        point: its position, empty for the hammer.
        sensitivity: true one [V per newton, or per m/s^2].
        noise: standard deviation [V].
        serial: number in its TEDS.
        manufacturer: number in its TEDS.
        model: number in its TEDS.
    """

    point: str
    sensitivity: float
    noise: float
    serial: int
    manufacturer: int = 27
    model: int = 352


SENSORS = (
    PluggedSensor("", 2.25e-3, 2e-5, 41230, model=86),
    PluggedSensor("1", 10.2e-3 / STANDARD_GRAVITY, 5e-6, 41231),
    PluggedSensor("2", 10.1e-3 / STANDARD_GRAVITY, 5e-6, 41232),
    PluggedSensor("6", 10.3e-3 / STANDARD_GRAVITY, 5e-6, 41233),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class PlatesBench:
    """Set-up of the simulated bench.

    Attributes:
        design: the specimen.
        operator: its parameters.
        sensors: by input; further inputs are open and contain noise.
        seed: of the noise.
        washers: bolts with a load washer, at the inputs after the sensors.
        thermometer: whether one is at the input after those.
    """

    design: PlatesDesign | CalibrationMass = field(default_factory=PlatesDesign)
    operator: SimulatedOperator = field(default_factory=SimulatedOperator)
    sensors: tuple[PluggedSensor, ...] = SENSORS
    seed: int = 1
    washers: int = 0
    thermometer: bool = False


@dataclass(frozen=True, slots=True)
class PlannedStroke:
    """Truth about one stroke.

    Attributes:
        number: since the bench was set up, from 0.
        time: first touch [s] in its stream.
        point: struck.
        torque: on each bolt [N m].
        peak_force: [N].
        fate: its outcome.
        stream: number of its stream.
    """

    number: int
    time: float
    point: str
    torque: float
    peak_force: float
    fate: Fate
    stream: int


class LivePlates:
    """The running bench: position of the hammer, and strokes of a stream.

    A stream begins with each start of a task; its samples depend on their indices, the
    seed, the number of the stream and the requested strokes only.
    """

    def __init__(self, bench: PlatesBench) -> None:
        self._bench = bench
        self._lock = threading.Lock()
        self._point, self._torque = "1", 20.0
        self._level: float | None = None
        self._rate, self._stream = 1.0, 0
        self._free_at = self._free_before = 0.0
        self._strokes: list[Stroke] = []
        self._made: dict[int, FloatArray] = {}
        self._slow = SlowSensors(bench.washers, bench.thermometer, bench.seed)
        self.history: list[PlannedStroke] = []

    @property
    def sensors(self) -> tuple[PluggedSensor, ...]:
        """Sensors by input."""
        return self._bench.sensors

    def begin(self, sample_rate: float) -> None:
        """Start a new stream from rest."""
        with self._lock:
            self._rate = sample_rate
            self._stream += 1
            self._free_at = 0.0
            self._strokes, self._made = [], {}

    def place(
        self,
        *,
        point: str | None = None,
        torque: float | None = None,
        level: float | None = None,
    ) -> None:
        """Move the hammer, tighten the bolts, or set the level [N].

        Raises:
            UsageError: there is no such point, or a number is not above zero.
        """
        if point is not None and point not in POINTS:
            raise UsageError(
                f"the plates have no point {point!r}; there are {', '.join(POINTS)}"
            )
        for name, value in (("torque", torque), ("level", level)):
            if value is not None and not (np.isfinite(value) and value > 0):
                raise UsageError(f"{name} is {value!r}; give one above zero")
        with self._lock:
            self._point = self._point if point is None else point
            self._torque = self._torque if torque is None else torque
            self._level = self._level if level is None else level

    def strike(self, *, position: int) -> PlannedStroke:
        """Strike once, soon after sample `position` of the stream.

        An earlier requested stroke that has not begun is cancelled.
        """
        with self._lock:
            self._recall(position)
            return self._plan(max(position / self._rate, self._free_at))

    def volts(self, first: int, count: int, inputs: Sequence[int]) -> FloatArray:
        """Return the voltage at some inputs [V], shape (n_inputs, count).

        Args:
            first: index of the first sample in the stream.
            count: of samples.
            inputs: numbers of the inputs.
        """
        with self._lock:
            numbers = range(first // _PIECE, (first + count - 1) // _PIECE + 1)
            made = np.hstack([self._piece(number) for number in numbers])
        offset = first - numbers[0] * _PIECE
        made = made[:, offset : offset + count]
        open_input = self._bench.sensors[0].noise * made[-1]
        return np.stack(
            [made[n] if n < made.shape[0] - 1 else open_input for n in inputs]
        )

    def _recall(self, position: int) -> None:
        if self._bench.operator.interval is not None or not self._strokes:
            return
        first, made = self._strokes[-1].first, max(self._made, default=-1)
        if first > position and first >= (made + 1) * _PIECE:
            self._strokes.pop()
            self.history.pop()
            self._free_at = self._free_before

    def _keep_striking(self, past: int) -> None:
        interval = self._bench.operator.interval
        while interval is not None and self._free_at * self._rate < past:
            self._plan(self._free_at)

    def _plan(self, after: float) -> PlannedStroke:
        bench, number = self._bench, len(self.history)
        pulses, fate = swing_once(
            bench.operator, number=number, after=after, level=self._level
        )
        new = stroke(self._poles(), pulses, sample_rate=self._rate)
        self._strokes.append(new)
        rest = bench.operator.interval or 4 * bench.operator.reaction
        self._free_before = self._free_at
        self._free_at = pulses[-1].start + rest
        planned = PlannedStroke(
            number,
            pulses[0].start,
            self._point,
            self._torque,
            max(pulse.peak for pulse in pulses),
            fate,
            self._stream,
        )
        self.history.append(planned)
        return planned

    def _poles(self) -> Poles:
        """Return the poles for the current hammer position and torque."""
        design = self._bench.design
        outputs = tuple(sensor.point for sensor in self._bench.sensors[1:])
        if isinstance(design, CalibrationMass):
            return mass_poles(design, outputs=len(outputs))
        return plates_poles(design, self._torque, struck=self._point, outputs=outputs)

    def _piece(self, number: int) -> FloatArray:
        """Return the volts of all sensors, and unit noise, over one piece."""
        if number not in self._made:
            self._keep_striking((number + 1) * _PIECE)
            first = number * _PIECE
            self._strokes = [
                s for s in self._strokes if s.last > first - _KEPT * _PIECE
            ]
            sensors = self._bench.sensors
            physical = signal_piece(
                self._strokes,
                first=first,
                count=_PIECE,
                outputs=len(sensors) - 1,
                rate=self._rate,
            )
            seed = [self._bench.seed, 13, self._stream, number]
            shape = (len(sensors) + 1, _PIECE)
            noise = np.random.default_rng(seed).standard_normal(shape)
            own_piece = (self._stream, number)
            self._slow.tighten(self._torque, first / self._rate)
            slow = self._slow.volts(first / self._rate, _PIECE, own_piece)
            for row, sensor, own in zip(noise, sensors, physical, strict=False):
                row *= sensor.noise
                row += sensor.sensitivity * own
            self._made[number] = np.vstack((noise[:-1], slow, noise[-1:]))
            self._made.pop(number - _KEPT, None)
        return self._made[number]
