# SPDX-License-Identifier: MIT
"""Verification of a task: what NI-DAQmx refuses before it touches the hardware.

Source:
    NI-DAQmx help, Task State Model and the error codes; texts of -200077 and -50103 as
    users quote them. Where no quotation was found, the text is that of the help.
"""

from collections.abc import Sequence

from jointbench.simulators.chassis.modules.device_properties import (
    chassis_terminals,
    terminals,
)
from jointbench.simulators.chassis.modules.inventory import Device
from jointbench.simulators.chassis.modules.module_type import ModuleType
from jointbench.simulators.chassis.property_values import PropertyValues
from jointbench.simulators.chassis.protocol import (
    DAQmxErrors,
    Refusal,
    bad_value,
    constants,
)
from jointbench.simulators.chassis.tasks.virtual_channels import VirtualChannel

LEAST_SAMPLES = 2
_INTERNAL = constants.ExcitationSource.INTERNAL.value
_SAME_CURRENT = 1e-6  # [A]
# Names as NI's texts have them, by those of its Python package.
_AS_NI_WRITES = {
    "AI_ACCEL_SENSITIVITY": "AI_Accel_Sensitivity",
    "AI_FORCE_IEPE_SENSOR_SENSITIVITY": "AI_Force_IEPESensor_Sensitivity",
    "AI_VELOCITY_IEPE_SENSOR_SENSITIVITY": "AI_Velocity_IEPESensor_Sensitivity",
    "AI_MICROPHONE_SENSITIVITY": "AI_Microphone_Sensitivity",
    "PSEUDO_DIFF": "PseudoDiff",
    "DIFF": "Diff",
}


def verify_channels(channels: Sequence[VirtualChannel]) -> None:
    """Check the channels of a task against their modules.

    Raises:
        Refusal: there is none, or a module cannot do what one asks.
    """
    if not channels:
        raise Refusal(
            DAQmxErrors.CAN_NOT_PERFORM_OP_WHEN_NO_CHANS_IN_TASK,
            "Specified operation cannot be performed when there are no channels in "
            "the task.",
        )
    for channel in channels:
        _verify_sensor(channel)
        _verify_limits(channel)
        _verify_input(channel)
    _verify_distinct(channels)
    _verify_together([channel.input.device for channel in channels])


def _verify_sensor(channel: VirtualChannel) -> None:
    values, module = channel.values, channel.input.device.type
    name = channel.measured.sensitivity
    if name and not values.number(name) > 0:
        written = _AS_NI_WRITES[name]
        raise bad_value(written, values.number(name), low=0.0, channel=channel.name)
    if values.whole("AI_EXCIT_SRC") != _INTERNAL:
        return
    if not module.currents:
        none = constants.ExcitationSource.NONE
        choice = (f"DAQmx_Val_{none.name.title()}",)
        raise bad_value(
            "AI_Excit_Src", "DAQmx_Val_Internal", choice=choice, channel=channel.name
        )
    asked = values.number("AI_EXCIT_VAL")
    offered = (0.0, *module.currents)
    if not any(abs(asked - each) <= _SAME_CURRENT for each in offered):
        raise bad_value("AI_Excit_Val", asked, choice=offered, channel=channel.name)


def _verify_limits(channel: VirtualChannel) -> None:
    values, module = channel.values, channel.input.device.type
    low, high = values.number("AI_MIN"), values.number("AI_MAX")
    if not low < high:
        raise Refusal(
            DAQmxErrors.MIN_NOT_LESS_THAN_MAX,
            "Minimum value must be less than the maximum value.\n\n"
            f"Minimum Value: {low:g}\nMaximum Value: {high:g}\n"
            f"Channel Name: {channel.name}",
        )
    top = max(module.ranges) / channel.volts_per_unit
    if channel.range is None:
        which, asked = ("AI_Max", high) if abs(high) >= abs(low) else ("AI_Min", low)
        raise bad_value(which, asked, low=-top, high=top, channel=channel.name)


def _verify_input(channel: VirtualChannel) -> None:
    values, module = channel.values, channel.input.device.type
    couplings = {constants.Coupling[name].value: name for name in module.couplings}
    if channel.coupling not in couplings:
        choice = tuple(f"DAQmx_Val_{name}" for name in module.couplings)
        asked = constants.Coupling(channel.coupling).name
        raise bad_value(
            "AI_Coupling", f"DAQmx_Val_{asked}", choice=choice, channel=channel.name
        )
    if channel.current and channel.coupling != constants.Coupling.AC.value:
        raise bad_value(
            "AI_Coupling",
            "DAQmx_Val_DC",
            choice=("DAQmx_Val_AC",),
            channel=channel.name,
        )
    kind = constants.TerminalConfiguration
    offered = {kind[name].value for name in (*module.terminals, "DEFAULT")}
    if values.whole("AI_TERM_CFG") not in offered:
        choice = tuple(
            f"DAQmx_Val_{_AS_NI_WRITES.get(name, name)}" for name in module.terminals
        )
        asked = kind(values.whole("AI_TERM_CFG")).name
        asked = _AS_NI_WRITES.get(asked, asked)
        raise bad_value(
            "AI_TermCfg", f"DAQmx_Val_{asked}", choice=choice, channel=channel.name
        )


def _verify_distinct(channels: Sequence[VirtualChannel]) -> None:
    """Refuse an input that is used twice; a scanning converter reads it twice."""
    seen: set[int] = set()
    for channel in channels:
        if channel.input.number in seen and channel.input.device.type.simultaneous:
            raise Refusal(
                DAQmxErrors.REPEATED_AI_PHYSICAL_CHAN,
                "Specified physical channel appears in the task more than once. The "
                "device samples its channels simultaneously and does not support "
                "this.\n\n"
                f"Physical Channel Name: {channel.input.name}",
            )
        seen.add(channel.input.number)


