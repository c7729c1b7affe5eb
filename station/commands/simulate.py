# SPDX-License-Identifier: MIT
"""``jointbench simulate``: a simulated NI chassis served over gRPC."""

from urllib.parse import parse_qsl, urlsplit

from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.chassis.chassis_url import chassis_from_url, is_plates_url
from jointbench.simulators.chassis.server import SimulatedChassis
from jointbench.station.screen.terminal import console


def run_simulate(url: str, module: str = "") -> None:
    """Serve a simulated chassis until interrupted.

    Args:
        url: simulated bench, for example ``sim:plates?interval=2&port=31763``; in real
            time unless it states a speed.
        module: type of its modules, empty for that of the URL.

    Raises:
        UsageError: the URL is not that of a simulated chassis, or the module is not
            simulated.
        InstrumentError: the port is taken.
    """
    if not is_plates_url(url):
        raise UsageError(
            f"{url!r} is not a simulated chassis; write 'sim:plates?port=31763'"
        )
    screen = console()
    with SimulatedChassis(chassis_from_url(complete_url(url, module))) as server:
        screen.print(f"serving NI-DAQmx at {server.address}; stop with Ctrl-C")
        for line in server.described():
            screen.print(f"  {line}", soft_wrap=True)
        screen.print(
            f"example: jointbench measure plan.toml --out session.h5 --source "
            f"ni+grpc://{server.address}",
            soft_wrap=True,
        )
        server.wait()


def complete_url(url: str, module: str) -> str:
    """Return a URL with the modules, and in real time unless it states a speed."""
    stated = dict(parse_qsl(urlsplit(url).query))
    added = [f"module={module}"] if module else []
    # A program of another's expects samples at their rate, as from hardware.
    added += [] if "speed" in stated else ["speed=1"]
    joint = "&" if "?" in url else "?"
    return url + (joint + "&".join(added) if added else "")
