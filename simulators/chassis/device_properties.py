# SPDX-License-Identifier: MIT
"""Properties of the devices of the simulated chassis."""

from jointbench.simulators.chassis.inventory import (
    INPUTS_PER_MODULE,
    Inventory,
    device_names,
    input_number,
)
from jointbench.simulators.chassis.protocol import DAQmxErrors, Refusal

_PRODUCT = "NI 9234"
DRIVER_VERSION = {0x1272: 24, 0x1923: 5, 0x2F22: 0}
_NO_SUCH_DEVICE = DAQmxErrors.INVALID_DEVICE_ID
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


def device_text(inventory: Inventory, device: str, attribute: int) -> str:
    """Return a text property of a device."""
    place = _place(inventory, device)
    if attribute == _PRODUCT_TYPE:
        return _PRODUCT if place else "cDAQ-9178"
    if attribute == _CHANNELS:
        inputs = range(INPUTS_PER_MODULE if place else 0)
        return ", ".join(f"{device}/ai{n}" for n in inputs)
    raise _unknown(attribute)


def device_flag(inventory: Inventory, device: str, attribute: int) -> bool:
    """Return a boolean property of a device."""
    _place(inventory, device)
    if attribute == _SIMULATED:
        return True
    if attribute == _ANALOG_TRIGGER:
        return inventory.analogue_trigger
    raise _unknown(attribute)


def device_number(inventory: Inventory, device: str, attribute: int) -> float:
    """Return a numeric property of a device."""
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
