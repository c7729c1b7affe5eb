# SPDX-License-Identifier: MIT
"""Types of measurement of an analogue input."""

from dataclasses import dataclass

from jointbench.simulators.chassis.protocol import constants

_USAGE = constants.UsageTypeAI


@dataclass(frozen=True, slots=True)
class MeasuredQuantity:
    """A type of measurement.

    Attributes:
        usage: NI's number of it.
        sensitivity: property with the sensitivity; its units have ``_UNITS``.
        units: property with the unit of the values returned.
    """

    usage: int
    sensitivity: str
    units: str


VOLTAGE = MeasuredQuantity(_USAGE.VOLTAGE.value, "", "AI_VOLTAGE_UNITS")
EXCITED = MeasuredQuantity(
    _USAGE.VOLTAGE_CUSTOM_WITH_EXCITATION.value, "", "AI_VOLTAGE_UNITS"
)
ACCELERATION = MeasuredQuantity(
    _USAGE.ACCELERATION_ACCELEROMETER_CURRENT_INPUT.value,
    "AI_ACCEL_SENSITIVITY",
    "AI_ACCEL_UNITS",
)
FORCE = MeasuredQuantity(
    _USAGE.FORCE_IEPE_SENSOR.value, "AI_FORCE_IEPE_SENSOR_SENSITIVITY", "AI_FORCE_UNITS"
)
VELOCITY = MeasuredQuantity(
    _USAGE.VELOCITY_IEPE_SENSOR.value,
    "AI_VELOCITY_IEPE_SENSOR_SENSITIVITY",
    "AI_VELOCITY_UNITS",
)
SOUND = MeasuredQuantity(
    _USAGE.SOUND_PRESSURE_MICROPHONE.value,
    "AI_MICROPHONE_SENSITIVITY",
    "AI_SOUND_PRESSURE_UNITS",
)
