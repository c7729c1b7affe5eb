# SPDX-License-Identifier: MIT
"""NI's calls that add analogue inputs to a task."""

# The methods carry the names that the protocol gives them.
# ruff: noqa: N802

import re
from collections.abc import Callable
from typing import Any

from jointbench.simulators.chassis.calls.answers import Calls, answered
from jointbench.simulators.chassis.modules.inventory import Input
from jointbench.simulators.chassis.modules.lookup import inputs_named
from jointbench.simulators.chassis.property_values import Value
from jointbench.simulators.chassis.protocol import (
    Daqmx,
    DAQmxErrors,
    Refusal,
    constants,
    number_of,
)
from jointbench.simulators.chassis.tasks import measured_quantities as kinds
from jointbench.simulators.chassis.tasks.channel_names import listed_names
from jointbench.simulators.chassis.tasks.measured_quantities import MeasuredQuantity
from jointbench.simulators.chassis.tasks.task import SimulatedTask
from jointbench.simulators.chassis.tasks.virtual_channels import new_channel

_DEFAULT = constants.TerminalConfiguration.DEFAULT.value
_NUMBERED = re.compile(r"(?P<stem>.*?)(?P<number>\d{0,9})", re.ASCII | re.DOTALL)
_CUSTOM = constants.VoltageUnits.FROM_CUSTOM_SCALE.value
_QUIETEST = 20e-6  # [Pa] at 0 dB


class ChannelCalls(Calls):
    """Voltage, and sensors that the module feeds."""

    @answered
    def CreateAIVoltageChan(self, request: Any, context: Any) -> Any:
        """Add a plain voltage."""
        self._add(request, kinds.VOLTAGE, _limits(request))
        return Daqmx.CreateAIVoltageChanResponse()

    @answered
    def CreateAIVoltageChanWithExcit(self, request: Any, context: Any) -> Any:
        """Add a voltage of a sensor that has a supply."""
        stated = _limits(request) | {
            "AI_EXCIT_SRC": number_of(request, "voltage_excit_source"),
            "AI_EXCIT_VAL": request.voltage_excit_val,
            "AI_EXCIT_USE_FOR_SCALING": request.use_excit_for_scaling,
        }
        self._add(request, kinds.EXCITED, stated)
        return Daqmx.CreateAIVoltageChanWithExcitResponse()

    @answered
    def CreateAIAccelChan(self, request: Any, context: Any) -> Any:
        """Add an accelerometer."""
        self._add(request, kinds.ACCELERATION, _fed(request, kinds.ACCELERATION))
        return Daqmx.CreateAIAccelChanResponse()

    @answered
    def CreateAIForceIEPEChan(self, request: Any, context: Any) -> Any:
        """Add a hammer or a load cell with a built-in amplifier."""
        self._add(request, kinds.FORCE, _fed(request, kinds.FORCE))
        return Daqmx.CreateAIForceIEPEChanResponse()

    @answered
    def CreateAIVelocityIEPEChan(self, request: Any, context: Any) -> Any:
        """Add a velocity sensor with a built-in amplifier."""
        self._add(request, kinds.VELOCITY, _fed(request, kinds.VELOCITY))
        return Daqmx.CreateAIVelocityIEPEChanResponse()

    @answered
    def CreateAIMicrophoneChan(self, request: Any, context: Any) -> Any:
        """Add a microphone; its limits follow from the highest sound pressure."""
        highest = _QUIETEST * 10 ** (request.max_snd_press_level / 20)
        stated = _supply(request) | {
            "AI_MICROPHONE_SENSITIVITY": request.mic_sensitivity,
            "AI_MAX": 2**0.5 * highest,
            "AI_MIN": -(2**0.5) * highest,
        }
        self._add(request, kinds.SOUND, stated)
        return Daqmx.CreateAIMicrophoneChanResponse()

    def _add(
        self, request: Any, measured: MeasuredQuantity, stated: dict[str, Value]
    ) -> None:
        task = self.task(request)
        stated[measured.units] = number_of(request, "units")
        if stated[measured.units] == _CUSTOM:
            raise Refusal(
                DAQmxErrors.CUSTOM_SCALE_DOES_NOT_EXIST,
                "Custom scale specified does not exist.\n\n"
                f"Custom Scale Name: {request.custom_scale_name}",
            )
        terminal = number_of(request, "terminal_config")
        if terminal != _DEFAULT:
            stated["AI_TERM_CFG"] = terminal
        inputs = inputs_named(self.inventory, request.physical_channel)
        names = _names(request.name_to_assign_to_channel, inputs)
        with task.guard:
            _require_stopped(task)
            _require_new(task, names)
            channels = [
                new_channel(name, at, measured, stated)
                for name, at in zip(names, inputs, strict=True)
            ]
            task.change()
            task.channels.extend(channels)


