# SPDX-License-Identifier: MIT
"""Properties of virtual channels as a client reads and sets them."""

from collections.abc import Callable

from jointbench.simulators.chassis.property_values import Value
from jointbench.simulators.chassis.tasks.task import SimulatedTask
from jointbench.simulators.chassis.tasks.verification import verify_channels
from jointbench.simulators.chassis.tasks.virtual_channels import VirtualChannel

_ONLY_READ = ("AI_RAW_SAMP_SIZE", "AI_RESOLUTION", "CHAN_TYPE", "AI_MEAS_TYPE")


def get_channel(task: SimulatedTask, names: str, attribute: str) -> Value:
    """Return a property of the first of some channels.

    What the driver coerces is returned as coerced, after the task was verified.

    Raises:
        Refusal: there is no such channel or property, or the task cannot be verified.
    """
    channels = task.named(names)
    if not channels or attribute in _COERCED:
        verify_channels(task.channels)
    channel = channels[0]
    value = channel.values.get(attribute)
    return _COERCED[attribute](channel) if attribute in _COERCED else value


def set_channel(task: SimulatedTask, names: str, attribute: str, value: Value) -> None:
    """Set a property of channels.

    Raises:
        Refusal: there is no such channel or property, or the task is running.
    """
    task.change()
    for channel in task.named(names):
        channel.values.set(attribute, value)


def reset_channel(task: SimulatedTask, names: str, attribute: str) -> None:
    """Return a property of channels to its default.

    Raises:
        Refusal: there is no such channel or property, or the task is running.
    """
    task.change()
    for channel in task.named(names):
        channel.values.reset(attribute)


def _half(channel: VirtualChannel) -> float:
    return channel.range or max(channel.input.device.type.ranges)


_COERCED: dict[str, Callable[[VirtualChannel], Value]] = {
    "AI_MAX": lambda c: _half(c) / c.volts_per_unit,
    "AI_MIN": lambda c: -_half(c) / c.volts_per_unit,
    "AI_RNG_HIGH": _half,
    "AI_RNG_LOW": lambda c: -_half(c),
    "AI_COUPLING": lambda c: c.coupling,
    "AI_DEV_SCALING_COEFF": lambda c: (0.0, c.count, 0.0, 0.0),
}
