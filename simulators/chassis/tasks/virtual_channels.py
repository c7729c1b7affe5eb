# SPDX-License-Identifier: MIT
"""Virtual channels: an input, what it measures, and its scale."""

from dataclasses import dataclass

from jointbench.simulators.chassis.modules.inventory import Input
from jointbench.simulators.chassis.property_values import PropertyValues, Value
from jointbench.simulators.chassis.protocol import constants
from jointbench.simulators.chassis.tasks.measured_quantities import (
    SOUND,
    MeasuredQuantity,
)

_STANDARD_GRAVITY = 9.80665
_POUND_FORCE = 4.4482216152605
_INCH = 0.0254
_INTERNAL = constants.ExcitationSource.INTERNAL.value
_NO_SOURCE = constants.ExcitationSource.NONE.value

# Volts in one unit of a sensitivity, and the SI units that these volts stand for.
_ACCELERATION = constants.AccelSensitivityUnits
_FORCE = constants.ForceIEPESensorSensitivityUnits
_VELOCITY = constants.VelocityIEPESensorSensitivityUnits
_SENSITIVITIES = {
    _ACCELERATION.MILLIVOLTS_PER_G.value: (1e-3, _STANDARD_GRAVITY),
    _ACCELERATION.VOLTS_PER_G.value: (1.0, _STANDARD_GRAVITY),
    _FORCE.MILLIVOLTS_PER_NEWTON.value: (1e-3, 1.0),
    _FORCE.MILLIVOLTS_PER_POUND.value: (1e-3, _POUND_FORCE),
    _VELOCITY.MILLIVOLTS_PER_MILLIMETER_PER_SECOND.value: (1e-3, 1e-3),
    _VELOCITY.MILLIVOLTS_PER_INCH_PER_SECOND.value: (1e-3, _INCH),
}
# SI units in one unit of the values returned.
_RETURNED = {
    constants.AccelUnits.G.value: _STANDARD_GRAVITY,
    constants.AccelUnits.METERS_PER_SECOND_SQUARED.value: 1.0,
    constants.AccelUnits.INCHES_PER_SECOND_SQUARED.value: _INCH,
    constants.ForceUnits.NEWTONS.value: 1.0,
    constants.ForceUnits.POUNDS.value: _POUND_FORCE,
    constants.VelocityUnits.METERS_PER_SECOND.value: 1.0,
    constants.VelocityUnits.INCHES_PER_SECOND.value: _INCH,
    constants.SoundPressureUnits.PA.value: 1.0,
    constants.VoltageUnits.VOLTS.value: 1.0,
}


@dataclass(frozen=True, slots=True, eq=False)
class VirtualChannel:
    """A channel of a task.

    Attributes:
        name: as the client called it.
        input: measured.
        measured: what.
        values: its properties.
    """

    name: str
    input: Input
    measured: MeasuredQuantity
    values: PropertyValues

    @property
    def volts_per_unit(self) -> float:
        """Volts at the input for one unit of the values returned.

        Raises:
            Refusal: a unit is of another measurement, or of a custom scale.
        """
        units = _RETURNED[self.values.whole(self.measured.units)]
        name = self.measured.sensitivity
        if not name:
            divides = self.values.get("AI_EXCIT_USE_FOR_SCALING")
            return units * (self.values.number("AI_EXCIT_VAL") if divides else 1.0)
        stated = self.values.number(name)
        if self.measured is SOUND:
            return 1e-3 * stated * units
        volts, unit = _SENSITIVITIES[self.values.whole(f"{name}_UNITS")]
        return stated * volts / unit * units

    @property
    def range(self) -> float | None:
        """Range that the driver selects [V], None where the module has none."""
        scale, values = self.volts_per_unit, self.values
        if values.changed("AI_RNG_HIGH") or values.changed("AI_RNG_LOW"):
            low, high = values.number("AI_RNG_LOW"), values.number("AI_RNG_HIGH")
        else:
            low, high = (scale * values.number(name) for name in ("AI_MIN", "AI_MAX"))
        return self.input.device.type.range_for(low, high)

    @property
    def count(self) -> float:
        """Volts of one count of the converter."""
        half = self.range or max(self.input.device.type.ranges)
        return half / 2.0 ** (self.input.device.type.bits - 1)

    @property
    def current(self) -> float:
        """Current of the internal supply [A]; 0 for none."""
        if self.values.whole("AI_EXCIT_SRC") != _INTERNAL:
            return 0.0
        return self.values.number("AI_EXCIT_VAL")

    @property
    def coupling(self) -> int:
        """NI's number of the coupling; AC for a sensor that the module feeds."""
        kind = constants.Coupling
        if self.values.changed("AI_COUPLING"):
            return self.values.whole("AI_COUPLING")
        fed = self.current and "AC" in self.input.device.type.couplings
        return int((kind.AC if fed else kind.DC).value)


def new_channel(
    name: str, at: Input, measured: MeasuredQuantity, stated: dict[str, Value]
) -> VirtualChannel:
    """Return a channel with the stated properties."""
    channel = VirtualChannel(
        name, at, measured, PropertyValues(_defaults(at, measured))
    )
    for key, value in stated.items():
        channel.values.set(key, value)
    return channel


def _defaults(at: Input, measured: MeasuredQuantity) -> dict[str, Value]:
    module = at.device.type
    terminal = constants.TerminalConfiguration[module.terminals[0]].value
    values: dict[str, Value] = {
        "AI_MEAS_TYPE": measured.usage,
        "AI_MAX": max(module.ranges),
        "AI_MIN": -max(module.ranges),
        "AI_TERM_CFG": terminal,
        "AI_COUPLING": 0,
        "AI_EXCIT_SRC": _NO_SOURCE,
        "AI_EXCIT_VAL": 0.0,
        "AI_EXCIT_USE_FOR_SCALING": False,
        "AI_RNG_HIGH": max(module.ranges),
        "AI_RNG_LOW": -max(module.ranges),
        "AI_RAW_SAMP_SIZE": 16 if module.bits <= 16 else 32,
        "AI_RESOLUTION": float(module.bits),
        "AI_LOSSY_LSB_REMOVAL_COMPRESSED_SAMP_SIZE": module.bits,
        "AI_DEV_SCALING_COEFF": (),
        "CHAN_DESCR": "",
        "CHAN_IS_GLOBAL": False,
        "CHAN_TYPE": constants.ChannelType.ANALOG_INPUT.value,
        "PHYSICAL_CHAN_NAME": at.name,
        "AI_CUSTOM_SCALE_NAME": "",
        measured.units: constants.VoltageUnits.VOLTS.value,
    }
    if measured.sensitivity:
        values[measured.sensitivity] = 0.0
        values[f"{measured.sensitivity}_UNITS"] = 0
    if module.filter_delay:
        values["AI_FILTER_DELAY"] = module.filter_delay
    return values
