"""Pytest plugin: NI's tests find the simulated chassis, not NI's device server."""

import sys
import types
from typing import Any

import grpc
import nidaqmx
import nidaqmx.system
import pytest
import tests._grpc_utils as utilities  # type: ignore[import-not-found]  # noqa: PLC2701
from hightime import datetime
from stand_in import stand_in

from jointbench.simulators.chassis.server import SimulatedChassis


class ChassisProcess:
    """In the place of the process of NI's server."""

    def __init__(self) -> None:
        self._server = SimulatedChassis(stand_in(1.0))
        self._server.start()
        self.server_port = self._server.port

    def __enter__(self) -> "ChassisProcess":
        """Return this."""
        return self

    def __exit__(self, *details: object) -> None:
        """Stop the server."""
        self._server.close()


utilities.GrpcServerProcess = ChassisProcess
# One file asks the driver of this computer for its version when it is imported.
_local = SimulatedChassis(stand_in(1.0))
_local.start()
_options = nidaqmx.GrpcSessionOptions(grpc.insecure_channel(_local.address), "")
nidaqmx.system.System.local = staticmethod(  # type: ignore[method-assign]
    lambda: nidaqmx.system.System.remote(_options)
)
# Two dates that a test file takes from NI's unit tests.
_dates: Any = types.ModuleType("tests.unit._time_utils")
_dates.JAN_01_1904_HIGHTIME = datetime(1904, 1, 1)
_dates.JAN_01_2002_HIGHTIME = datetime(2002, 1, 1)
sys.modules["tests.unit"] = types.ModuleType("tests.unit")
sys.modules["tests.unit._time_utils"] = _dates


def pytest_collection_modifyitems(
    config: pytest.Config, items: list[pytest.Item]
) -> None:
    """Leave out what needs the driver on this computer."""
    local = [item for item in items if "library_init_kwargs" in item.name]
    config.hook.pytest_deselected(items=local)
    items[:] = [item for item in items if item not in local]
