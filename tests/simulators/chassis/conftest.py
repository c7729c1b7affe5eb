"""One simulated chassis for all tests of this folder, and NI's client on it."""

import math
from collections.abc import Callable, Iterator

import grpc
import nidaqmx
import pytest

from jointbench.simulators.chassis.server import ChassisSetup, SimulatedChassis

# Names: cDAQSim1Mod1 to Mod4 and Dev1, Dev2.
MODULES = "9234,9250,9215,9231,4431,6363"

NewTask = Callable[..., nidaqmx.Task]


@pytest.fixture(scope="session")
def server() -> Iterator[SimulatedChassis]:
    """Return a chassis with six kinds of modules that runs as fast as it is read."""
    setup = ChassisSetup(bench=None, speed=math.inf, module=MODULES)
    with SimulatedChassis(setup) as running:
        yield running


@pytest.fixture(scope="session")
def channel(server: SimulatedChassis) -> Iterator[grpc.Channel]:
    """Return a connection."""
    with grpc.insecure_channel(server.address) as open_:
        yield open_


@pytest.fixture
def new_task(channel: grpc.Channel) -> Iterator[NewTask]:
    """Return a function that makes tasks, which are closed after the test."""
    made: list[nidaqmx.Task] = []

    def new(name: str = "", **options: object) -> nidaqmx.Task:
        session = nidaqmx.GrpcSessionOptions(channel, name, **options)  # type: ignore[arg-type]
        made.append(nidaqmx.Task(name, grpc_options=session))
        return made[-1]

    yield new
    for task in made:
        task.close()
