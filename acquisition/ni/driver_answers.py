# SPDX-License-Identifier: MIT
"""What the driver says: modules, TEDS, and the ways in which a stream breaks."""

from dataclasses import dataclass

from jointbench.acquisition.basics.errors import InstrumentError


class ConnectionLost(InstrumentError):
    """The server or the device went away; it may come back."""


class Overrun(InstrumentError):
    """Samples were overwritten in the buffer before they were read."""


class NotYet(InstrumentError):
    """Samples have not come in time; the task runs on, and they may still come."""


class Stopped(InstrumentError):
    """The device stopped the task by itself; it is there and can start another."""


@dataclass(frozen=True, slots=True)
class Module:
    """One device of a chassis.

    Attributes:
        name: for example ``"cDAQ1Mod1"``.
        product: for example ``"NI 9234"``.
        simulated: True where no hardware is behind it.
        analogue_trigger: whether it can trigger on a signal.
        inputs: its analogue inputs.
    """

    name: str
    product: str
    simulated: bool
    analogue_trigger: bool
    inputs: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Teds:
    """What a sensor says of itself.

    Attributes:
        manufacturer: number of the maker.
        model: number of the model.
        serial: serial number.
    """

    manufacturer: int
    model: int
    serial: int
