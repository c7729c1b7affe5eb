# SPDX-License-Identifier: MIT
"""Driver, devices and sensors against the plan."""

from collections.abc import Iterator, Sequence
from datetime import date

from jointbench.acquisition.basics.errors import JointbenchError, UsageError
from jointbench.acquisition.ni.driver import Chassis
from jointbench.acquisition.ni.driver_answers import Module
from jointbench.acquisition.ni.module_limits import require_capable
from jointbench.acquisition.ni.sensor_calibration import (
    calibration_warning,
)
from jointbench.acquisition.ni.sensors import (
    Axis,
    Sensor,
    channel_name,
)
from jointbench.acquisition.records.recordings import Quantity
from jointbench.station.doctor.bench_finding import BenchFinding, bad, good, look

OPEN_RATE = 10_000.0
"""Sample rate of inputs without a plan, where a module reaches it [Hz]."""


def device_findings(modules: Sequence[Module]) -> Iterator[BenchFinding]:
    """Yield what devices with analogue inputs there are."""
    if not modules:
        yield bad(
            "devices",
            "chassis",
            "no device with analogue inputs",
            "check power and cable; NI MAX or `nilsdev` must list the modules",
        )
    for module in modules:
        kind = "simulated, " if module.simulated else ""
        trigger = "analogue trigger" if module.analogue_trigger else "no trigger"
        yield good(
            "devices",
            module.name,
            f"{module.product}, {kind}{len(module.inputs)} inputs, {trigger}",
        )


def sensor_findings(
    chassis: Chassis, sensors: Sequence[Sensor], *, sample_rate: float, today: date
) -> Iterator[BenchFinding]:
    """Yield how each sensor of a plan fits its input, its TEDS and its calibration.

    Args:
        chassis: an open one.
        sensors: the channel table.
        sample_rate: of the plan [Hz].
        today: for the calibration.
    """
    limits = chassis.limits()
    for sensor in sensors:
        for axis in sensor.axes:
            own = channel_name(sensor, axis)
            try:
                require_capable((sensor,), limits, sample_rate)
            except UsageError as error:
                yield bad("sensors", own, str(error), "change the plan or the wiring")
                continue
            yield _teds(chassis, sensor, axis)
        due = calibration_warning(sensor, today)
        if due is not None:
            seen, _, remedy = due.partition("; ")
            yield look(
                "sensors",
                sensor.name,
                seen,
                remedy or "write its date, for example calibrated = 2026-03-02",
            )


def _teds(chassis: Chassis, sensor: Sensor, axis: Axis) -> BenchFinding:
    own = channel_name(sensor, axis)
    try:
        found = chassis.teds(axis.physical)
    except JointbenchError as error:
        return look("sensors", own, f"TEDS cannot be read: {error}", "check the plug")
    fits = f"fits {axis.physical}"
    if found is None or not sensor.serial:
        number = f" (TEDS {found.serial})" if found is not None else ""
        return good("sensors", own, f"{fits}{number}")
    if str(found.serial) != sensor.serial:
        return bad(
            "sensors",
            own,
            f"{axis.physical} has the sensor {found.serial}, the plan {sensor.serial}",
            "plug the right sensor in, or correct serial and sensitivity in the plan",
        )
    return good("sensors", own, f"{fits}, TEDS {found.serial} as in the plan")


def open_inputs(chassis: Chassis, modules: Sequence[Module]) -> tuple[Sensor, ...]:
    """Return all inputs of the first device as voltages, for a bench without a plan."""
    limits = chassis.limits()
    first = modules[0]
    full = limits[first.name].range or 5.0
    couplings = limits[first.name].couplings or ("DC",)
    return tuple(
        Sensor(
            name=name.rpartition("/")[2],
            quantity=Quantity.VOLTAGE,
            point="",
            axes=(Axis(name, "", 1.0),),
            unit="V",
            range=full,
            excitation=0.0,
            coupling="DC" if "DC" in couplings else couplings[0],
        )
        for name in first.inputs
    )
