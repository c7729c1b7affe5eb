# SPDX-License-Identifier: MIT
"""The chassis that a measurement runs on: local, remote or simulated, by its URL."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.ni.driver import Chassis
from jointbench.acquisition.ni.driver_answers import ConnectionLost
from jointbench.station.measure.observer import BenchOperator, Operator
from jointbench.station.measure.plan import Condition
from jointbench.station.screen.terminal import working

REMOTE = "ni+grpc://"


@dataclass(frozen=True, slots=True, eq=False)
class OpenChassis:
    """A chassis ready to be used.

    Attributes:
        chassis: the driver.
        name: URL that opens it again.
        simulated: True for a simulation, False for hardware.
        operator: whoever strikes and tightens.
    """

    chassis: Chassis
    name: str
    simulated: bool
    operator: Operator


@dataclass(frozen=True, slots=True, eq=False)
class OperatorOfSimulation:
    """The operator of a simulated bench, who strikes and tightens on request."""

    chassis: Chassis

    def ask(self, condition: Condition) -> None:
        """Request one hit; without a server there is none."""
        request = {"point": condition.point}
        torque = condition.tightened or condition.torque
        optional = {"torque": torque, "level": condition.level}
        request |= {k: v for k, v in optional.items() if v is not None}  # type: ignore[misc]
        try:
            self.chassis.strike(json.dumps(request).encode())
        except ConnectionLost:
            return


@contextmanager
def open_chassis(url: str) -> Iterator[OpenChassis]:
    """Open the chassis that a URL names.

    Args:
        url: ``ni:`` for a driver on this computer, ``ni+grpc://host:port`` for a device
            server, ``sim:plates?seed=1`` for a simulated chassis.

    Raises:
        UsageError: it is none of these.
        InstrumentError: the device does not answer.
    """
    if url.rstrip("/") == "ni:":
        with _driver(None, "ni:") as opened:
            yield opened
    elif url.startswith(REMOTE):
        with _driver(_address(url), url) as opened:
            yield opened
    else:
        from jointbench.simulators.chassis.chassis_url import (
            chassis_from_url,
            is_plates_url,
        )
        from jointbench.simulators.chassis.server import SimulatedChassis

        if not is_plates_url(url):
            raise UsageError(
                f"source {url!r} is no chassis; type ni:, ni+grpc://host:31763 or "
                "sim:plates, sim:mass, sim:spindle or sim:shaker"
            )
        with (
            SimulatedChassis(chassis_from_url(url)) as server,
            _driver(server.address, url) as opened,
        ):
            yield opened


@contextmanager
def _driver(address: str | None, name: str) -> Iterator[OpenChassis]:
    chassis = Chassis(address)
    try:
        with working(f"connecting to {name}"):
            modules = chassis.modules()
        simulated = bool(modules) and all(module.simulated for module in modules)
        # NI's own simulated devices cannot strike; the first request shows that.
        operator: Operator = (
            OperatorOfSimulation(chassis) if simulated else BenchOperator()
        )
        yield OpenChassis(chassis, name, simulated, operator)
    finally:
        chassis.close()


def _address(url: str) -> str:
    address = url.removeprefix(REMOTE).rstrip("/")
    host, colon, port = address.rpartition(":")
    if not (host and colon and port.isdigit()):
        raise UsageError(f"{url!r} names no device server; type ni+grpc://host:31763")
    return address
