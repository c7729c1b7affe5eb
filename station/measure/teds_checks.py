# SPDX-License-Identifier: MIT
"""What chassis and sensors say of themselves against what plan and table say."""

from collections.abc import Mapping, Sequence

from jointbench.acquisition.ni.driver import Chassis
from jointbench.acquisition.ni.sensors import Sensor, channel_name
from jointbench.station.measure.plan import MeasurePlan

NO_TRIGGER = (
    "trigger = 'hardware' asks for what a module of the table cannot do; the program "
    "looks for hits instead"
)


def by_device(plan: MeasurePlan, chassis: Chassis) -> bool:
    """Return whether the device shall trigger itself, and can.

    Args:
        plan: asks for it, or not.
        chassis: an open one.

    Raises:
        InstrumentError: the device does not answer.
    """
    if plan.acquisition.trigger != "hardware":
        return False
    used = {axis.physical.partition("/")[0] for s in plan.sensors for axis in s.axes}
    return all(m.analogue_trigger for m in chassis.modules() if m.name in used)


def teds_serials(chassis: Chassis, sensors: Sequence[Sensor]) -> dict[str, str | None]:
    """Return the serial number that each channel's sensor says itself, None without.

    Args:
        chassis: an open one.
        sensors: the channel table.

    Raises:
        InstrumentError: an input does not exist, or the device does not answer.
    """
    found = {
        channel_name(sensor, axis): chassis.teds(axis.physical)
        for sensor in sensors
        for axis in sensor.axes
    }
    return {
        name: None if one is None else str(one.serial) for name, one in found.items()
    }


def teds_words(
    serials: Mapping[str, str | None], sensors: Sequence[Sensor]
) -> dict[str, str]:
    """Return what the TEDS of each channel says against the table, for people."""
    words = {}
    for sensor in sensors:
        for axis in sensor.axes:
            name = channel_name(sensor, axis)
            found = serials[name]
            if found is None:
                words[name] = "no TEDS"
            elif not sensor.serial:
                words[name] = f"TEDS {found}, not in the table"
            elif found == sensor.serial:
                words[name] = "TEDS as in the table"
            else:
                words[name] = f"TEDS {found}: another sensor"
    return words


def teds_warnings(
    serials: Mapping[str, str | None], sensors: Sequence[Sensor]
) -> tuple[str, ...]:
    """Compare the serial number of every sensor that has a TEDS with the table.

    Args:
        serials: what the sensors say, by channel, as `teds_serials` reads it.
        sensors: the channel table.

    Returns:
        One line for each that differs; a sensor without a TEDS is taken at its word.
    """
    return tuple(
        f"channel {channel_name(sensor, axis)!r}: the sensor at {axis.physical} says "
        f"serial number {found}, the table says {sensor.serial}; check the plug or the "
        "table"
        for sensor in sensors
        if sensor.serial
        for axis in sensor.axes
        if (found := serials[channel_name(sensor, axis)]) not in (None, sensor.serial)
    )
