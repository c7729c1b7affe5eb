# SPDX-License-Identifier: MIT
"""What chassis and sensors say of themselves against what plan and table say."""

from collections.abc import Iterator, Sequence

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


def teds_warnings(chassis: Chassis, sensors: Sequence[Sensor]) -> tuple[str, ...]:
    """Compare the serial number of every sensor that has a TEDS with the table.

    Args:
        chassis: an open one.
        sensors: the channel table.

    Returns:
        One line for each that differs; a sensor without a TEDS is taken at its word.

    Raises:
        InstrumentError: an input does not exist, or the device does not answer.
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
