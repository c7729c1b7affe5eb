# SPDX-License-Identifier: MIT
"""The plan of a measurement (TOML): channel table, points, levels, torques, settings.

::

    operator = "A. Miller"
    [acquisition]
    sample_rate = "25.6 kHz"
    [hits]
    points = ["1", "2"]
    levels = ["100 N"]          # peak force to aim at; left out, any level
    torques = ["20 N m", "50 N m"]
    repeats = 3
    [[sensors]]
    name = "force"
    quantity = "force"
    sensitivity = "2.25 mV/N"
    physical = "cDAQ1Mod1/ai0"
    range = "2000 N"

A triaxial sensor lists ``axes``, each with its own input, direction and sensitivity.
"""

import re
from datetime import date
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field, model_validator

from jointbench.acquisition.basics.errors import UnitError, UsageError
from jointbench.acquisition.basics.units import parse_sensitivity, parse_value
from jointbench.acquisition.ni.sensors import Axis, Sensor
from jointbench.acquisition.records.recordings import Quantity
from jointbench.acquisition.serial_lines.instruments import torque_tester
from jointbench.station.files.toml_file import StrictTable
from jointbench.station.schemas.bolt_force_table import BoltForceTable
from jointbench.station.schemas.positive_quantities import (
    Force,
    Frequency,
    Length,
    Share,
    Time,
    Torque,
)

_SECONDS_IN_A_MINUTE = 60.0
_FED = (Quantity.FORCE, Quantity.ACCELERATION, Quantity.PRESSURE)
"""Quantities whose sensors have a built-in amplifier unless the plan has iepe = 0."""


class AxisTable(StrictTable):
    """One axis of a sensor: its input, its direction, its sensitivity as text."""

    physical: str = Field(min_length=1)
    direction: str = Field(pattern=r"^[+-][A-Za-z][A-Za-z0-9]*$")
    sensitivity: str


class PlanSensorTable(StrictTable):
    """A sensor, of one axis (given right here) or of several (`axes`)."""

    name: str = Field(min_length=1, max_length=40)
    quantity: Quantity
    point: str = ""
    physical: str | None = None
    direction: str = Field(default="+z", pattern=r"^[+-][A-Za-z][A-Za-z0-9]*$")
    sensitivity: str | None = None
    axes: tuple[AxisTable, ...] = Field(default=(), max_length=3)
    range: str
    iepe: str | None = None
    coupling: Literal["AC", "DC"] | None = None
    serial: str = ""
    calibrated: date | None = None
    calibration_months: int = Field(default=12, ge=1, le=120)
    noise: str | None = None
    certificate: str = Field(default="", max_length=200)
    sensitivity_sd: Share | None = None

    @model_validator(mode="after")
    def _one_way(self) -> "PlanSensorTable":
        single = self.physical is not None and self.sensitivity is not None
        if single == bool(self.axes):
            raise ValueError(
                "give either physical and sensitivity, or axes with both in each"
            )
        if self.quantity.is_motion and not self.point:
            raise ValueError("say at which point it sits, point = '1'")
        return self

    def sensor(self) -> Sensor:
        """Return the sensor in SI.

        Raises:
            UnitError: a value has no unit, or a wrong one, or the range is not above
                zero; the message names the sensor.
        """
        largest = self._parsed("range", self.range)
        if largest <= 0.0:
            raise UnitError(
                f"range {self.range!r} of sensor {self.name!r} must be above zero; "
                "give the largest value that it measures, either sign"
            )
        rows = self.axes or (
            AxisTable(
                physical=self.physical or "",
                direction=self.direction,
                sensitivity=self.sensitivity or "",
            ),
        )
        return Sensor(
            name=self.name,
            quantity=self.quantity,
            point=self.point,
            axes=tuple(
                Axis(
                    row.physical,
                    row.direction,
                    self._parsed("sensitivity", row.sensitivity),
                )
                for row in rows
            ),
            unit=rows[0].sensitivity.rpartition("/")[2].strip(),
            range=largest,
            excitation=self._excitation(),
            coupling=self.coupling or ("AC" if self.quantity in _FED else "DC"),
            serial=self.serial,
            calibrated=self.calibrated,
            calibration_months=self.calibration_months,
            noise=None if self.noise is None else self._parsed("noise", self.noise),
            certificate=self.certificate,
            sensitivity_sd=self.sensitivity_sd,
        )

    def _excitation(self) -> float | None:
        """Return the current [A]; by default only sensors that usually need one."""
        if self.iepe is not None:
            return self._parsed("iepe", self.iepe)
        return None if self.quantity in _FED else 0.0

    def _parsed(self, key: str, text: str) -> float:
        """Return a value in SI.

        Raises:
            UnitError: it has no unit, or a wrong one; sensor and key are named.
        """
        try:
            if key == "iepe":
                return _amperes(text)
            parse = parse_sensitivity if key == "sensitivity" else parse_value
            return parse(text, self.quantity)
        except UnitError as error:
            raise UnitError(f"sensor {self.name!r}, {key}: {error}") from error


