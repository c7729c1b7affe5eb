# SPDX-License-Identifier: MIT
"""Serial lines by name; ``sim:`` names a simulated instrument."""

from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def line_name(name: str) -> Iterator[str]:
    """Give the name under which pyserial opens a line.

    Args:
        name: ``COM3``, ``/dev/ttyUSB0``, ``socket://host:port``, or ``sim:diavite``,
            ``sim:mitutoyo``, ``sim:mark10?torques=20,50&bolts=4`` or ``sim:NAME`` of
            an instrument that a package adds: a simulator, which stays plugged in
            while this context lasts.

    Raises:
        UsageError: the URL of a simulated instrument is invalid.
    """
    if not name.startswith("sim:"):
        yield name
        return
    from jointbench.simulators.serial_instruments.simulator_url import (
        simulator_from_url,
    )

    with simulator_from_url(name) as simulator:
        yield simulator.name
