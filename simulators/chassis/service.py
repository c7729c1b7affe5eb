# SPDX-License-Identifier: MIT
"""NI's device service of the simulated chassis: devices and tasks.

Only the calls of a hammer session are implemented; every other call gets gRPC's answer
"unimplemented", as from an older server. Names of methods are NI's.
"""

# The methods carry the names that the protocol gives them.
# ruff: noqa: N802

import threading
from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar

import grpc

from jointbench.simulators.chassis import device_properties as properties
from jointbench.simulators.chassis import inventory as stock
from jointbench.simulators.chassis.inventory import Inventory
from jointbench.simulators.chassis.protocol import (
    AccelSensitivityUnits,
    AccelUnits,
    AcquisitionType,
    Daqmx,
    DAQmxErrors,
    ExcitationSource,
    ForceIEPESensorSensitivityUnits,
    ForceUnits,
    OverwriteMode,
    ReadRelativeTo,
    Refusal,
    Servicer,
    attribute_of,
    refuse,
)
from jointbench.simulators.chassis.task import SimulatedTask, TaskChannel, Trigger

_INVALID_TASK = DAQmxErrors.INVALID_TASK
_RISING = 10280
_STANDARD_GRAVITY = 9.80665
_CHANNEL_TYPE, _ANALOG_INPUT = 0x187F, 10100
_MEASUREMENT, _VOLTAGE, _AC = 0x0695, 10322, 10045
_POUND_FORCE = 4.4482216152605
_Answer = TypeVar("_Answer")
NewTask = Callable[[str], SimulatedTask]


def answered(
    method: Callable[[Any, Any, Any], _Answer],
) -> Callable[[Any, Any, Any], _Answer]:
    """Convert a `Refusal` raised in a method to the error of the protocol."""

    @wraps(method)
    def call(self: Any, request: Any, context: grpc.ServicerContext) -> _Answer:
        try:
            return method(self, request, context)
        except Refusal as refusal:
            refuse(context, refusal)
            raise  # `refuse` ends the call by an exception of its own

    return call


class DeviceService(Servicer):  # type: ignore[misc]
    """Calls about the devices of the chassis."""

    def __init__(self, inventory: Inventory) -> None:
        self.inventory = inventory

    @answered
    def GetSystemInfoAttributeUInt32(self, request: Any, context: Any) -> Any:
        """Answer for the version of the driver."""
        value = properties.DRIVER_VERSION.get(attribute_of(request), 0)
        return Daqmx.GetSystemInfoAttributeUInt32Response(value=value)

    @answered
    def GetSystemInfoAttributeString(self, request: Any, context: Any) -> Any:
        """Answer for the names of the devices."""
        names = ", ".join(stock.device_names(self.inventory))
        return Daqmx.GetSystemInfoAttributeStringResponse(value=names)

    @answered
    def GetDeviceAttributeString(self, request: Any, context: Any) -> Any:
        """Answer for product and channels."""
        text = properties.device_text(
            self.inventory, request.device_name, attribute_of(request)
        )
        return Daqmx.GetDeviceAttributeStringResponse(value=text)

    @answered
    def GetDeviceAttributeBool(self, request: Any, context: Any) -> Any:
        """Answer for boolean properties of the device."""
        flag = properties.device_flag(
            self.inventory, request.device_name, attribute_of(request)
        )
        return Daqmx.GetDeviceAttributeBoolResponse(value=flag)

    @answered
    def GetDeviceAttributeDouble(self, request: Any, context: Any) -> Any:
        """Answer for rates."""
        value = properties.device_number(
            self.inventory, request.device_name, attribute_of(request)
        )
        return Daqmx.GetDeviceAttributeDoubleResponse(value=value)

    @answered
    def GetDeviceAttributeUInt32(self, request: Any, context: Any) -> Any:
        """Answer for the serial number."""
        value = properties.device_number(
            self.inventory, request.device_name, attribute_of(request)
        )
        return Daqmx.GetDeviceAttributeUInt32Response(value=int(value))

    @answered
    def GetDeviceAttributeDoubleArray(self, request: Any, context: Any) -> Any:
        """Answer for ranges and currents."""
        values = properties.device_ranges(
            self.inventory, request.device_name, attribute_of(request)
        )
        return Daqmx.GetDeviceAttributeDoubleArrayResponse(value=values)

    @answered
    def GetPhysicalChanAttributeUInt32(self, request: Any, context: Any) -> Any:
        """Answer for the TEDS of a sensor."""
        value = properties.teds_number(
            self.inventory, request.physical_channel, attribute_of(request)
        )
        return Daqmx.GetPhysicalChanAttributeUInt32Response(value=value)


