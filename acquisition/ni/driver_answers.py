# SPDX-License-Identifier: MIT
"""Answers of the driver: modules, TEDS, and errors of a stream."""

from dataclasses import dataclass

from jointbench.acquisition.basics.errors import InstrumentError


class ConnectionLost(InstrumentError):
    """The server or the device is unreachable; it may return."""


class Overrun(InstrumentError):
    """Samples were overwritten in the buffer before they were read."""


class NotYet(InstrumentError):
    """Samples have not arrived in time; the task is running, they may still arrive."""


class Stopped(InstrumentError):
    """The device stopped the task; it is available and can start another."""


@dataclass(frozen=True, slots=True)
class Module:
    """One device of a chassis.

    Attributes:
        name: for example ``"cDAQ1Mod1"``.
        product: for example ``"NI 9234"``.
        simulated: True for simulated hardware.
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
    """Data of a sensor from its TEDS.

    Attributes:
        manufacturer: number of the manufacturer.
        model: number of the model.
        serial: serial number.
    """

    manufacturer: int
    model: int
    serial: int
