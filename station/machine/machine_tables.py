# SPDX-License-Identifier: MIT
"""The tables of a machine model file: what each holds, in which units."""

from pathlib import Path
from typing import Annotated

from pydantic import Field, model_validator

from jointbench.analysis.structures.machine.loads import Begin
from jointbench.station.files.toml_file import StrictTable, with_unit
from jointbench.station.joints.structure_tables import JointTable, PatchTable

_Length = Annotated[float, with_unit("length")]
_Size = Annotated[float, with_unit("length"), Field(gt=0)]
_Point = tuple[_Length, _Length, _Length]
_Direction = tuple[float, float, float]
_Stiffness = Annotated[float, with_unit("stiffness"), Field(ge=0)]
_Damping = Annotated[float, with_unit("damping"), Field(ge=0)]
_Turning = Annotated[float, with_unit("rotational_stiffness"), Field(ge=0)]
_TurnDamping = Annotated[float, with_unit("rotational_damping"), Field(ge=0)]
_Deviation = Annotated[float, with_unit("ratio"), Field(ge=0, le=3)]
_Frequency = Annotated[float, with_unit("frequency"), Field(gt=0)]
_Time = Annotated[float, with_unit("time"), Field(gt=0)]
_Any3 = tuple[float, float, float]


class MachineJointTable(JointTable):
    """A joint over an area: totals, normal and two tangents.

    The deviations are relative standard deviations of all directions.
    """

    stiffness: tuple[_Stiffness, _Stiffness, _Stiffness] | None = None
    damping: tuple[_Damping, _Damping, _Damping] = (0.0, 0.0, 0.0)
    stiffness_sd: _Deviation = 0.0
    damping_sd: _Deviation = 0.0

    @model_validator(mode="after")
    def _has_values(self) -> "MachineJointTable":
        if (self.stiffness is None) != self.glued:
            raise ValueError("give its stiffness, or glued = true, and not both")
        return self


class SectionTable(StrictTable):
    """A stretch of a beam with a solid or hollow round section."""

    length: _Size
    diameter: _Size
    bore: Annotated[float, with_unit("length"), Field(ge=0)] = 0.0
    elements: Annotated[int, Field(gt=0, le=500)] = 8


class BeamTable(StrictTable):
    """A spindle or screw: sections one after the other along an axis."""

    begin: _Point
    direction: _Direction
    material: str
    sections: tuple[SectionTable, ...] = Field(min_length=1)


class RigidTable(StrictTable):
    """A rigid body: mass, and inertia about its centre along x, y, z."""

    position: _Point
    mass: Annotated[float, with_unit("mass"), Field(gt=0)]
    inertia: tuple[
        Annotated[float, with_unit("inertia"), Field(gt=0)],
        Annotated[float, with_unit("inertia"), Field(gt=0)],
        Annotated[float, with_unit("inertia"), Field(gt=0)],
    ]


class SpringTable(StrictTable):
    """A guide, bearing or screw: springs and dampers between pieces of two bodies.

    Directions are x, y, z, or the axis and two directions across it. Directions without
    a value are free.
    """

    between: tuple[str, str]
    position: _Point
    radius: _Size | None = None
    face: tuple[str | None, str | None] = (None, None)
    patch: PatchTable | None = None
    axis: _Direction | None = None
    stiffness: tuple[_Stiffness, _Stiffness, _Stiffness] = (0.0, 0.0, 0.0)
    damping: tuple[_Damping, _Damping, _Damping] = (0.0, 0.0, 0.0)
    rotational_stiffness: tuple[_Turning, _Turning, _Turning] = (0.0, 0.0, 0.0)
    rotational_damping: tuple[_TurnDamping, _TurnDamping, _TurnDamping] = (
        0.0,
        0.0,
        0.0,
    )
    stiffness_sd: _Deviation = 0.0
    damping_sd: _Deviation = 0.0

    @model_validator(mode="after")
    def _holds(self) -> "SpringTable":
        if not any(self.stiffness) and not any(self.rotational_stiffness):
            raise ValueError("a spring without any stiffness holds nothing")
        return self


class MassTable(StrictTable):
    """A small mass on a body: at a point, or on a whole face."""

    body: str
    mass: Annotated[float, with_unit("mass"), Field(gt=0)]
    position: _Point | None = None
    face: str | None = None

    @model_validator(mode="after")
    def _one_place(self) -> "MassTable":
        if (self.position is None) == (self.face is None):
            raise ValueError("give either its position, or a face")
        return self


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
