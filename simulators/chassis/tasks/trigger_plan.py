# SPDX-License-Identifier: MIT
"""Triggers of a task: verified, and as searches in volts."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from jointbench.simulators.chassis.property_values import PropertyValues
from jointbench.simulators.chassis.protocol import (
    DAQmxErrors,
    Refusal,
    bad_value,
    constants,
)
from jointbench.simulators.chassis.tasks.edge_search import EdgeSearch
from jointbench.simulators.chassis.tasks.virtual_channels import VirtualChannel

_KIND = constants.TriggerType
_LEAST = 2  # samples before and after a reference trigger
_RISING = constants.Slope.RISING.value
_ENTERING = constants.WindowTriggerCondition1.ENTERING_WINDOW.value
_IMMEDIATE = EdgeSearch(channel=-1)


@dataclass(frozen=True, slots=True)
class TriggerPlan:
    """Triggers of a task.

    Attributes:
        start: starts the task, None for at once.
        reference: ends it, None for after its samples.
        before: samples kept before the reference.
        retriggers: the start trigger starts another block each time.
    """

    start: EdgeSearch | None = None
    reference: EdgeSearch | None = None
    before: int = 0
    retriggers: bool = False


def trigger_plan(
    triggers: PropertyValues,
    channels: Sequence[VirtualChannel],
    *,
    clocked: bool,
    finite: int | None,
    terminal: Callable[[str], str],
) -> TriggerPlan:
    """Return the triggers of a task.

    Args:
        triggers: properties.
        channels: of the task.
        clocked: it has a sample clock.
        finite: samples of the block, None for a continuous task.
        terminal: finds a terminal by its name, or refuses it.

    Raises:
        Refusal: they do not fit each other, the timing, or the hardware.
    """
    kinds = [triggers.whole(f"{which}_TYPE") for which in ("START_TRIG", "REF_TRIG")]
    if not clocked and any(kind != _KIND.NONE.value for kind in kinds):
        raise Refusal(
            DAQmxErrors.TRIG_WHEN_ON_DEMAND_SAMP_TIMING,
            "Specified trigger type is not valid for on-demand sample timing.",
        )
    for which in ("START_TRIG", "REF_TRIG"):
        if triggers.whole(f"{which}_TYPE") == _KIND.DIGITAL_EDGE.value:
            terminal(triggers.text(f"DIG_EDGE_{which}_SRC"))
    start = _search(triggers, "START_TRIG", channels)
    reference = _search(triggers, "REF_TRIG", channels)
    before = triggers.whole("REF_TRIG_PRETRIG_SAMPLES")
    if reference is not None:
        _verify_reference(before, finite)
    again = bool(triggers.get("START_TRIG_RETRIGGERABLE")) and start is not None
    return TriggerPlan(start, reference, before if reference else 0, again)


def _verify_reference(before: int, finite: int | None) -> None:
    if finite is None:
        raise Refusal(
            DAQmxErrors.REF_TRIG_WHEN_CONTINUOUS,
            "Reference trigger is not supported when the sample mode is continuous. "
            "Set the sample mode to finite, or use a start trigger.",
        )
    if before < _LEAST:
        raise bad_value("RefTrig_PretrigSamples", before, low=_LEAST, high=finite)
    if before + _LEAST > finite:
        raise Refusal(
            DAQmxErrors.TOO_MANY_PRETRIG_PLUS_MIN_POST_TRIG_SAMPS,
            "Number of pretrigger samples per channel plus the minimum number of "
            "posttrigger samples exceeds the number of samples per channel.\n\n"
            f"Property: DAQmx_RefTrig_PretrigSamples\nRequested Value: {before}\n"
            f"Number of Samples Per Channel: {finite}\n"
            f"Minimum Number of Posttrigger Samples: {_LEAST}",
        )


def _search(
    triggers: PropertyValues, which: str, channels: Sequence[VirtualChannel]
) -> EdgeSearch | None:
    kind = triggers.whole(f"{which}_TYPE")
    if kind == _KIND.NONE.value:
        return None
    if kind == _KIND.DIGITAL_EDGE.value:
        return _IMMEDIATE
    kinds = {_KIND.ANALOG_EDGE.value: "EDGE", _KIND.ANALOG_WINDOW.value: "WIN"}
    trigger_name = "RefTrig" if which == "REF_TRIG" else "StartTrig"
    capable = all(channel.input.device.type.analogue_trigger for channel in channels)
    if kind not in kinds or not capable:
        names = ("DAQmx_Val_DigEdge", "DAQmx_Val_None")
        asked = f"DAQmx_Val_{_KIND(kind).name.title().replace('_', '')}"
        raise bad_value(f"{trigger_name}_Type", asked, choice=names)
    prefix = f"ANLG_{kinds[kind]}_{which}"
    return _analogue(triggers, prefix, trigger_name, channels)


def _analogue(
    triggers: PropertyValues,
    prefix: str,
    trigger_name: str,
    channels: Sequence[VirtualChannel],
) -> EdgeSearch:
    source = triggers.text(f"{prefix}_SRC")
    edge = prefix.startswith("ANLG_EDGE")
    named = f"Anlg{'Edge' if edge else 'Win'}_{trigger_name}"
    if re.search(r"apfi[01]$", source.lower()) and not channels[0].input.device.chassis:
        return _IMMEDIATE
    index = _source_index(source, named, channels)
    channel, scale = channels[index], channels[index].volts_per_unit
    levels = ("LVL",) if edge else ("TOP", "BTM")
    for level in levels:
        _verify_level(
            triggers.number(f"{prefix}_{level}"), f"{named}_{level.title()}", channel
        )
    if edge:
        return EdgeSearch(
            channel=index,
            level=scale * triggers.number(f"{prefix}_LVL"),
            rising=triggers.whole(f"{prefix}_SLOPE") == _RISING,
            hysteresis=scale * triggers.number(f"{prefix}_HYST"),
        )
    return EdgeSearch(
        channel=index,
        level=scale * triggers.number(f"{prefix}_TOP"),
        bottom=scale * triggers.number(f"{prefix}_BTM"),
        rising=triggers.whole(f"{prefix}_WHEN") == _ENTERING,
    )


def _source_index(source: str, named: str, channels: Sequence[VirtualChannel]) -> int:
    wanted = source.strip("/").lower()
    for index, channel in enumerate(channels):
        if wanted in (channel.name.lower(), channel.input.name.lower()):
            return index
    choice = tuple(channel.name for channel in channels)
    raise bad_value(f"{named}_Src", source, choice=choice)


def _verify_level(level: float, named: str, channel: VirtualChannel) -> None:
    half = channel.range or max(channel.input.device.type.ranges)
    top = half / channel.volts_per_unit
    if not abs(level) <= top * (1 + 1e-9):
        raise bad_value(named, level, low=-top, high=top, channel=channel.name)
