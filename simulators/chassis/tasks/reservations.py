# SPDX-License-Identifier: MIT
"""Devices that tasks reserve: one task at a time on each, three in a chassis.

Source:
    NI-DAQmx help, Task State Model; NI cDAQ-9174/9178 User Manual, Analog Input Timing
    Signals: three timing engines, a module belongs to one task.
"""

import threading
from collections.abc import Iterable

from jointbench.simulators.chassis.modules.inventory import TIMING_ENGINES, Device
from jointbench.simulators.chassis.protocol import DAQmxErrors, Refusal


class Reservations:
    """Who holds which device."""

    def __init__(self) -> None:
        self._holders: dict[str, tuple[object, str]] = {}
        self._lock = threading.Lock()

    def take(self, holder: object, devices: Iterable[Device]) -> None:
        """Reserve devices for a task.

        Raises:
            Refusal: another task holds one, or the timing engines of the chassis.
        """
        with self._lock:
            wanted = {each.name: each.chassis for each in devices}
            others = {n: h for n, h in self._holders.items() if h[0] is not holder}
            if set(wanted) & set(others):
                raise _reserved()
            for chassis in filter(None, wanted.values()):
                busy = {id(h[0]) for h in others.values() if h[1] == chassis}
                if len(busy) >= TIMING_ENGINES:
                    raise _reserved()
            self._holders.update({n: (holder, c) for n, c in wanted.items()})

    def release(self, holder: object) -> None:
        """Release everything that a task holds."""
        with self._lock:
            mine = [n for n, h in self._holders.items() if h[0] is holder]
            for name in mine:
                del self._holders[name]


def _reserved() -> Refusal:
    return Refusal(
        DAQmxErrors.PAL_RESOURCE_RESERVED,
        "The specified resource is reserved. The operation could not be completed as "
        "specified.",
    )
