# SPDX-License-Identifier: MIT
"""A simulated bench: two bodies on a joint, a hammer, three channels, one stream."""

from collections.abc import Iterator
from dataclasses import dataclass, fields
from urllib.parse import urlencode

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.recordings import Channel, Quantity, Verdict
from jointbench.simulators.measuring.converter import (
    AntiAlias,
    Digitiser,
    decimate,
    recut,
)
from jointbench.simulators.measuring.hammer import (
    Hammer,
    SimulatedHit,
    pulse_force,
    swing,
)
from jointbench.simulators.mechanics.plant import Plant, plant_modes, two_bodies
from jointbench.simulators.mechanics.plant_integration import rest_state, step_plant
from jointbench.simulators.two_body.bolts import bolt_preload, bolt_torque

# Samples per piece: the noise is seeded for each piece, so that sample k does not
# depend on the block size.
_PIECE = 8192
_STANDSTILL = 0.9  # [s] recorded after the last hit


@dataclass(frozen=True, slots=True)
class BenchHit:
    """Truth about one hit.

    Attributes:
        time: first touch [s] after the first sample.
        sample: index of the first sample at or after the touch.
        peak_force: before clipping [N].
        width: contact time [s].
        verdict: `OK`, `DOUBLE` or `OVERLOAD`.
        bounce_delay: from first to second touch [s], None without a bounce.
    """

    time: float
    sample: int
    peak_force: float
    width: float
    verdict: Verdict
    bounce_delay: float | None


@dataclass(frozen=True, slots=True)
class BenchTruth:
    """True parameters of the bench; `kj` is the value at its preload.

    Attributes:
        m1: mass of the base [kg].
        m2: mass of the top [kg].
        k0: stiffness between ground and base [N/m].
        c0: damping coefficient between ground and base [N s/m].
        kj: stiffness of the joint between base and top [N/m].
        cj: damping coefficient of the joint [N s/m].
        natural_frequency: of the modes, ascending [Hz].
        damping_ratio: of the modes [-].
        hits: in order of time.
        preload: on the joint [N].
        torque: on each bolt [N m].
    """

    m1: float
    m2: float
    k0: float
    c0: float
    kj: float
    cj: float
    natural_frequency: tuple[float, ...]
    damping_ratio: tuple[float, ...]
    hits: tuple[BenchHit, ...]
    preload: float
    torque: float


@dataclass(frozen=True, slots=True, kw_only=True)
class TwoBodyBench:
    """A `Source` of hammer force and the accelerations of base and top.

    Attributes:
        seed: of hammer and noise; the structure does not depend on it.
        hits: number of hits.
        point: struck body, ``"1"`` the base or ``"2"`` the top.
        m1: mass of the base [kg].
        m2: mass of the top [kg].
        k0: stiffness between ground and base [N/m].
        c0: damping coefficient between ground and base [N s/m].
        kj: stiffness of the joint at `reference_preload` [N/m].
        cj: damping coefficient of the joint [N s/m].
        preload: on the joint [N]; None for that of `torque`, else the reference.
        torque: on each of four M16 bolts [N m]; give it or `preload`, not both.
        reference_preload: preload at which `kj` is given [N].
        preload_exponent: kj grows as preload to this power [-].
        level: usual peak force [N].
        level_scatter: relative scatter of the peak force [-].
        width: usual contact time [s].
        interval: usual time between hits [s].
        point_scatter: relative scatter of the effective force [-].
        double_rate: share of double hits [-].
        overload_rate: share of hits beyond the range of the force channel [-].
        noise: of each accelerometer, standard deviation [m/s^2].
        force_noise: of the hammer, standard deviation [N].
        force_range: largest force the channel carries [N].
        acceleration_range: largest acceleration a channel carries [m/s^2].
        bits: of the converter.
        sample_rate: [Hz].
        oversampling: steps of the plant per sample.
        block: samples per block.
    """

    seed: int = 1
    hits: int = 10
    point: str = "2"
    m1: float = 9.0
    m2: float = 4.6
    k0: float = 2.2e7
    c0: float = 320.0
    kj: float = 6.0e7
    cj: float = 240.0
    preload: float | None = None
    torque: float | None = None
    reference_preload: float = 25.0e3
    preload_exponent: float = 0.5
    level: float = 300.0
    level_scatter: float = 0.15
    width: float = 0.8e-3
    interval: float = 1.5
    point_scatter: float = 5e-4
    double_rate: float = 0.1
    overload_rate: float = 0.1
    noise: float = 0.01
    force_noise: float = 0.01
    force_range: float = 1000.0
    acceleration_range: float = 490.0
    bits: int = 24
    sample_rate: float = 25_600.0
    oversampling: int = 8
    block: int = 2560

    def __post_init__(self) -> None:
        """Refuse values out of range."""
        if self.point not in {"1", "2"}:
            raise UsageError(
                f"point is {self.point!r}; strike the base with point=1, the top with 2"
            )
        if self.preload is not None and self.torque is not None:
            raise UsageError("preload and torque both given; give one of them")
        for name in _POSITIVE:
            value = getattr(self, name)
            if value is not None and not (np.isfinite(value) and value > 0):
                raise UsageError(f"{name} is {value!r}, it must be finite and positive")
        if self.oversampling < 4:
            raise UsageError(f"oversampling is {self.oversampling}; give 4 or more")

    @property
    def name(self) -> str:
        """The URL of this bench, with all non-default values."""
        changed = {
            field.name: getattr(self, field.name)
            for field in fields(self)
            if field.name == "seed" or getattr(self, field.name) != field.default
        }
        return f"sim:two-body?{urlencode(changed)}"

    @property
    def simulated(self) -> bool:
        """True: no hardware is used."""
        return True

    @property
    def channels(self) -> tuple[Channel, ...]:
        """Hammer force, acceleration a0 of the base and a1 of the top."""
        return (
            Channel(
                name="force",
                quantity=Quantity.FORCE,
                point=self.point,
                direction="+z",
                unit="N",
                sensitivity=2.25e-3,
                range=self.force_range,
            ),
            *(
                Channel(
                    name=name,
                    quantity=Quantity.ACCELERATION,
                    point=point,
                    direction="+z",
                    unit="m/s^2",
                    sensitivity=10.2e-3,
                    range=self.acceleration_range,
                )
                for name, point in (("a0", "1"), ("a1", "2"))
            ),
        )

    @property
    def truth(self) -> BenchTruth:
        """True values for an identification."""
        return _truth(self)

    @property
    def samples(self) -> int:
        """Samples per channel in the whole stream."""
        last = _swings(self)[-1:]
        length = (last[0].start if last else 0.0) + _STANDSTILL
        return int(np.ceil(length * self.sample_rate))

    def blocks(self) -> Iterator[FloatArray]:
        """Yield the stream in SI units, shape (3, block); the last block is short."""
        return recut(_pieces(self), block=self.block, total=self.samples)