class TaskService(DeviceService):
    """Tasks: made, given channels and a clock, started and stopped.

    Attributes:
        tasks: by name of their session.
    """

    def __init__(self, inventory: Inventory, new_task: NewTask) -> None:
        super().__init__(inventory)
        self.tasks: dict[str, SimulatedTask] = {}
        self._new_task = new_task
        self._lock = threading.Lock()

    def task(self, request: Any) -> SimulatedTask:
        """Return the task of a request.

        Raises:
            Refusal: there is none; a restarted server has no earlier one.
        """
        found = self.tasks.get(request.task.name)
        if found is None:
            raise Refusal(
                _INVALID_TASK, "SimulatedTask specified is invalid or does not exist."
            )
        return found

    @answered
    def CreateTask(self, request: Any, context: Any) -> Any:
        """Make an empty task."""
        with self._lock:
            name = request.session_name or f"_unnamedTask<{len(self.tasks)}>"
            fresh = name not in self.tasks
            if fresh:
                self.tasks[name] = self._new_task(name)
        return Daqmx.CreateTaskResponse(
            task={"name": name}, new_session_initialized=fresh
        )

    @answered
    def ClearTask(self, request: Any, context: Any) -> Any:
        """Forget a task."""
        self.task(request).stop()
        with self._lock:
            del self.tasks[request.task.name]
        return Daqmx.ClearTaskResponse()

    @answered
    def StopTask(self, request: Any, context: Any) -> Any:
        """Stop the clock."""
        self.task(request).stop()
        return Daqmx.StopTaskResponse()

    @answered
    def CreateAIForceIEPEChan(self, request: Any, context: Any) -> Any:
        """Add a hammer or a load cell with a built-in amplifier."""
        units = request.sensitivity_units_raw or request.sensitivity_units
        self._require_current(request)
        per_newton = 1e-3 * request.sensitivity
        if units == ForceIEPESensorSensitivityUnits.MILLIVOLTS_PER_POUND.value:
            per_newton /= _POUND_FORCE
        returned = request.units_raw or request.units
        in_pounds = returned == ForceUnits.POUNDS.value
        self._add(request, per_newton * (_POUND_FORCE if in_pounds else 1.0))
        return Daqmx.CreateAIForceIEPEChanResponse()

    @answered
    def CreateAIAccelChan(self, request: Any, context: Any) -> Any:
        """Add an accelerometer."""
        units = request.sensitivity_units_raw or request.sensitivity_units
        self._require_current(request)
        in_volts = units == AccelSensitivityUnits.VOLTS_PER_G.value
        per_g = request.sensitivity * (1.0 if in_volts else 1e-3)
        returned = request.units_raw or request.units
        in_si = returned == AccelUnits.METERS_PER_SECOND_SQUARED.value
        self._add(request, per_g / (_STANDARD_GRAVITY if in_si else 1.0))
        return Daqmx.CreateAIAccelChanResponse()

    @answered
    def CreateAIVoltageChan(self, request: Any, context: Any) -> Any:
        """Add a plain voltage."""
        self._add(request, 1.0)
        return Daqmx.CreateAIVoltageChanResponse()

    def _require_current(self, request: Any) -> None:
        source = request.current_excit_source_raw or request.current_excit_source
        if source == ExcitationSource.INTERNAL.value:
            stock.require_current(self.inventory, request.current_excit_val)

    def _add(self, request: Any, sensitivity: float) -> None:
        number = stock.input_number(self.inventory, request.physical_channel)
        name = request.name_to_assign_to_channel or request.physical_channel
        self.task(request).channels.append(TaskChannel(name, number, sensitivity))

    @answered
    def SetChanAttributeInt32(self, request: Any, context: Any) -> Any:
        """Set the coupling of a channel."""
        task = self.task(request)
        task.coupling[request.channel] = request.value_raw or request.value
        return Daqmx.SetChanAttributeInt32Response()

    @answered
    def GetChanAttributeInt32(self, request: Any, context: Any) -> Any:
        """Answer for type, measurement and coupling of a channel."""
        task, attribute = self.task(request), attribute_of(request)
        fixed = {_CHANNEL_TYPE: _ANALOG_INPUT, _MEASUREMENT: _VOLTAGE}
        value = fixed.get(attribute, task.coupling.get(request.channel, _AC))
        return Daqmx.GetChanAttributeInt32Response(value_raw=value)

    @answered
    def CfgSampClkTiming(self, request: Any, context: Any) -> Any:
        """Set the clock; the rate is coerced as the module coerces it."""
        task = self.task(request)
        task.rate = stock.coerced_rate(self.inventory, request.rate)
        mode = request.sample_mode_raw or request.sample_mode
        finite = mode == AcquisitionType.FINITE.value
        task.finite = request.samps_per_chan if finite else None
        task.buffer = max(int(request.samps_per_chan), 10_000)
        return Daqmx.CfgSampClkTimingResponse()

    @answered
    def GetTimingAttributeDouble(self, request: Any, context: Any) -> Any:
        """Answer for the rate of the clock."""
        return Daqmx.GetTimingAttributeDoubleResponse(value=self.task(request).rate)

    @answered
    def SetBufferAttributeUInt32(self, request: Any, context: Any) -> Any:
        """Set the size of the input buffer."""
        self.task(request).buffer = int(request.value)
        return Daqmx.SetBufferAttributeUInt32Response()

    @answered
    def GetBufferAttributeUInt32(self, request: Any, context: Any) -> Any:
        """Answer for the size of the input buffer."""
        return Daqmx.GetBufferAttributeUInt32Response(value=self.task(request).buffer)

    @answered
    def CfgAnlgEdgeRefTrig(self, request: Any, context: Any) -> Any:
        """End a finite task some samples after an edge of a channel."""
        if not self.inventory.analogue_trigger:
            raise Refusal(
                stock.BAD_VALUE,
                "Requested value is not a supported value for this property.\n"
                "Property: RefTrig.Type\nRequested Value: Analog Edge",
            )
        task = self.task(request)
        names = [channel.name for channel in task.channels]
        if request.trigger_source not in names:
            raise Refusal(
                stock.BAD_VALUE,
                "Property: RefTrig.AnlgEdge.Src\nRequested Value: "
                f"{request.trigger_source}\nYou Can Select: {', '.join(names)}",
            )
        slope = request.trigger_slope_raw or request.trigger_slope
        task.trigger = Trigger(
            channel=names.index(request.trigger_source),
            level=request.trigger_level,
            before=request.pretrigger_samples,
            rising=slope == _RISING,
        )
        return Daqmx.CfgAnlgEdgeRefTrigResponse()

    @answered
    def GetTaskAttributeString(self, request: Any, context: Any) -> Any:
        """Answer for the names of the task or of its channels."""
        task = self.task(request)
        texts = {0x1276: task.name, 0x1273: ", ".join(c.name for c in task.channels)}
        value = texts.get(attribute_of(request), "")
        return Daqmx.GetTaskAttributeStringResponse(value=value)

    @answered
    def GetTaskAttributeUInt32(self, request: Any, context: Any) -> Any:
        """Answer for the number of channels."""
        count = len(self.task(request).channels)
        return Daqmx.GetTaskAttributeUInt32Response(value=count)

    @answered
    def SetReadAttributeInt32(self, request: Any, context: Any) -> Any:
        """Set the position of the next read, or the overwriting of unread samples."""
        task = self.task(request)
        value = request.value_raw or request.value
        if attribute_of(request) == 0x190A:
            task.relative_to_first = value == ReadRelativeTo.FIRST_SAMPLE.value
        elif attribute_of(request) == 0x190B:
            task.offset = value
        elif attribute_of(request) == 0x1211:
            task.overwrites = value == OverwriteMode.OVERWRITE_UNREAD_SAMPLES.value
        return Daqmx.SetReadAttributeInt32Response()
