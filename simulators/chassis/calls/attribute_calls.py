# SPDX-License-Identifier: MIT
"""NI's calls that get, set and reset a property: one method for all of them.

The protocol has a call for each kind of object and type of value. All are built here
from the list of its calls; a property is known by the name that the protocol gives it.
"""

import re
from collections.abc import Callable
from functools import cache
from typing import Any

from jointbench.simulators.chassis.calls.answers import Calls, answered
from jointbench.simulators.chassis.calls.channel_properties import (
    get_channel,
    reset_channel,
    set_channel,
)
from jointbench.simulators.chassis.calls.task_properties import (
    get_property,
    reset_property,
    set_property,
)
from jointbench.simulators.chassis.modules.device_properties import (
    device_value,
    input_value,
    system_value,
)
from jointbench.simulators.chassis.property_values import Value
from jointbench.simulators.chassis.protocol import (
    Daqmx,
    DAQmxErrors,
    Refusal,
    number_of,
)

_CALL = re.compile(
    r"(?P<verb>Get|Set|Reset)(?P<kind>[A-Z]\w+?)Attribute(?P<ex>Ex)?"
    r"(?P<type>Bool|Double|DoubleArray|Int32|Int32Array|String|Timestamp|UInt32|"
    r"UInt32Array|UInt64|Bytes)?"
)
# Kinds of objects, as calls and as enumerations of properties name them.
_KINDS = {
    "Buffer": "Buffer",
    "Chan": "Channel",
    "Device": "Device",
    "ExportedSignal": "ExportSignal",
    "PhysicalChan": "PhysicalChannel",
    "Read": "Read",
    "SystemInfo": "System",
    "Task": "Task",
    "Timing": "Timing",
    "Trig": "Trigger",
}
# The client reads this number without a name before it reads "all available".
_SAMPLES_TO_READ = {0x31E8: "DEFAULT_NUMBER_OF_SAMPLES_TO_READ"}


@cache
def property_names(kind: str) -> dict[int, str]:
    """Return the properties of a kind of object by their numbers."""
    prefix = _KINDS[kind]
    found = dict(_SAMPLES_TO_READ) if kind == "Read" else {}
    for name, enumeration in Daqmx.DESCRIPTOR.enum_types_by_name.items():
        if re.fullmatch(rf"{prefix}[A-Z]\w*Attribute", name):
            for value in enumeration.values:
                found[value.number] = value.name.partition("_ATTRIBUTE_")[2]
    return found


def _property(kind: str, request: Any) -> str:
    number = number_of(request, "attribute")
    return property_names(kind).get(number, f"{number:#x}")


def _read(calls: Calls, kind: str, request: Any) -> Value:
    name = _property(kind, request)
    if kind == "SystemInfo":
        return system_value(calls.inventory, name)
    if kind == "Device":
        return device_value(calls.inventory, request.device_name, name)
    if kind == "PhysicalChan":
        return input_value(calls.inventory, request.physical_channel, name)
    task = calls.task(request)
    with task.guard:
        if kind == "Chan":
            return get_channel(task, request.channel, name)
        return get_property(task, kind, name)


def _write(calls: Calls, kind: str, request: Any, value: Value) -> None:
    task, name = calls.task(request), _property(kind, request)
    with task.guard:
        if kind == "Chan":
            set_channel(task, request.channel, name, value)
        else:
            set_property(task, kind, name, value)


def _reset(calls: Calls, kind: str, request: Any) -> None:
    task, name = calls.task(request), _property(kind, request)
    with task.guard:
        if kind == "Chan":
            reset_channel(task, request.channel, name)
        else:
            reset_property(task, kind, name)


def _no_device_context(request: Any) -> None:
    """Refuse a property of timing of one device: those here are of the whole task."""
    if request.device_names:
        raise Refusal(
            DAQmxErrors.M_STUDIO_OPERATION_DOES_NOT_SUPPORT_DEVICE_CONTEXT,
            "Operation does not support device context: the property applies to the "
            "whole task.",
        )


def _handler(call: str, match: "re.Match[str]") -> Callable[[Any, Any, Any], Any]:
    kind, verb = match["kind"], match["verb"]
    response = getattr(Daqmx, f"{call}Response")

    def method(self: Any, request: Any, context: Any) -> Any:
        if match["ex"]:
            _no_device_context(request)
        if verb == "Get":
            return _filled(response, _read(self, kind, request))
        if verb == "Set":
            _write(self, kind, request, _sent(request))
        else:
            _reset(self, kind, request)
        return response()

    return answered(method)


def _sent(request: Any) -> Value:
    """Return the value of a request: enumerated, an array, or plain."""
    if "value_raw" in request.DESCRIPTOR.fields_by_name:
        return number_of(request, "value")
    value = request.value
    if isinstance(value, bool | int | float | str):
        return value
    return tuple(value)


def _filled(response: Any, value: Value) -> Any:
    fields = response.DESCRIPTOR.fields_by_name
    return response(**{"value_raw" if "value_raw" in fields else "value": value})


class AttributeCalls(Calls):
    """Every call of the protocol about a property of a known kind of object."""


for _name in (
    each.name for each in Daqmx.DESCRIPTOR.services_by_name["NiDAQmx"].methods
):
    _match = _CALL.fullmatch(_name)
    if _match and _match["kind"] in _KINDS:
        setattr(AttributeCalls, _name, _handler(_name, _match))
