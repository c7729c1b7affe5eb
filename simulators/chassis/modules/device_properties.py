# SPDX-License-Identifier: MIT
"""Properties of the system, of its devices and of their physical channels."""

from collections.abc import Callable

from jointbench.simulators.chassis.modules.inventory import (
    TIMING_ENGINES,
    Device,
    Inventory,
    devices,
)
from jointbench.simulators.chassis.modules.lookup import (
    device_named,
    device_names,
    inputs_named,
)
from jointbench.simulators.chassis.property_values import Value
from jointbench.simulators.chassis.protocol import DAQmxErrors, Refusal, constants

_CHASSIS_PRODUCT = "cDAQ-9178"
_CHASSIS_LINES = 2  # trigger inputs of a cDAQ-9178, on BNC connectors
_VERSION = {
    "NIDAQ_MAJOR_VERSION": 24,
    "NIDAQ_MINOR_VERSION": 5,
    "NIDAQ_UPDATE_VERSION": 0,
}
_SAVED_IN_MAX = ("GLOBAL_CHANS", "SCALES", "TASKS")
_TEDS = ("MFG_ID", "MODEL_NUM", "SERIAL_NUM", "VERSION_NUM")
# Bits of DAQmx_AI_TrigUsage: reference and start.
_TRIGGERS = 4 + 8
_COUPLING_BITS = {"AC": 1, "DC": 2}
_SERIAL = 0x51000000


def system_value(inventory: Inventory, name: str) -> Value:
    """Return a property of the system."""
    if name == "DEV_NAMES":
        return ", ".join(device_names(inventory))
    if name in _SAVED_IN_MAX:
        return ""
    if name in _VERSION:
        return _VERSION[name]
    raise _unknown(name)


def device_value(inventory: Inventory, name: str, attribute: str) -> Value:
    """Return a property of a device.

    Raises:
        Refusal: there is no such device, or it has no such property.
    """
    device = device_named(inventory, name)
    if device is None:
        return _of_chassis(inventory, attribute)
    if attribute not in _OF_DEVICE:
        raise _unknown(attribute)
    value = _OF_DEVICE[attribute](device)
    if value == ():
        raise _unknown(attribute)
    return value


def measurements() -> tuple[int, ...]:
    """Return the types of measurement of every module.

    A sensor that has a supply of its own can be read by every module.
    """
    usage = constants.UsageTypeAI
    offered = (
        usage.VOLTAGE,
        usage.ACCELERATION_ACCELEROMETER_CURRENT_INPUT,
        usage.FORCE_IEPE_SENSOR,
        usage.VELOCITY_IEPE_SENSOR,
        usage.SOUND_PRESSURE_MICROPHONE,
    )
    return tuple(each.value for each in offered)


def input_value(inventory: Inventory, physical: str, attribute: str) -> Value:
    """Return a property of a physical channel; most are of its sensor's TEDS.

    Raises:
        Refusal: there is no such input or property, or no sensor with a TEDS.
    """
    try:
        (found,) = inputs_named(inventory, physical)[:1]
    except Refusal as refusal:
        # Of a physical channel without a device, the driver says the same.
        code = DAQmxErrors.PHYSICAL_CHAN_DOES_NOT_EXIST
        raise Refusal(code, str(refusal)) from refusal
    short = attribute.removeprefix("PHYSICAL_CHAN_")
    if short == "AI_SUPPORTED_MEAS_TYPES":
        return measurements()
    if short == "AI_TERM_CFGS":
        bits = {"RSE": 1, "NRSE": 2, "DIFF": 4, "PSEUDO_DIFF": 8}
        return sum(bits[terminal] for terminal in found.device.type.terminals)
    if not short.startswith("TEDS_"):
        raise _unknown(attribute)
    if not found.device.type.teds:
        raise Refusal(
            DAQmxErrors.TEDS_NOT_SUPPORTED,
            f"TEDS is not supported by this device.\nChannel: {physical}",
        )
    return _teds_number(inventory, found.number, physical, short)


def _teds_number(
    inventory: Inventory, number: int, physical: str, attribute: str
) -> int:
    if inventory.teds_error:
        raise Refusal(inventory.teds_error, f"No TEDS to read.\nChannel: {physical}")
    if number >= len(inventory.sensors):
        raise Refusal(
            DAQmxErrors.TEDS_SENSOR_NOT_DETECTED,
            f"No TEDS sensor was detected.\nChannel: {physical}",
        )
    sensor = inventory.sensors[number]
    serial = sensor.serial + (90_000 if number in inventory.swapped_teds else 0)
    numbers = (sensor.manufacturer, sensor.model, serial, 1)
    named = dict(zip(_TEDS, numbers, strict=True))
    if attribute.removeprefix("TEDS_") not in named:
        raise _unknown(attribute)
    return named[attribute.removeprefix("TEDS_")]


