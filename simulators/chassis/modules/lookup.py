# SPDX-License-Identifier: MIT
"""Devices and inputs by the names that a client gives."""

import re
from collections.abc import Iterator

from jointbench.simulators.chassis.modules.inventory import (
    Device,
    Input,
    Inventory,
    devices,
)
from jointbench.simulators.chassis.protocol import DAQmxErrors, Refusal

# "Dev1/ai0", "Dev1/ai0:3" or "Dev1/ai0:Dev1/ai3", in letters of either case; no device
# has inputs of more than a few digits.
_NAMED = re.compile(
    r"/?(?P<device>[^/:,]+)/ai(?P<first>\d{1,9})"
    r"(:(/?(?P=device)/ai)?(?P<last>\d{1,9}))?",
    re.IGNORECASE | re.ASCII,
)


def described(device: Device) -> str:
    """Return one line on a device, for a reader."""
    module = device.type
    currents = ", ".join(f"{1e3 * current:g} mA" for current in module.currents)
    return (
        f"{device.name} ({module.product}): {device.name}/ai0:{module.inputs - 1}, "
        f"+-{max(module.ranges):g} V, IEPE {currents or 'none'}, "
        f"to {module.rates.fastest / 1e3:g} kS/s"
    )


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