def _limits(request: Any) -> dict[str, Value]:
    return {"AI_MIN": request.min_val, "AI_MAX": request.max_val}


def _supply(request: Any) -> dict[str, Value]:
    source = number_of(request, "current_excit_source")
    return {"AI_EXCIT_SRC": source, "AI_EXCIT_VAL": request.current_excit_val}


def _fed(request: Any, measured: MeasuredQuantity) -> dict[str, Value]:
    units = number_of(request, "sensitivity_units")
    own: dict[str, Value] = {
        measured.sensitivity: request.sensitivity,
        f"{measured.sensitivity}_UNITS": units,
    }
    return _limits(request) | _supply(request) | own


def _names(given: str, inputs: list[Input]) -> list[str]:
    """Return the names of channels; the last one given is numbered for the rest.

    Source:
        NI-DAQmx help, Channel Name Generation: eight inputs and "foo31" give foo31 to
        foo38, "a0:3, b" gives a0 to a3 and b0 to b3.
    """
    if not given.strip():
        return [each.name for each in inputs]
    names = listed_names(given, at_most=len(inputs))
    if len(names) >= len(inputs):
        return names[: len(inputs)]
    last = names.pop()
    match = _NUMBERED.fullmatch(last)
    assert match is not None  # it matches any text
    rest = range(int(match["number"] or 0), int(match["number"] or 0) + len(inputs))
    stem = match["stem"].rstrip() if match["number"] else last
    return [*names, *(f"{stem}{n}" for n in rest)][: len(inputs)]


def _require_new(task: SimulatedTask, names: list[str]) -> None:
    known = [channel.name.lower() for channel in task.channels]
    for name in names:
        if name.lower() in known:
            raise Refusal(
                DAQmxErrors.CHAN_ALREADY_IN_TASK,
                "Specified channel cannot be added to the task, because a channel with "
                f"the same name is already in the task.\n\nChannel Name: {name}",
            )
        known.append(name.lower())


def _require_stopped(task: SimulatedTask) -> None:
    if task.running:
        raise Refusal(
            DAQmxErrors.CAN_NOT_PERFORM_OP_WHILE_TASK_RUNNING,
            "Specified operation cannot be performed while the task is running.\n\n"
            "Stop the task before adding a channel.",
        )


# Measurements of other hardware: refused as a module of this chassis refuses them.
_OTHER = (
    "CreateAIAccel4WireDCVoltageChan",
    "CreateAIAccelChargeChan",
    "CreateAIBridgeChan",
    "CreateAICalculatedPowerChan",
    "CreateAIChargeChan",
    "CreateAICurrentChan",
    "CreateAIPosEddyCurrProxProbeChan",
    "CreateAIPowerChan",
    "CreateAIRTDChan",
    "CreateAIResistanceChan",
    "CreateAIStrainGageChan",
    "CreateAITempBuiltInSensorChan",
    "CreateAIThrmcplChan",
)


def _other() -> Callable[[Any, Any, Any], Any]:
    def method(self: Any, request: Any, context: Any) -> Any:
        fields = request.DESCRIPTOR.fields_by_name
        name = "physical_channel" if "physical_channel" in fields else None
        if name:
            inputs_named(self.inventory, getattr(request, name))
        raise Refusal(
            DAQmxErrors.PHYS_CHAN_MEAS_TYPE,
            "Physical channel does not support the measurement type required by the "
            "virtual channel you are creating.",
        )

    return answered(method)


for _name in _OTHER:
    setattr(ChannelCalls, _name, _other())