def _amperes(text: str) -> float:
    match = re.fullmatch(r"\s*(\d+\.?\d*)\s*(mA|A)\s*", text)
    if match is None:
        raise UnitError(
            f"iepe is {text!r}; write the current with its unit, '4 mA', or '0 mA'"
        )
    return float(match[1]) * (1e-3 if match[2] == "mA" else 1.0)


class AcquisitionTable(StrictTable):
    """How to stream: rate, length of a block, what the driver keeps unread, trigger."""

    sample_rate: Frequency = 25_600.0
    block: Time = 0.05
    buffer: Time = 20.0
    patience: Time = 120.0
    trigger: Literal["software", "hardware"] = "software"


class HitsTable(StrictTable):
    """What to hit, how often, and when a hit is good; None is left to trial hits."""

    points: tuple[str, ...] = Field(min_length=1, max_length=200)
    levels: tuple[Force, ...] = Field(default=(), max_length=20)
    torques: tuple[Torque, ...] = Field(default=(), max_length=20)
    repeats: int = Field(default=3, ge=1, le=1000)
    most_repeats: int | None = Field(default=None, ge=1, le=2000)
    most_rejected: int = Field(default=20, ge=1, le=1000)
    coherence: float = Field(default=0.9, gt=0, lt=1)
    trial_hits: int = Field(default=2, ge=0, le=20)
    trigger: Force | None = None
    length: Time | None = None
    pretrigger: Time = 0.01
    wait: Time = 10 * _SECONDS_IN_A_MINUTE

    @model_validator(mode="after")
    def _unique(self) -> "HitsTable":
        for name in ("points", "levels", "torques"):
            values: tuple[object, ...] = getattr(self, name)
            if len(set(values)) != len(values):
                raise ValueError(f"{name} lists something twice")
        if self.most_repeats is not None and self.most_repeats < self.repeats:
            raise ValueError("most_repeats is below repeats")
        return self


class PlanJointTable(StrictTable):
    """What a torque makes of the preload: P = n T / (K d)."""

    bolts: int = Field(ge=1, le=1000)
    diameter: Length
    nut_factor: float = Field(default=0.2, gt=0, lt=1)

    def preload(self, torque: float) -> float:
        """Return the preload of all bolts together [N] for a torque on each [N m].

        Source:
            Zhou et al. 2025: P = n T / (K d).
        """
        return self.bolts * torque / (self.nut_factor * self.diameter)


def _known_tester(name: str) -> str:
    """Refuse a torque tester that neither jointbench nor a package has."""
    try:
        return torque_tester(name).value.name
    except UsageError as error:
        raise ValueError(str(error)) from error


class TorqueTable(StrictTable):
    """The torque tester that every bolt is tightened with, on a serial line.

    A bolt's torque is the largest reading between two rests. A reading beside the
    target by more than `tolerance` is asked for again, `tries` times at the most.
    The instrument is a Mark-10, or one that a package adds; its usual `baud` if None.
    """

    instrument: Annotated[str, AfterValidator(_known_tester)] = "mark10"
    line: str = Field(min_length=1)
    baud: int | None = Field(default=None, ge=300, le=4_000_000)
    tolerance: float = Field(default=0.1, gt=0, lt=1)
    tries: int = Field(default=3, ge=1, le=100)
    poll: Time = 0.02


class MeasureTable(StrictTable):
    """The whole plan."""

    operator: str = ""
    notes: str = ""
    temperature: str = ""
    source: str | None = None
    acquisition: AcquisitionTable = Field(default_factory=AcquisitionTable)
    hits: HitsTable
    joint: PlanJointTable | None = None
    torque: TorqueTable | None = None
    preload: tuple[BoltForceTable, ...] = Field(default=(), max_length=128)
    sensors: tuple[PlanSensorTable, ...] = Field(min_length=2, max_length=128)

    @model_validator(mode="before")
    @classmethod
    def _known_shape(cls, content: Any) -> Any:
        if isinstance(content, dict) and "sensors" not in content:
            raise ValueError("there is no [[sensors]] table; list hammer and responses")
        return content

    @model_validator(mode="after")
    def _bolts_known(self) -> "MeasureTable":
        if self.torque is not None and (self.joint is None or not self.hits.torques):
            raise ValueError(
                "[torque] reads bolts that no entry names; give torques in [hits], and "
                "bolts and diameter in [joint]"
            )
        return self

    @model_validator(mode="after")
    def _bolt_forces_known(self) -> "MeasureTable":
        voltages = {s.name for s in self.sensors if s.quantity is Quantity.VOLTAGE}
        bolts = [table.bolt for table in self.preload]
        if len(set(bolts)) != len(bolts):
            raise ValueError("[[preload]] names a bolt twice")
        if self.joint is not None and max(bolts, default=0) > self.joint.bolts:
            raise ValueError(
                f"[[preload]] names bolt {max(bolts)}, [joint] has {self.joint.bolts}"
            )
        for table in self.preload:
            if table.channel is not None and table.channel not in voltages:
                raise ValueError(
                    f"[[preload]] of bolt {table.bolt} reads channel "
                    f"{table.channel!r}; list it in [[sensors]] with quantity = "
                    "'voltage', sensitivity = '1 V/V', coupling = 'DC'"
                )
        return self
