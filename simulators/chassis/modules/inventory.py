# SPDX-License-Identifier: MIT
"""Devices of the simulated system: a chassis with modules, and devices of their own."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace

from jointbench.simulators.chassis.modules.clock_rates import divided_by_integers
from jointbench.simulators.chassis.modules.module_type import ModuleType, module_type
from jointbench.simulators.chassis.protocol import DAQmxErrors, Refusal
from jointbench.simulators.plates.plates_bench import PluggedSensor

DEFAULT_MODULE = "9234"
CHASSIS_PRODUCT = "cDAQ-9178"
TIMING_ENGINES = 3  # for analogue input in a cDAQ-9178
_NAMED = re.compile(r"/?(?P<device>[^/:,]+)/ai(?P<first>\d+)(:(?P<last>\d+))?")


@dataclass(frozen=True, slots=True, kw_only=True)
class Inventory:
    """The devices.

    Attributes:
        name: of the chassis; its modules are ``<name>Mod1`` and so on, devices of
            their own ``Dev1`` and so on.
        modules: type of each.
        names: of the modules, instead of those above.
        teds_error: number of NI's error for every TEDS query, 0 for none.
        sensors: plugged into the first inputs.
        missing: inputs that are refused.
        swapped_teds: inputs with a wrong TEDS.
    """

    name: str = "cDAQSim1"
    modules: tuple[ModuleType, ...] = ()
    names: tuple[str, ...] = ()
    teds_error: int = 0
    sensors: tuple[PluggedSensor, ...] = ()
    missing: frozenset[int] = frozenset()
    swapped_teds: frozenset[int] = frozenset()


@dataclass(frozen=True, slots=True)
class Device:
    """One module or device.

    Attributes:
        name: for example ``"cDAQSim1Mod1"``.
        type: its properties.
        chassis: it is in; empty for a device of its own.
        slot: in the chassis, from 1.
        first: number of its first input, counted over all devices.
    """

    name: str
    type: ModuleType
    chassis: str
    slot: int
    first: int


@dataclass(frozen=True, slots=True)
class Input:
    """One analogue input.

    Attributes:
        device: it is on.
        local: number on the device.
    """

    device: Device
    local: int

    @property
    def name(self) -> str:
        """Physical channel, for example ``"cDAQSim1Mod1/ai0"``."""
        return f"{self.device.name}/ai{self.local}"

    @property
    def number(self) -> int:
        """Counted over all devices."""
        return self.device.first + self.local


def module_list(names: str, count: int) -> tuple[ModuleType, ...]:
    """Return types from ``"9234"`` and a count, or from ``"9234,9250"``.

    Raises:
        UsageError: a module is not simulated.
    """
    types = tuple(module_type(name.strip()) for name in names.split(","))
    return types * count if len(types) == 1 else types


def changed(
    modules: tuple[ModuleType, ...],
    *,
    top_rate: float | None,
    analogue_trigger: bool,
    currents: tuple[float, ...] | None,
) -> tuple[ModuleType, ...]:
    """Return modules with another clock [Hz], without triggers, or other currents."""
    made = []
    for each in modules:
        rates = each.rates if top_rate is None else divided_by_integers(top_rate)
        trigger = each.analogue_trigger and analogue_trigger
        supply = each.currents if currents is None else currents
        made.append(
            replace(each, rates=rates, analogue_trigger=trigger, currents=supply)
        )
    return tuple(made)


def devices(inventory: Inventory) -> tuple[Device, ...]:
    """Return the modules and devices, without the chassis."""
    found: list[Device] = []
    first = 0
    for n, module in enumerate(inventory.modules):
        alike = sum(each.type.standalone is module.standalone for each in found) + 1
        name = f"Dev{alike}" if module.standalone else f"{inventory.name}Mod{alike}"
        chassis = "" if module.standalone else inventory.name
        given = inventory.names[n] if n < len(inventory.names) else name
        found.append(Device(given, module, chassis, alike, first))
        first += module.inputs
    return tuple(found)


def device_names(inventory: Inventory) -> list[str]:
    """Return the names of chassis, modules and devices."""
    found = devices(inventory)
    chassis = [inventory.name] if any(each.chassis for each in found) else []
    return [*chassis, *(each.name for each in found)]


def device_named(inventory: Inventory, name: str) -> Device | None:
    """Return a device, or None for the chassis itself.

    Raises:
        Refusal: there is none of this name.
    """
    for each in devices(inventory):
        if each.name.lower() == name.lower():
            return each
    if name.lower() not in {known.lower() for known in device_names(inventory)}:
        raise Refusal(
            DAQmxErrors.INVALID_DEVICE_ID,
            f"Device identifier is invalid.\nDevice Specified: {name}",
        )
    return None


def inputs_named(inventory: Inventory, text: str) -> list[Input]:
    """Return the inputs of a list such as ``"Dev1/ai0:2, Dev1/ai5"``.

    Raises:
        Refusal: the list is malformed, or there is no such device or input.
    """
    words = [word.strip() for word in text.split(",") if word.strip()]
    if not words:
        raise Refusal(
            DAQmxErrors.PHYSICAL_CHANNEL_NOT_SPECIFIED,
            "Physical channel was not specified.",
        )
    return [found for word in words for found in _expanded(inventory, word)]


def _expanded(inventory: Inventory, word: str) -> Iterator[Input]:
    match = _NAMED.fullmatch(word)
    if match is None:
        raise _no_input_or_syntax(inventory, word)
    device = device_named(inventory, match["device"])
    first, last = int(match["first"]), int(match["last"] or match["first"])
    if max(first, last) >= (device.type.inputs if device else 0):
        raise _no_input(match["device"], word)
    step = 1 if last >= first else -1
    for local in range(first, last + step, step):
        assert device is not None
        found = Input(device, local)
        if found.number in inventory.missing:
            raise _no_input(device.name, found.name)
        yield found


def _no_input_or_syntax(inventory: Inventory, word: str) -> Refusal:
    name, _, rest = word.strip("/").partition("/")
    device_named(inventory, name)
    if ":" in rest:
        return Refusal(
            DAQmxErrors.INVALID_SYNTAX_FOR_PHYSICAL_CHANNEL_RANGE,
            f"Syntax for a range of objects in the input string is invalid.\n"
            f"Invalid String: {word}",
        )
    return _no_input(name, word)


def _no_input(device: str, word: str) -> Refusal:
    return Refusal(
        DAQmxErrors.PHYSICAL_CHAN_DOES_NOT_EXIST,
        "Physical channel specified does not exist on this device.\n\n"
        "Refer to the documentation for channels available on this device.\n\n"
        f"Device: {device}\nPhysical Channel Name: {word}",
    )
