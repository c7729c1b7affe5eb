# SPDX-License-Identifier: MIT
"""The tables of a machine on loads, the cut, and what is computed."""

from pathlib import Path
from typing import Annotated

from pydantic import Field, model_validator

from jointbench.analysis.structures.machine.loads import Begin
from jointbench.station.files.toml_file import StrictTable, with_unit

_Length = Annotated[float, with_unit("length")]
_Point = tuple[_Length, _Length, _Length]
_Direction = tuple[float, float, float]
_Frequency = Annotated[float, with_unit("frequency"), Field(gt=0)]
_Time = Annotated[float, with_unit("time"), Field(gt=0)]


class PointTable(StrictTable):
    """A point of a body where loads act and motion is read."""

    body: str
    position: _Point


class LoadTable(StrictTable):
    """A force at a point: a sine, or a table of time [s] and force."""

    at: str
    direction: _Direction
    amplitude: Annotated[float, with_unit("force")] | None = None
    rate: Annotated[float, with_unit("angular_rate"), Field(ge=0)] | None = None
    phase: Annotated[float, with_unit("angle")] = 0.0
    time: tuple[Annotated[float, with_unit("time")], ...] = ()
    force: tuple[Annotated[float, with_unit("force")], ...] = ()
    file: Path | None = None

    @model_validator(mode="after")
    def _one_form(self) -> "LoadTable":
        sine = self.amplitude is not None and self.rate is not None
        table = len(self.time) > 1 and len(self.time) == len(self.force)
        if [sine, table, self.file is not None].count(True) != 1:
            raise ValueError(
                "give amplitude and rate, or time and force of equal length, or the "
                "file of a table"
            )
        if not any(self.direction):
            raise ValueError("the direction has no length; write e.g. [0, 0, 1]")
        return self


class TransientTable(StrictTable):
    """The motion under all loads together."""

    duration: _Time
    step: _Time
    begin: Begin = Begin.REST
    modes: Annotated[int, Field(gt=0, le=400)] = 80


class ChatterTable(StrictTable):
    """The cut at the tool: force along one direction, chip thickness along another."""

    coefficient: Annotated[float, with_unit("pressure"), Field(gt=0)]
    chip: _Direction
    force: _Direction
    teeth: Annotated[int, Field(gt=0)] = 1
    speed: tuple[_Frequency, _Frequency]

    @model_validator(mode="after")
    def _directions_and_speeds(self) -> "ChatterTable":
        if not any(self.chip) or not any(self.force):
            raise ValueError("a direction has no length; write e.g. [0, 0, 1]")
        if not self.speed[0] < self.speed[1]:
            raise ValueError("give the lower speed first")
        return self


class AnalysisTable(StrictTable):
    """What is computed: the band, the number of modes and of random samples."""

    band: _Frequency
    modes: Annotated[int, Field(gt=0, le=100)] = 10
    lines: Annotated[int, Field(gt=10, le=5000)] = 800
    samples: Annotated[int, Field(ge=20, le=2000)] = 100
    seed: int = 1
