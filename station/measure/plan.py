# SPDX-License-Identifier: MIT
"""What a plan asks for, in its order: conditions, each with its hits."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from jointbench.acquisition.basics.errors import BadData, UnitError, UsageError
from jointbench.acquisition.ni.sensors import Sensor, require_table
from jointbench.station.files.toml_file import read_toml
from jointbench.station.schemas.plan_model import (
    AcquisitionTable,
    HitsTable,
    MeasureTable,
)


@dataclass(frozen=True, slots=True)
class Condition:
    """Hits that belong together: one torque, one point, one level.

    Attributes:
        number: in the order of the plan, from 0.
        torque: on each bolt [N m], None where the plan names none.
        preload: that results [N], None where no conversion is given.
        point: to strike.
        level: peak force to aim at [N], None for any.
        tightened: mean torque on the bolts as a tester read it [N m], None where
            none did; the preload is then that of all the readings.
    """

    number: int
    torque: float | None
    preload: float | None
    point: str
    level: float | None
    tightened: float | None = None

    @property
    def name(self) -> str:
        """What the recording is called."""
        torque = "" if self.torque is None else f"{self.torque:g} Nm, "
        level = "" if self.level is None else f", {self.level:g} N"
        return f"{torque}point {self.point}{level}"


@dataclass(frozen=True, slots=True)
class MeasurePlan:
    """A plan, checked and in SI.

    Attributes:
        table: as written.
        sensors: the channel table.
        text: the file itself, which goes into the session.
    """

    table: MeasureTable
    sensors: tuple[Sensor, ...]
    text: str

    @property
    def hits(self) -> HitsTable:
        """What to hit."""
        return self.table.hits

    @property
    def acquisition(self) -> AcquisitionTable:
        """How to stream."""
        return self.table.acquisition


def read_plan(path: Path) -> MeasurePlan:
    """Read a plan.

    Raises:
        BadData: it cannot be read, or breaks a rule; the message names the key.
    """
    table = read_toml(path, MeasureTable)
    try:
        sensors = tuple(entry.sensor() for entry in table.sensors)
        require_table(sensors)
    except (UnitError, UsageError) as error:
        raise BadData(f"{path}: [[sensors]]: {error}") from error
    return MeasurePlan(table, sensors, path.read_text(encoding="utf-8-sig"))


def conditions(plan: MeasurePlan) -> tuple[Condition, ...]:
    """Return the conditions of a plan: torques, in each points, at each levels."""
    return tuple(_conditions(plan))


def _conditions(plan: MeasurePlan) -> Iterator[Condition]:
    joint, number = plan.table.joint, 0
    for torque in plan.hits.torques or (None,):
        preload = None if joint is None or torque is None else joint.preload(torque)
        for point in plan.hits.points:
            for level in plan.hits.levels or (None,):
                yield Condition(number, torque, preload, point, level)
                number += 1