def _of_chassis(inventory: Inventory, attribute: str) -> Value:
    modules = (each.name for each in devices(inventory) if each.chassis)
    category = constants.ProductCategory.COMPACT_DAQ_CHASSIS
    values: dict[str, Value] = {
        "PRODUCT_TYPE": _CHASSIS_PRODUCT,
        "PRODUCT_CATEGORY": category.value,
        "BUS_TYPE": constants.BusType.USB.value,
        "SERIAL_NUM": _SERIAL,
        "IS_SIMULATED": True,
        "CHASSIS_MODULE_DEV_NAMES": ", ".join(modules),
        "AI_NUM_SAMP_TIMING_ENGINES": TIMING_ENGINES,
        "ANLG_TRIG_SUPPORTED": False,
        "DIG_TRIG_SUPPORTED": True,
        "TERMINALS": ", ".join(chassis_terminals(inventory.name)),
        **dict.fromkeys(_EMPTY, ""),
    }
    values["AI_PHYSICAL_CHANS"] = ""
    if attribute not in values:
        raise _unknown(attribute)
    return values[attribute]


_EMPTY = (
    "AO_PHYSICAL_CHANS",
    "DI_LINES",
    "DI_PORTS",
    "DO_LINES",
    "DO_PORTS",
    "CI_PHYSICAL_CHANS",
    "CO_PHYSICAL_CHANS",
    "ACCESSORY_PRODUCT_TYPES",
)


def chassis_terminals(name: str) -> tuple[str, ...]:
    """Return the trigger inputs of a chassis, which every module can use."""
    return tuple(f"/{name}/PFI{n}" for n in range(_CHASSIS_LINES))


def terminals(device: Device) -> tuple[str, ...]:
    """Return the terminals of a device that trigger or clock a task."""
    lines = tuple(f"/{device.name}/PFI{n}" for n in range(device.type.digital_lines))
    own = ("ai/SampleClock", "ai/SampleClockTimebase", "ai/StartTrigger")
    return lines + tuple(f"/{device.name}/{name}" for name in own)


def _category(device: Device) -> int:
    return int(constants.ProductCategory[device.type.category].value)


def _bus(device: Device) -> int:
    product, bus = device.type.product, constants.BusType
    if device.chassis:
        return int(bus.COMPACT_DAQ.value)
    return int((bus.PCIE if product.startswith("PCIe") else bus.USB).value)


def _ranges(device: Device) -> Value:
    pairs = ((-half, half) for half in device.type.ranges)
    return tuple(value for pair in pairs for value in pair)


def _modes(device: Device) -> Value:
    kind = constants.AcquisitionType
    return (kind.FINITE.value, kind.CONTINUOUS.value)


def _names(device: Device) -> str:
    return ", ".join(f"{device.name}/ai{n}" for n in range(device.type.inputs))


def _aggregate(device: Device) -> float:
    """Return the top rate of several channels [Hz]; one converter halves it."""
    return device.type.rates.fastest / (1 if device.type.simultaneous else 2)


_OF_DEVICE: dict[str, Callable[[Device], Value]] = {
    "PRODUCT_TYPE": lambda d: d.type.product,
    "PRODUCT_CATEGORY": _category,
    "PRODUCT_NUM": lambda d: 0,
    "BUS_TYPE": _bus,
    "SERIAL_NUM": lambda d: _SERIAL + 1 + d.first,
    "IS_SIMULATED": lambda d: True,
    "ANLG_TRIG_SUPPORTED": lambda d: d.type.analogue_trigger,
    "DIG_TRIG_SUPPORTED": lambda d: bool(d.type.digital_lines or d.chassis),
    "TEDS_HWTEDS_SUPPORTED": lambda d: d.type.teds,
    "TIME_TRIG_SUPPORTED": lambda d: False,
    "AI_SIMULTANEOUS_SAMPLING_SUPPORTED": lambda d: d.type.simultaneous,
    "AI_PHYSICAL_CHANS": _names,
    "AI_SUPPORTED_MEAS_TYPES": lambda d: measurements(),
    "AI_MAX_SINGLE_CHAN_RATE": lambda d: d.type.rates.fastest,
    "AI_MAX_MULTI_CHAN_RATE": _aggregate,
    "AI_MIN_RATE": lambda d: d.type.rates.taken(d.type.rates.slowest),
    "AI_SAMP_MODES": _modes,
    "AI_NUM_SAMP_TIMING_ENGINES": lambda d: 1,
    "AI_TRIG_USAGE": lambda d: _TRIGGERS,
    "AI_COUPLINGS": lambda d: sum(_COUPLING_BITS[c] for c in d.type.couplings),
    "AI_VOLTAGE_RNGS": _ranges,
    "AI_GAINS": lambda d: tuple(max(d.type.ranges) / half for half in d.type.ranges),
    "AI_CURRENT_INT_EXCIT_DISCRETE_VALS": lambda d: d.type.currents,
    "COMPACT_DAQ_CHASSIS_DEV_NAME": lambda d: d.chassis or _refused("no chassis"),
    "COMPACT_DAQ_SLOT_NUM": lambda d: d.slot,
    "CHASSIS_MODULE_DEV_NAMES": lambda d: "",
    "TERMINALS": lambda d: ", ".join(terminals(d)),
    **{name: lambda d: "" for name in _EMPTY},
}


def _refused(name: str) -> Value:
    raise _unknown(name)


def _unknown(attribute: str) -> Refusal:
    return Refusal(
        DAQmxErrors.ATTR_NOT_SUPPORTED,
        "Specified property is not supported by the device.\n\n"
        f"Property: DAQmx_{attribute}",
    )