def _verify_together(used: Sequence[Device]) -> None:
    """Refuse devices that cannot share a clock: not of one chassis, nor alike.

    Source:
        NI-DAQmx help, Multidevice Tasks: modules of one chassis, or boards of one kind
        that a trigger bus connects.
    """
    groups = {each.chassis or each.name for each in used}
    alike = len({each.type.product for each in used}) == 1
    boards = all(each.type.product.startswith("PCI") for each in used)
    if len(groups) > 1 and not (alike and boards):
        names = ", ".join(dict.fromkeys(each.name for each in used))
        raise Refusal(
            DAQmxErrors.MULTI_DEVS_IN_TASK,
            "Specified task contains channels on devices that cannot be in one "
            f"task.\n\nCreate a task for each device.\n\nDevices: {names}",
        )


def verify_mode(timing: PropertyValues, used: Sequence[Device]) -> None:
    """Refuse single points timed by hardware on a bus that cannot wait for them.

    Raises:
        Refusal: the mode is that, and a device is in a chassis or on USB.
    """
    kind = constants.AcquisitionType
    boards = all(each.type.product.startswith("PCI") for each in used)
    mode = timing.whole("SAMP_QUANT_SAMP_MODE")
    if mode == kind.HW_TIMED_SINGLE_POINT.value and not boards:
        choice = ("DAQmx_Val_FiniteSamps", "DAQmx_Val_ContSamps")
        raise bad_value(
            "SampQuant_SampMode", "DAQmx_Val_HWTimedSinglePoint", choice=choice
        )


def require_clock(channels: Sequence[VirtualChannel]) -> None:
    """Refuse a task without a sample clock on a delta-sigma converter.

    Raises:
        Refusal: a device of the task needs the rate.

    Source:
        nidaqwrapper, issues 5 and 6: what a task without timing gives on such devices.
    """
    if any(module.rates.rule != "timebase" for module in _modules(channels)):
        raise Refusal(
            DAQmxErrors.SAMP_CLK_RATE_MUST_BE_SPECD,
            "Task contains physical channels on one or more devices that require you "
            "to specify the Sample Clock rate. Use the Sample Clock Timing function/VI "
            "to specify a Sample Clock rate.",
        )


def coerced_rate(channels: Sequence[VirtualChannel], asked: float) -> float:
    """Return the rate that the modules of a task take for a request [Hz].

    Raises:
        Refusal: a module does not reach it, or no clock is as slow.
    """
    modules = _modules(channels)
    scanning = any(not module.simultaneous for module in modules)
    shared = len(channels) if scanning and len(channels) > 1 else 1
    top = min(module.rates.fastest for module in modules)
    # One converter for all inputs: half its top rate, shared by the channels.
    top = 0.5 * top / shared if shared > 1 else top
    low = 0.0 if any(_divides(m) for m in modules) else max(_slowest(modules))
    if not max(low, LEAST_RATE) <= asked <= top * (1 + 1e-9):
        raise bad_value("SampClk_Rate", asked, low=max(low, LEAST_RATE), high=top)
    # Converters with a divided clock set the pace of the others.
    first = next((m for m in modules if _divides(m)), modules[0])
    return first.rates.taken(asked)


# The slowest clock of a chassis: 100 kHz over a counter of 32 bits [Hz].
LEAST_RATE = 100e3 / 2**32


def _divides(module: ModuleType) -> bool:
    return module.rates.rule == "divided"


def _slowest(modules: Sequence[ModuleType]) -> list[float]:
    return [module.rates.slowest for module in modules]


def _modules(channels: Sequence[VirtualChannel]) -> list[ModuleType]:
    return [channel.input.device.type for channel in channels]


def verify_samples(timing: PropertyValues) -> None:
    """Refuse a block that is too short.

    Raises:
        Refusal: fewer than two samples.
    """
    samples = timing.whole("SAMP_QUANT_SAMP_PER_CHAN")
    if samples < LEAST_SAMPLES:
        raise bad_value(
            "SampQuant_SampPerChan", samples, low=LEAST_SAMPLES, high=2**32 - 1
        )


def terminal(own: Device, all_: Sequence[Device], named: str) -> str:
    """Return the full name of a terminal.

    Args:
        own: device of the task, to which a name without a device belongs.
        all_: devices whose terminals can be routed to it.
        named: terminal, ``"PFI0"`` or ``"/Dev1/PFI0"``.

    Raises:
        Refusal: no device has it.
    """
    full = named if named.startswith("/") else f"/{own.name}/{named}"
    chassis = {each.chassis for each in all_ if each.chassis}
    lines = [line for name in chassis for line in chassis_terminals(name)]
    lines += [line for each in all_ for line in terminals(each)]
    known = {line.lower(): line for line in lines}
    analogue = {f"/{each.name}/apfi{n}".lower() for each in all_ for n in (0, 1)}
    if full.lower() not in known and full.lower() not in analogue:
        raise Refusal(
            DAQmxErrors.INVALID_ROUTING_SOURCE_TERMINAL_NAME_ROUTING,
            "Source terminal to be routed could not be found on the device.\n\n"
            "Make sure the terminal name is valid for the specified device.\n\n"
            f"Property: Terminal\nSource Terminal: {named}",
        )
    return known.get(full.lower(), full)
