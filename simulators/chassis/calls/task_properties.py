# SPDX-License-Identifier: MIT
"""Properties of a task as a client reads and sets them: timing, triggers, reading."""

from collections.abc import Callable

from jointbench.simulators.chassis.property_values import (
    PropertyValues,
    Value,
    not_supported,
)
from jointbench.simulators.chassis.tasks.task import SimulatedTask

# Properties that steer the reading of a running task.
_WHILE_RUNNING = (
    "AUTO_START",
    "CHANNELS_TO_READ",
    "LOGGING_PAUSE",
    "OFFSET",
    "OVERWRITE",
    "READ_ALL_AVAIL_SAMP",
    "RELATIVE_TO",
    "SLEEP_TIME",
    "WAIT_MODE",
)


def get_property(task: SimulatedTask, kind: str, name: str) -> Value:
    """Return a property; those of timing after the task was verified.

    Raises:
        Refusal: there is none, or the task cannot be verified.
    """
    computed = _COMPUTED[kind]
    if name in computed:
        return computed[name](task)
    value = _table(task, kind, name).get(name)
    if kind == "Timing" and task.channels:
        task.verify()
    if name.endswith("TRIG_SRC") and value:
        return _source(task, str(value))
    return value


def set_property(task: SimulatedTask, kind: str, name: str, value: Value) -> None:
    """Set a property.

    Raises:
        Refusal: there is none, or the task is running.
    """
    if kind != "Read" or name not in _WHILE_RUNNING:
        task.change()
    if name == "SAMP_CLK_TIMEBASE_DIV":
        _table(task, kind, "SAMP_CLK_RATE").set(
            "SAMP_CLK_RATE", _timebase(task) / float(str(value))
        )
        return
    if name == "CHANNELS_TO_READ":
        task.named(str(value))
    _table(task, kind, name).set(name, value)


def reset_property(task: SimulatedTask, kind: str, name: str) -> None:
    """Return a property to its default.

    Raises:
        Refusal: there is none, or the task is running.
    """
    if kind != "Read" or name not in _WHILE_RUNNING:
        task.change()
    if name == "SAMP_CLK_TIMEBASE_DIV":
        name = "SAMP_CLK_RATE"
    _table(task, kind, name).reset(name)


def _table(task: SimulatedTask, kind: str, name: str) -> PropertyValues:
    tables = {
        "Timing": task.timing,
        "Trig": task.triggers,
        "Read": task.reading,
        "Buffer": task.buffers,
        "ExportedSignal": task.exports,
    }
    if kind not in tables:
        raise not_supported(name)
    return tables[kind]


def _source(task: SimulatedTask, source: str) -> str:
    """Return the full name of a trigger's terminal; a channel keeps its own."""
    names = [channel.name.lower() for channel in task.channels]
    inputs = [channel.input.name.lower() for channel in task.channels]
    if source.lower() in names + inputs or not task.channels:
        return source
    return task.terminal(source)


def _clock_source(task: SimulatedTask) -> Value:
    task.verify()
    stated = task.timing.text("SAMP_CLK_SRC")
    if not stated or stated == "OnboardClock":
        return f"/{task.devices[0].name}/ai/SampleClockTimebase"
    return task.terminal(stated)


def _timebase(task: SimulatedTask) -> float:
    """Return the clock that the sample clock divides [Hz]."""
    rates = task.devices[0].type.rates
    return rates.clock or rates.fastest


def _divisor(task: SimulatedTask) -> Value:
    return round(_timebase(task) / task.verify().rate)


def _samples_to_read(task: SimulatedTask) -> Value:
    """Return how many samples "all available" means now."""
    if not task.clocked:
        return 1
    finite = task.finite
    if finite is not None and not task.reading.get("READ_ALL_AVAIL_SAMP"):
        return finite
    return available(task)


def available(task: SimulatedTask) -> int:
    """Return the unread samples per channel."""
    if task.acquisition is None:
        return 0
    return max(0, task.acquisition.acquired() - task.acquisition.position)


def _acquired(task: SimulatedTask) -> Value:
    return 0 if task.acquisition is None else task.acquisition.acquired()


def _position(task: SimulatedTask) -> Value:
    return 0 if task.acquisition is None else task.acquisition.position


def _names(task: SimulatedTask) -> Value:
    return ", ".join(channel.name for channel in task.channels)


def _read_names(task: SimulatedTask) -> Value:
    return ", ".join(task.channels[n].name for n in task.read_channels())


def _width(task: SimulatedTask) -> Value:
    """Return the bytes of one raw sample of all channels."""
    sizes = (channel.values.whole("AI_RAW_SAMP_SIZE") for channel in task.channels)
    return sum(sizes) // 8


def _overloads(task: SimulatedTask) -> list[str]:
    if not any(device.type.overload_detection for device in task.devices):
        raise not_supported("Read_OverloadedChansExist")
    return [c.name for c in task.channels if c.name in task.overloaded]


def _open(task: SimulatedTask) -> list[str]:
    if not any(device.type.currents for device in task.devices):
        raise not_supported("Read_OpenCurrentLoopChansExist")
    return task.open_loops


def _overloaded(task: SimulatedTask) -> Value:
    found = _overloads(task)
    task.overloaded.clear()
    return ", ".join(found)


_COMPUTED: dict[str, dict[str, Callable[[SimulatedTask], Value]]] = {
    "Task": {
        "NAME": lambda t: t.name,
        "CHANNELS": _names,
        "DEVICES": lambda t: ", ".join(device.name for device in t.devices),
        "NUM_CHANS": lambda t: len(t.channels),
        "NUM_DEVICES": lambda t: len(t.devices),
        "COMPLETE": lambda t: t.acquisition is None or t.acquisition.done(),
    },
    "Timing": {
        "SAMP_CLK_SRC": _clock_source,
        "SAMP_CLK_RATE": lambda t: t.verify().rate if t.clocked else t.rate,
        "SAMP_CLK_MAX_RATE": lambda t: min(d.type.rates.fastest for d in t.devices),
        "SAMP_CLK_TIMEBASE_DIV": _divisor,
        "SAMP_CLK_TIMEBASE_RATE": _timebase,
        "SAMP_CLK_TIMEBASE_SRC": _clock_source,
        "SAMP_CLK_TERM": lambda t: f"/{t.devices[0].name}/ai/SampleClock",
    },
    "Read": {
        "AVAIL_SAMP_PER_CHAN": available,
        "CHANNELS_TO_READ": _read_names,
        "CURR_READ_POS": _position,
        "DEFAULT_NUMBER_OF_SAMPLES_TO_READ": _samples_to_read,
        "NUM_CHANS": lambda t: len(t.read_channels()),
        "OPEN_CURRENT_LOOP_CHANS": lambda t: ", ".join(_open(t)),
        "OPEN_CURRENT_LOOP_CHANS_EXIST": lambda t: bool(_open(t)),
        "OVERLOADED_CHANS": _overloaded,
        "OVERLOADED_CHANS_EXIST": lambda t: bool(_overloads(t)),
        "RAW_DATA_WIDTH": _width,
        "TOTAL_SAMP_PER_CHAN_ACQUIRED": _acquired,
    },
    "Buffer": {"INPUT_BUF_SIZE": lambda t: t.buffer},
    "Trig": {},
    "ExportedSignal": {},
}
