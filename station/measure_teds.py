# SPDX-License-Identifier: MIT
"""What the sensors say of themselves against what the channel table says of them."""

from collections.abc import Iterator, Sequence

from jointbench.acquisition.ni.driver import Chassis
from jointbench.acquisition.ni.sensors import Sensor, channel_name


def teds_warnings(chassis: Chassis, sensors: Sequence[Sensor]) -> tuple[str, ...]:
    """Compare the serial number of every sensor that has a TEDS with the table.

    Args:
        chassis: an open one.
        sensors: the channel table.

    Returns:
        One line for each that differs; a sensor without a TEDS is taken at its word.

    Raises:
        InstrumentError: an input does not exist, or nobody answers.
    """
    return tuple(_warnings(chassis, sensors))


def _warnings(chassis: Chassis, sensors: Sequence[Sensor]) -> Iterator[str]:
    for sensor in sensors:
        if not sensor.serial:
            continue
        for axis in sensor.axes:
            found = chassis.teds(axis.physical)
            if found is not None and str(found.serial) != sensor.serial:
                yield (
                    f"channel {channel_name(sensor, axis)!r}: the sensor at "
                    f"{axis.physical} says serial number {found.serial}, the table "
                    f"says {sensor.serial}; check the plug or the table"
                )
