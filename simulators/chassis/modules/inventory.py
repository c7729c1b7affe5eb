# SPDX-License-Identifier: MIT
"""Devices of the simulated system: a chassis with modules, and devices of their own."""

from dataclasses import dataclass, replace

from jointbench.simulators.chassis.modules.clock_rates import divided_by_integers
from jointbench.simulators.chassis.modules.module_type import ModuleType, module_type
from jointbench.simulators.plates.plates_bench import PluggedSensor

DEFAULT_MODULE = "9234"
TIMING_ENGINES = 3  # for analogue input in a cDAQ-9178


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
