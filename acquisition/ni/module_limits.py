# SPDX-License-Identifier: MIT
"""What the modules of a channel table can do, against what the table asks of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.ni.error_codes import reported
from jointbench.acquisition.ni.sensors import Axis, Sensor, channel_name

_ROUNDING = 1e-6  # relative, of a range converted between units


@dataclass(frozen=True, slots=True, kw_only=True)
class ModuleLimits:
    """Limits of one module; what a driver does not report is None.

    Attributes:
        product: for example ``"NI 9234"``.
        inputs: its analogue inputs.
        range: largest input of either sign [V].
        top_rate: highest samples per second and channel [Hz].
        couplings: offered, ``AC`` and ``DC``.
    """

    product: str
    inputs: tuple[str, ...]
    range: float | None
    top_rate: float | None
    couplings: tuple[str, ...] | None


def device_limits(device: Any) -> ModuleLimits:
    """Return the limits that a device of `nidaqmx` reports."""
    ranges = reported(lambda: device.ai_voltage_rngs)
    couplings = reported(lambda: [kind.name for kind in device.ai_couplings])
    return ModuleLimits(
        product=device.product_type,
        inputs=tuple(device.ai_physical_chans.channel_names),
        range=max(ranges) if ranges else None,
        top_rate=reported(lambda: device.ai_max_multi_chan_rate),
        couplings=tuple(couplings) if couplings else None,
    )


def require_capable(
    sensors: Sequence[Sensor], modules: Mapping[str, ModuleLimits], sample_rate: float
) -> None:
    """Check a channel table and a rate against the modules, before a task is made.

    Args:
        sensors: the channel table.
        modules: limits by name of the device.
        sample_rate: requested [Hz].

    Raises:
        UsageError: a module cannot do it; the message states what it can.
    """
    for sensor in sensors:
        for axis in sensor.axes:
            name = axis.physical.strip("/").partition("/")[0]
            if name not in modules:
                raise UsageError(
                    f"channel {channel_name(sensor, axis)!r} at {axis.physical}: there "
                    f"is no device {name!r}; found: {', '.join(modules) or 'none'}"
                )
            _require_channel(sensor, axis, modules[name], sample_rate)


def _require_channel(
    sensor: Sensor, axis: Axis, module: ModuleLimits, sample_rate: float
) -> None:
    where = f"channel {channel_name(sensor, axis)!r} at {axis.physical}"
    if axis.physical.strip("/") not in module.inputs:
        first, last = module.inputs[0], module.inputs[-1]
        raise UsageError(
            f"{where}: the {module.product} has the inputs {first} to {last}; move the "
            "sensor to one of them, or to another module"
        )
    volts = sensor.range * axis.sensitivity
    if module.range is not None and volts > module.range * (1 + _ROUNDING):
        raise UsageError(
            f"{where}: its range is {volts:.3g} V at the input, the {module.product} "
            f"takes +-{module.range:g} V; reduce the range to "
            f"{module.range / volts:.0%}, or use a less sensitive sensor"
        )
    if module.couplings is not None and sensor.coupling not in module.couplings:
        offered = " and ".join(module.couplings)
        raise UsageError(
            f"{where}: coupling is {sensor.coupling}, the {module.product} offers "
            f"{offered}; write coupling = {module.couplings[0]!r}"
        )
    if module.top_rate is not None and sample_rate > module.top_rate * (1 + _ROUNDING):
        raise UsageError(
            f"{where}: sample_rate is {sample_rate / 1e3:g} kHz, the {module.product} "
            f"reaches {module.top_rate / 1e3:g} kHz; write that, or less"
        )
