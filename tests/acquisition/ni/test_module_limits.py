"""A table that a module cannot serve is refused before the first hit."""

from dataclasses import replace

import pytest

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.ni.driver import Chassis
from jointbench.acquisition.ni.module_limits import require_capable
from jointbench.acquisition.ni.sensors import Axis, Sensor
from jointbench.acquisition.records.recordings import Quantity
from jointbench.simulators.chassis.server import ChassisSetup, SimulatedChassis

HAMMER = Sensor(
    "force", Quantity.FORCE, "", (Axis("cDAQSim1Mod1/ai0", "+z", 2e-3),), "N", 2400.0
)
PLAIN = replace(HAMMER, axes=(Axis("cDAQSim1Mod3/ai0", "+z", 2e-3),))
OWN = replace(HAMMER, axes=(Axis("Dev1/ai3", "+z", 2e-3),))


@pytest.fixture(scope="module")
def limits() -> dict[str, object]:
    """Return what the driver reports of four kinds of modules."""
    setup = ChassisSetup(bench=None, module="9234,9250,9215,9230,4431")
    with SimulatedChassis(setup) as server:
        client = Chassis(server.address)
        found = client.limits()
        client.close()
    return dict(found)


@pytest.mark.parametrize(
    ("sensor", "rate", "words"),
    [
        (
            replace(HAMMER, range=5000.0),
            12_800.0,
            r"10 V at the input, the NI 9234 takes \+-5 V; reduce the range to 50%",
        ),
        (HAMMER, 60_000.0, r"60 kHz, the NI 9234 reaches 51.2 kHz"),
        (PLAIN, 12_800.0, "coupling is AC, the NI 9215 offers DC; write coupling"),
        (
            replace(HAMMER, axes=(Axis("cDAQSim1Mod2/ai2", "+z", 2e-3),)),
            12_800.0,
            "the NI 9250 has the inputs cDAQSim1Mod2/ai0 to cDAQSim1Mod2/ai1",
        ),
        (
            replace(HAMMER, axes=(Axis("cDAQ9Mod1/ai0", "+z", 2e-3),)),
            12_800.0,
            "no device 'cDAQ9Mod1'; found: cDAQSim1Mod1",
        ),
    ],
)
def test_the_message_states_what_the_module_can_do(
    limits: dict, sensor: Sensor, rate: float, words: str
) -> None:
    """Range, rate, coupling, input and device."""
    with pytest.raises(UsageError, match=words):
        require_capable([sensor], limits, rate)


def test_a_table_that_fits_passes(limits: dict) -> None:
    """Each on its module."""
    require_capable([HAMMER, replace(PLAIN, coupling="DC"), OWN], limits, 51_200.0)
