# SPDX-License-Identifier: MIT
"""The channel table: inputs and data of the sensors."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import date

from jointbench.acquisition.basics.errors import UsageError
from jointbench.acquisition.records.recordings import Channel, Quantity

_SAME_CURRENT = 0.06  # an NI 443x reports 2.1 mA, its data sheet states 2 mA


@dataclass(frozen=True, slots=True)
class Axis:
    """One direction of a sensor, on one input of the chassis.

    Attributes:
        physical: input, for example ``"cDAQ1Mod1/ai0"``.
        direction: ``"+z"`` and the like, in the axes of the structure.
        sensitivity: [V per SI unit].
    """

    physical: str
    direction: str
    sensitivity: float


@dataclass(frozen=True, slots=True)
class Sensor:
    """A sensor of one or three axes.

    Attributes:
        name: of its channels; with several axes a direction is added.
        quantity: measured quantity.
        point: its position; empty for a hammer.
        axes: one for each input.
        unit: unit of the table, for example ``"g"``; samples are SI throughout.
        range: largest value expected [SI unit].
        excitation: current of its built-in amplifier [A], 0 for none; None selects it
            from those of the module.
        coupling: ``"AC"`` or ``"DC"``.
        serial: serial number, empty if not stated.
        calibrated: day of the last calibration, None if not stated.
        calibration_months: how long a calibration holds.
        noise: rms of its noise by its data sheet [SI unit], None if not stated.
        certificate: number of the calibration certificate, empty if not stated.
        sensitivity_sd: relative standard uncertainty of the sensitivity [-], or None.
    """

    name: str
    quantity: Quantity
    point: str
    axes: tuple[Axis, ...]
    unit: str
    range: float
    excitation: float | None = None
    coupling: str = "AC"
    serial: str = ""
    calibrated: date | None = None
    calibration_months: int = 12
    noise: float | None = None
    certificate: str = ""
    sensitivity_sd: float | None = None


def require_unique(sensors: Sequence[Sensor]) -> None:
    """Check that no name and no input of a table is used twice.

    Raises:
        UsageError: one is.
    """
    names = [channel.name for channel in table_channels(sensors)]
    inputs = [axis.physical for sensor in sensors for axis in sensor.axes]
    for what, words in (("channel name", names), ("input", inputs)):
        twice = sorted({word for word in words if words.count(word) > 1})
        if twice:
            raise UsageError(
                f"{what} {twice[0]!r} is used twice in the channel table; each sensor "
                "and axis needs its own"
            )


def require_table(sensors: Sequence[Sensor]) -> None:
    """Check that a table fits a hammer session.

    Raises:
        UsageError: there is not exactly one force channel, no response, or a name or
            an input is used twice.
    """
    require_unique(sensors)
    forces = sum(len(s.axes) for s in sensors if s.quantity is Quantity.FORCE)
    moving = sum(len(s.axes) for s in sensors if s.quantity.is_motion)
    if forces != 1 or not moving:
        raise UsageError(
            f"the channel table has {forces} force channels and {moving} channels of a "
            "motion; a hammer session needs one hammer and at least one response"
        )


def table_channels(sensors: Sequence[Sensor]) -> tuple[Channel, ...]:
    """Return the channels of a table, in its order."""
    return tuple(
        Channel(
            name=channel_name(sensor, axis),
            quantity=sensor.quantity,
            point=sensor.point,
            direction=axis.direction,
            unit=sensor.unit,
            sensitivity=axis.sensitivity,
            range=sensor.range,
        )
        for sensor in sensors
        for axis in sensor.axes
    )


def channel_name(sensor: Sensor, axis: Axis) -> str:
    """Return the name of the channel of one axis, ``"a3x"`` for a triaxial ``a3``."""
    if len(sensor.axes) == 1:
        return sensor.name
    return sensor.name + axis.direction.lstrip("+-")


def excitation_current(sensor: Sensor, axis: Axis, offered: Sequence[float]) -> float:
    """Return the current to feed a sensor's amplifier with [A], 0 for none.

    Args:
        sensor: the sensor; its `excitation` is used where stated.
        axis: its input.
        offered: available currents above zero of the input's module [A]; empty where
            there are none, or they are not reported.

    Returns:
        The least available current if the sensor states none: an amplifier takes 2 mA
            to 20 mA, and only a cable of tens of metres needs more.

    Raises:
        UsageError: the module does not supply it, or none.
    """
    stated = sensor.excitation
    what = f"channel {channel_name(sensor, axis)!r} at {axis.physical}"
    if stated == 0 or (stated is not None and not offered):
        return stated
    if not offered:
        raise UsageError(
            f"{what}: the module offers no current for an IEPE sensor; use one that "
            "does, or state iepe = '0 mA' if the sensor has a supply of its own"
        )
    if stated is None:
        return min(offered)
    nearest = min(offered, key=lambda current: abs(current - stated))
    if abs(nearest - stated) <= _SAME_CURRENT * stated:
        return nearest
    amounts = ", ".join(f"{1e3 * current:g} mA" for current in sorted(offered))
    raise UsageError(
        f"{what}: iepe is {1e3 * stated:g} mA, the module offers {amounts}; state "
        "that, or leave iepe out"
    )
