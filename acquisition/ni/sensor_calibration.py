# SPDX-License-Identifier: MIT
"""What a session states of the calibration of its sensors, and when it is due."""

from datetime import date

from jointbench.acquisition.ni.sensors import Sensor


def sensor_entry(sensor: Sensor) -> dict[str, object]:
    """Return what the log of a session says of a sensor and its calibration."""
    facts: dict[str, object] = {
        "kind": "sensor",
        "name": sensor.name,
        "quantity": sensor.quantity.value,
        "serial": sensor.serial,
        "certificate": sensor.certificate,
    }
    if sensor.calibrated is not None:
        facts |= {
            "calibrated": sensor.calibrated.isoformat(),
            "due": _due(sensor.calibrated, sensor.calibration_months).isoformat(),
        }
    if sensor.sensitivity_sd is not None:
        facts["sensitivity_sd"] = sensor.sensitivity_sd
    return facts


def calibration_warning(sensor: Sensor, today: date) -> str | None:
    """Return a warning on the calibration of a sensor, or None."""
    if sensor.calibrated is None:
        return f"sensor {sensor.name!r}: no calibration date is stated"
    due = _due(sensor.calibrated, sensor.calibration_months)
    if today <= due:
        return None
    return (
        f"sensor {sensor.name!r} ({sensor.serial or 'no serial number'}): calibrated "
        f"{sensor.calibrated.isoformat()}, due {due.isoformat()}; have it calibrated"
    )


def _due(calibrated: date, months_valid: int) -> date:
    """Return the day until which a calibration holds."""
    months = calibrated.month - 1 + months_valid
    year, month = calibrated.year + months // 12, months % 12 + 1
    # The 28th, which every month has.
    return date(year, month, min(calibrated.day, 28))