_POSITIVE = (
    *("m1", "m2", "k0", "c0", "kj", "cj", "preload", "torque", "reference_preload"),
    *("level", "width", "interval", "force_range", "acceleration_range"),
    *("sample_rate", "block", "hits", "bits"),
)


def _preload(bench: TwoBodyBench) -> float:
    if bench.torque is not None:
        return bolt_preload(bench.torque)
    return bench.reference_preload if bench.preload is None else bench.preload


def _joint_stiffness(bench: TwoBodyBench) -> float:
    ratio = _preload(bench) / bench.reference_preload
    return float(bench.kj * ratio**bench.preload_exponent)


def _plant(bench: TwoBodyBench) -> Plant:
    return two_bodies(
        m1=bench.m1,
        m2=bench.m2,
        k0=bench.k0,
        c0=bench.c0,
        kj=_joint_stiffness(bench),
        cj=bench.cj,
    )


def _swings(bench: TwoBodyBench) -> tuple[SimulatedHit, ...]:
    hammer = Hammer(
        level=bench.level,
        level_scatter=bench.level_scatter,
        width=bench.width,
        interval=bench.interval,
        point_scatter=bench.point_scatter,
        double_rate=bench.double_rate,
        overload_rate=bench.overload_rate,
        overload_level=bench.force_range,
    )
    return swing(hammer, hits=bench.hits, seed=bench.seed)


def _truth(bench: TwoBodyBench) -> BenchTruth:
    modes = plant_modes(_plant(bench))
    preload = _preload(bench)
    return BenchTruth(
        m1=bench.m1,
        m2=bench.m2,
        k0=bench.k0,
        c0=bench.c0,
        kj=_joint_stiffness(bench),
        cj=bench.cj,
        natural_frequency=tuple(float(f) for f in modes.natural_frequency),
        damping_ratio=tuple(float(z) for z in modes.damping_ratio),
        hits=tuple(_hit_truth(hit, bench.sample_rate) for hit in _swings(bench)),
        preload=preload,
        torque=bolt_torque(preload),
    )


def _hit_truth(hit: SimulatedHit, sample_rate: float) -> BenchHit:
    bounces = hit.pulses[1:]
    return BenchHit(
        time=hit.start,
        sample=int(np.ceil(hit.start * sample_rate)),
        peak_force=hit.peak_force,
        width=hit.pulses[0].width,
        verdict=hit.verdict,
        bounce_delay=bounces[0].start - hit.start if bounces else None,
    )


def _pieces(bench: TwoBodyBench) -> Iterator[FloatArray]:
    """Yield digitised samples, in pieces that do not depend on the block size."""
    filter_ = AntiAlias(oversampling=bench.oversampling)
    inputs = (
        Digitiser(bench.force_range, bench.force_noise, bench.bits),
        *(Digitiser(bench.acceleration_range, bench.noise, bench.bits),) * 2,
    )
    for number, piece in enumerate(decimate(_analogue(bench), filter_)):
        rng = np.random.default_rng([bench.seed, 2, number])
        yield np.stack(
            [
                channel.digitise(row, rng)
                for channel, row in zip(inputs, piece, strict=True)
            ]
        )


def _analogue(bench: TwoBodyBench) -> Iterator[FloatArray]:
    """Yield force and accelerations at every step of the plant, without end."""
    plant = _plant(bench)
    swings = _swings(bench)
    steps = _PIECE * bench.oversampling
    time_step = 1 / (bench.sample_rate * bench.oversampling)
    state = rest_state(plant)
    first = 0
    while True:
        time = time_step * np.arange(2 * first, 2 * first + 2 * steps + 1) / 2
        measured = np.zeros(time.size)
        acting = np.zeros(time.size)
        for hit in swings:
            force = pulse_force(hit.pulses, time)
            measured += force
            acting += hit.effectiveness * force
        acceleration, state = step_plant(
            plant,
            acting,
            body=int(bench.point) - 1,
            time_step=time_step,
            state=state,
        )
        yield np.vstack((measured[:-1:2], acceleration))
        first += steps
