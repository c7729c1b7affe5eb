# SPDX-License-Identifier: MIT
"""``jointbench simulate``: a simulated NI chassis served over gRPC."""

from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.chassis.chassis_url import chassis_from_url, is_plates_url
from jointbench.simulators.chassis.server import SimulatedChassis
from jointbench.station.screen.terminal import console


def run_simulate(url: str) -> None:
    """Serve a simulated chassis until interrupted.

    Args:
        url: simulated bench, for example ``sim:plates?interval=2&port=31763``.

    Raises:
        UsageError: the URL is not that of a simulated chassis.
        InstrumentError: the port is taken.
    """
    if not is_plates_url(url):
        raise UsageError(
            f"{url!r} is not a simulated chassis; write 'sim:plates?port=31763'"
        )
    screen = console()
    with SimulatedChassis(chassis_from_url(url)) as server:
        screen.print(f"serving NI-DAQmx at {server.address}; stop with Ctrl-C")
        screen.print(
            f"example: jointbench measure plan.toml --out session.h5 --source "
            f"ni+grpc://{server.address}",
            soft_wrap=True,
        )
        server.wait()
