# SPDX-License-Identifier: MIT
"""What is in the simulated chassis: modules of four IEPE inputs, what they can do."""

import math
from dataclasses import dataclass

from jointbench.simulators.chassis.protocol import DAQmxErrors, Refusal
from jointbench.simulators.plates.plates_bench import PluggedSensor

INPUTS_PER_MODULE = 4
_PRODUCT = "NI 9234"
DRIVER_VERSION = {0x1272: 24, 0x1923: 5, 0x2F22: 0}
CURRENTS = (0.002,)  # [A], of an NI 9234
_NO_SUCH_CHANNEL = DAQmxErrors.PHYSICAL_CHAN_DOES_NOT_EXIST
_NO_SUCH_DEVICE = DAQmxErrors.INVALID_DEVICE_ID
BAD_VALUE = DAQmxErrors.INVALID_ATTRIBUTE_VALUE
_NO_TEDS = DAQmxErrors.TEDS_SENSOR_NOT_DETECTED
UNKNOWN_ATTRIBUTE = DAQmxErrors.SPECIFIED_ATTR_NOT_VALID
_PRODUCT_TYPE, _SERIAL, _CHANNELS = 0x631, 0x632, 0x231E
_ANALOG_TRIGGER, _SIMULATED = 0x2984, 0x22CA
_MAX_RATES, _MIN_RATE, _RANGES = (0x298C, 0x298D), 0x298E, 0x2990
_CURRENTS = 0x29CB
_TEDS_MANUFACTURER, _TEDS_MODEL, _TEDS_SERIAL, _TEDS_VERSION = (
    0x21DA,
    0x21DB,
    0x21DC,
    0x21DD,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Inventory:
    """The chassis.

    Attributes:
        name: of the chassis; its modules are ``<name>Mod1`` and so on.
        modules: how many.
        top_rate: samples per second and channel at the most [Hz]; slower rates are
            this one over a whole number.
        analogue_trigger: whether the modules can trigger on a signal.
        currents: that the modules offer to IEPE sensors [A]; empty for none.
        teds_error: number of NI's error that ends every question for a TEDS, 0 for
            none.
        sensors: plugged into the first inputs.
        missing: inputs that are refused.
        swapped_teds: inputs at which a wrong TEDS answers.
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
    """Return the rate that the modules really run at: the next one not below [Hz].

    Raises:
        Refusal: it is above what the modules can do.
    """
    if not 0 < asked <= inventory.top_rate * (1 + 1e-9):
        raise Refusal(
            BAD_VALUE,
            "Requested value is not a supported value for this property.\n"
            f"Property: SampClk.Rate\nRequested Value: {asked:g}\n"
            f"Maximum Value: {inventory.top_rate:g}",
        )
    return inventory.top_rate / min(31, math.floor(inventory.top_rate / asked + 1e-9))


def device_text(inventory: Inventory, device: str, attribute: int) -> str:
    """Return a text about a device."""
    place = _place(inventory, device)
    if attribute == _PRODUCT_TYPE:
        return _PRODUCT if place else "cDAQ-9178"
    if attribute == _CHANNELS:
        inputs = range(INPUTS_PER_MODULE if place else 0)
        return ", ".join(f"{device}/ai{n}" for n in inputs)
    raise _unknown(attribute)


def device_flag(inventory: Inventory, device: str, attribute: int) -> bool:
    """Return a yes or no about a device."""
    _place(inventory, device)
    if attribute == _SIMULATED:
        return True
    if attribute == _ANALOG_TRIGGER:
        return inventory.analogue_trigger
    raise _unknown(attribute)


def device_number(inventory: Inventory, device: str, attribute: int) -> float:
    """Return a number about a device."""
    place = _place(inventory, device)
    if attribute in _MAX_RATES:
        return inventory.top_rate
    if attribute == _MIN_RATE:
        return inventory.top_rate / 31
    if attribute == _SERIAL:
        return 0x51000000 + place
    raise _unknown(attribute)


def device_ranges(inventory: Inventory, device: str, attribute: int) -> list[float]:
    """Return pairs of input ranges [V], or the currents for IEPE sensors [A]."""
    place = _place(inventory, device)
    if attribute == _RANGES:
        return [-5.0, 5.0]
    if attribute == _CURRENTS and place and inventory.currents:
        return list(inventory.currents)
    raise _unknown(attribute)


def require_current(inventory: Inventory, current: float) -> None:
    """Refuse a current that the modules do not offer [A].

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


def teds_number(inventory: Inventory, physical: str, attribute: int) -> int:
    """Return a number out of the TEDS of the sensor at an input.

    Raises:
        Refusal: no sensor with a TEDS is plugged in.
    """
    number = input_number(inventory, physical)
    if inventory.teds_error:
        raise Refusal(inventory.teds_error, f"No TEDS to read.\nChannel: {physical}")
    if number >= len(inventory.sensors):
        raise Refusal(_NO_TEDS, f"No TEDS sensor was detected.\nChannel: {physical}")
    sensor = inventory.sensors[number]
    serial = sensor.serial + (90_000 if number in inventory.swapped_teds else 0)
    numbers = {
        _TEDS_MANUFACTURER: sensor.manufacturer,
        _TEDS_MODEL: sensor.model,
        _TEDS_SERIAL: serial,
        _TEDS_VERSION: 1,
    }
    if attribute not in numbers:
        raise _unknown(attribute)
    return numbers[attribute]


def _place(inventory: Inventory, device: str) -> int:
    """Return 0 for the chassis, n for its n-th module."""
    names = device_names(inventory)
    if device not in names:
        raise Refusal(_NO_SUCH_DEVICE, f"Device identifier is invalid: {device}")
    return names.index(device)


def _unknown(attribute: int) -> Refusal:
    return Refusal(
        UNKNOWN_ATTRIBUTE, f"Specified property is not supported: {attribute:#x}"
    )
