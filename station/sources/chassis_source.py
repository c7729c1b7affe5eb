# SPDX-License-Identifier: MIT
"""A simulated source, delivered by a simulated chassis to NI's own client."""

import math
from collections.abc import Iterator
from contextlib import AbstractContextManager, closing, contextmanager
from dataclasses import dataclass, replace

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import InstrumentError
from jointbench.acquisition.ni.driver import Chassis
from jointbench.acquisition.ni.sensors import Axis, Sensor
from jointbench.acquisition.ni.stream import Block, NiStream, StreamSettings
from jointbench.acquisition.recorder.requests import Setup
from jointbench.acquisition.records.recordings import Channel
from jointbench.acquisition.records.source import Run, Source
from jointbench.simulators.chassis.modules.inventory import DEFAULT_MODULE
from jointbench.simulators.chassis.modules.module_type import module_type
from jointbench.simulators.chassis.server import ChassisSetup, SimulatedChassis
from jointbench.simulators.chassis.specimen import INPUT_RANGE, plugged

BLOCK = 0.1  # [s]


@dataclass(frozen=True, slots=True, eq=False)
class ChassisSource:
    """A `Source` whose samples took the way through the NI driver.

    Attributes:
        source: what is plugged into the simulated chassis.
        samples: per channel, after which it ends.
    """

    source: Source
    samples: int

    @property
    def name(self) -> str:
        """As the source calls itself."""
        return self.source.name

    @property
    def simulated(self) -> bool:
        """True: it is a simulation."""
        return True

    @property
    def channels(self) -> tuple[Channel, ...]:
        """Of the source, with the sensitivity of what is plugged in for them."""
        return tuple(
            replace(channel, sensitivity=plugged(channel).sensitivity)
            for channel in self.source.channels
        )

    @property
    def sample_rate(self) -> float:
        """Of the source [Hz]."""
        return self.source.sample_rate

    def blocks(self) -> Iterator[FloatArray]:
        """Yield the samples as the client reads them, the last block short.

        Raises:
            InstrumentError: the chassis was lost, or lost samples.
        """
        with (
            self.served() as setup,
            closing(Chassis(setup.address)) as chassis,
            closing(NiStream(chassis, setup.sensors, setup.settings)) as stream,
        ):
            stream.start()
            yield from _first(stream, self.samples)

    @contextmanager
    def served(self) -> Iterator[Setup]:
        """Serve the chassis for the duration, and yield what is streamed from it."""
        rate = self.sample_rate
        setup = ChassisSetup(
            bench=self.source,
            speed=math.inf,
            modules=-(-len(self.channels) // _inputs()),
            top_rate=rate,
        )
        settings = StreamSettings(rate, max(1, round(BLOCK * rate)))
        with SimulatedChassis(setup) as server:
            yield Setup(server.address, _table(self.channels), settings, self.samples)


@dataclass(frozen=True, slots=True, eq=False)
class ChassisRun:
    """A `Run` whose samples come through the NI driver.

    Attributes:
        run: what is plugged into the simulated chassis.
        samples: per channel, after which it ends.
    """

    run: Run
    samples: int

    @property
    def name(self) -> str:
        """Of the run."""
        return self.run.name

    @property
    def simulated(self) -> bool:
        """True: it is a simulation."""
        return True

    @property
    def channels(self) -> tuple[Channel, ...]:
        """Of the run, with the sensitivity of what is plugged in for them."""
        return ChassisSource(self.run, self.samples).channels

    @property
    def sample_rate(self) -> float:
        """Of the run [Hz]."""
        return self.run.sample_rate

    @property
    def preload(self) -> float | None:
        """On the joint meanwhile [N]."""
        return self.run.preload

    @property
    def start_time(self) -> float:
        """Of its first sample since the first run began [s]."""
        return self.run.start_time

    def blocks(self) -> Iterator[FloatArray]:
        """Yield the samples as the client reads them."""
        return ChassisSource(self.run, self.samples).blocks()

    def served(self) -> AbstractContextManager[Setup]:
        """Serve the chassis, see `ChassisSource.served`."""
        return ChassisSource(self.run, self.samples).served()


def _first(stream: NiStream, samples: int) -> Iterator[FloatArray]:
    left = samples
    for item in stream.items():
        if not isinstance(item, Block):
            raise InstrumentError(f"the simulated chassis was lost: {item}; try again")
        yield item.samples[:, :left]
        left -= item.samples.shape[1]
        if left <= 0:
            return


def _table(channels: tuple[Channel, ...]) -> tuple[Sensor, ...]:
    """Return the channel table of what is plugged in, input by input."""
    return tuple(
        Sensor(
            name=channel.name,
            quantity=channel.quantity,
            point=channel.point,
            axes=(
                Axis(
                    _input(n),
                    channel.direction,
                    channel.sensitivity or 1.0,
                ),
            ),
            unit=channel.unit,
            range=channel.range or INPUT_RANGE / (channel.sensitivity or 1.0),
        )
        for n, channel in enumerate(channels)
    )


def _inputs() -> int:
    """Return the inputs of a module."""
    return module_type(DEFAULT_MODULE).inputs


def _input(number: int) -> str:
    module, own = divmod(number, _inputs())
    return f"cDAQSim1Mod{module + 1}/ai{own}"
