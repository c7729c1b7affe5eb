"""The chassis that `jointbench simulate` serves."""

import math

import pytest

from jointbench.simulators.chassis.chassis_url import chassis_from_url
from jointbench.station.commands.simulate import complete_url


@pytest.mark.parametrize(
    ("url", "module", "speed"),
    [
        ("sim:sine", "", 1.0),
        ("sim:sine", "9215", 1.0),
        ("sim:plates?interval=2", "9215", 1.0),
        ("sim:sine?speed=max", "9215", math.inf),
        ("sim:sine?speed=5", "", 5.0),
    ],
)
def test_a_chassis_is_served_in_real_time_unless_a_speed_is_stated(
    url: str, module: str, speed: float
) -> None:
    """Another program's timeouts and overruns then come as at a bench."""
    setup = chassis_from_url(complete_url(url, module))
    assert setup.speed == speed
    assert setup.module == (module or "9234")
