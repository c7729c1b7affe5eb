# SPDX-License-Identifier: MIT
"""The plan of a recording without hammer hits (TOML): channels and timed runs.

::

    operator = "A. Miller"
    source = "sim:spindle?seed=1"
    [acquisition]
    sample_rate = "2048 Hz"
    [[runs]]
    name = "3000 rpm"
    kind = "operating"          # or "shaker", "plain"
    duration = "60 s"
    [[sensors]]                 # as in the plan of `measure`
    name = "a1"
    quantity = "acceleration"
    point = "1"
    physical = "cDAQ1Mod1/ai0"
    sensitivity = "100 mV/g"
    range = "5 g"
"""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from pydantic import Field, model_validator

from jointbench.acquisition.basics.errors import BadData, UnitError, UsageError
from jointbench.acquisition.ni.sensors import Sensor, require_unique
from jointbench.acquisition.records.recordings import Quantity
from jointbench.station.files.toml_file import StrictTable, read_toml
from jointbench.station.schemas.plan_model import AcquisitionTable, PlanSensorTable
from jointbench.station.schemas.positive_quantities import Time, Torque


class RunKind(StrEnum):
    """What excites the structure during a run, which decides how it is evaluated."""

    OPERATING = "operating"
    SHAKER = "shaker"
    PLAIN = "plain"


class RunTable(StrictTable):
    """One run: its name, its kind, its duration, and the torque of the bolts."""

    name: str = Field(min_length=1, max_length=60)
    kind: RunKind = RunKind.PLAIN
    duration: Time
    torque: Torque | None = None


class RecordPlanTable(StrictTable):
    """The whole plan."""

    operator: str = ""
    notes: str = ""
    source: str | None = None
    acquisition: AcquisitionTable = Field(default_factory=AcquisitionTable)
    runs: tuple[RunTable, ...] = Field(min_length=1, max_length=200)
    sensors: tuple[PlanSensorTable, ...] = Field(min_length=1, max_length=128)

    @model_validator(mode="after")
    def _fit(self) -> "RecordPlanTable":
        names = [run.name for run in self.runs]
        if len(set(names)) != len(names):
            raise ValueError("two runs have the same name")
        quantities = [sensor.quantity for sensor in self.sensors]
        moving = any(quantity.is_motion for quantity in quantities)
        for run in self.runs:
            forces = quantities.count(Quantity.FORCE)
            if run.kind is RunKind.SHAKER and (forces != 1 or not moving):
                raise ValueError(
                    f"run {run.name!r} is a shaker run, the table has {forces} force "
                    "channels; give the one of the shaker and at least one response"
                )
            if run.kind is RunKind.OPERATING and not moving:
                raise ValueError(
                    f"run {run.name!r} is an operating run; give at least one channel "
                    "of acceleration, velocity or displacement"
                )
        return self


@dataclass(frozen=True, slots=True)
class RecordPlan:
    """A plan, checked and in SI.

    Attributes:
        table: as written.
        sensors: the channel table.
        text: the file itself, which goes into the session.
    """

    table: RecordPlanTable
    sensors: tuple[Sensor, ...]
    text: str


def read_record_plan(path: Path) -> RecordPlan:
    """Read a plan.

    Raises:
        BadData: it cannot be read, or breaks a rule; the message names the key.
    """
    table = read_toml(path, RecordPlanTable)
    block = table.acquisition.block
    for run in table.runs:
        if run.duration < block:
            raise BadData(
                f"{path}: run {run.name!r} lasts {run.duration:g} s, less than a block "
                f"of {block:g} s; give it at least that, or another block in "
                "[acquisition]"
            )
    try:
        sensors = tuple(entry.sensor() for entry in table.sensors)
        require_unique(sensors)
    except (UnitError, UsageError) as error:
        raise BadData(f"{path}: [[sensors]]: {error}") from error
    return RecordPlan(table, sensors, path.read_text(encoding="utf-8-sig"))
