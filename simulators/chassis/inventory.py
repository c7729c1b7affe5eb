# SPDX-License-Identifier: MIT
"""Modules of the simulated chassis: four IEPE inputs each, and their properties."""

import math
from dataclasses import dataclass

from jointbench.simulators.chassis.protocol import DAQmxErrors, Refusal
from jointbench.simulators.plates.plates_bench import PluggedSensor

INPUTS_PER_MODULE = 4
CURRENTS = (0.002,)  # [A], of an NI 9234
_NO_SUCH_CHANNEL = DAQmxErrors.PHYSICAL_CHAN_DOES_NOT_EXIST
BAD_VALUE = DAQmxErrors.INVALID_ATTRIBUTE_VALUE


@dataclass(frozen=True, slots=True, kw_only=True)
class Inventory:
    """The chassis.

    Attributes:
        name: of the chassis; its modules are ``<name>Mod1`` and so on.
        modules: number of modules.
        top_rate: highest samples per second and channel [Hz]; lower rates are this one
            over an integer.
        analogue_trigger: whether the modules can trigger on a signal.
        currents: available for IEPE sensors [A]; empty for none.
        teds_error: number of NI's error for every TEDS query, 0 for none.
        sensors: plugged into the first inputs.
        missing: inputs that are refused.
        swapped_teds: inputs with a wrong TEDS.
    """

    name: str = "cDAQSim1"
    modules: int = 1
    top_rate: float = 51_200.0
    analogue_trigger: bool = True
    currents: tuple[float, ...] = CURRENTS
    teds_error: int = 0
    sensors: tuple[PluggedSensor, ...] = ()
    missing: frozenset[int] = frozenset()
    swapped_teds: frozenset[int] = frozenset()


def device_names(inventory: Inventory) -> list[str]:
    """Return the names of chassis and modules."""
    modules = [f"{inventory.name}Mod{n + 1}" for n in range(inventory.modules)]
    return [inventory.name, *modules]


def input_number(inventory: Inventory, physical: str) -> int:
    """Return the number of an input, counted over all modules.

    Raises:
        Refusal: there is no such input.
    """
    device, _, name = physical.partition("/")
    names = device_names(inventory)[1:]
    local = [f"ai{n}" for n in range(INPUTS_PER_MODULE)]
    if device in names and name in local:
        number = names.index(device) * INPUTS_PER_MODULE + local.index(name)
        if number not in inventory.missing:
            return number
    raise Refusal(
        _NO_SUCH_CHANNEL,
        "Physical channel specified does not exist on this device.\n"
        f"Physical Channel: {physical}",
    )


def coerced_rate(inventory: Inventory, asked: float) -> float:
    """Return the actual rate of the modules: the next available one not below [Hz].

    Raises:
        Refusal: it is above the highest rate.
    """
    if not 0 < asked <= inventory.top_rate * (1 + 1e-9):
        raise Refusal(
            BAD_VALUE,
            "Requested value is not a supported value for this property.\n"
            f"Property: SampClk.Rate\nRequested Value: {asked:g}\n"
            f"Maximum Value: {inventory.top_rate:g}",
        )
    return inventory.top_rate / min(31, math.floor(inventory.top_rate / asked + 1e-9))


def require_current(inventory: Inventory, current: float) -> None:
    """Refuse a current that is not available [A].

    Raises:
        Refusal: as an NI module refuses it.
    """
    if not any(math.isclose(current, offered) for offered in inventory.currents):
        offered = "\n".join(f"{each:g}" for each in inventory.currents)
        raise Refusal(
            BAD_VALUE,
            "Requested value is not a supported value for this property.\n"
            f"Property: AI.CurrentExcit.Val\nRequested Value: {current:g}\n"
            f"You Can Select: {offered}",
        )
