# SPDX-License-Identifier: MIT
"""The tables of the parts of a machine: joints, beams, rigid bodies, springs."""

from typing import Annotated

from pydantic import BeforeValidator, Field, model_validator

from jointbench.acquisition.basics.errors import UnitError
from jointbench.acquisition.basics.units import parse_value
from jointbench.station.files.toml_file import StrictTable, with_unit
from jointbench.station.joints.shape_table import PatchTable
from jointbench.station.joints.structure_tables import JointTable

_Length = Annotated[float, with_unit("length")]
_Size = Annotated[float, with_unit("length"), Field(gt=0)]
_Point = tuple[_Length, _Length, _Length]
_Direction = tuple[float, float, float]
_Stiffness = Annotated[float, with_unit("stiffness"), Field(ge=0)]
_Damping = Annotated[float, with_unit("damping"), Field(ge=0)]
_Turning = Annotated[float, with_unit("rotational_stiffness"), Field(ge=0)]
_TurnDamping = Annotated[float, with_unit("rotational_damping"), Field(ge=0)]
_Speed = Annotated[float, with_unit("frequency")]
_Deviation = Annotated[float, with_unit("ratio"), Field(ge=0, le=3)]


_Matrix = tuple[tuple[float, ...], ...]


def _matrix_of(kind: str) -> BeforeValidator:
    """Return what reads six rows of six numbers with their units, as text.

    Displacements come first: corner blocks are of `kind` and of its rotational kind,
    the others couple displacement and rotation.
    """
    kinds = ((kind, f"coupling_{kind}"), (f"coupling_{kind}", f"rotational_{kind}"))

    def parse(value: object) -> object:
        if (
            not isinstance(value, list)
            or [len(row) if isinstance(row, list) else 0 for row in value] != [6] * 6
        ):
            raise ValueError("give six rows of six numbers with units, as text")
        return tuple(
            tuple(_cell(cell, kinds[i // 3][j // 3]) for j, cell in enumerate(row))
            for i, row in enumerate(value)
        )

    return BeforeValidator(parse)


def _cell(cell: object, kind: str) -> float:
    if not isinstance(cell, str):
        raise ValueError(  # noqa: TRY004 - pydantic reports a ValueError
            f"write each number with its unit, as text: '{cell} ...'"
        )
    try:
        return parse_value(cell, kind)
    except UnitError as error:
        raise ValueError(str(error)) from error


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
    """A spindle or screw: sections one after the other along an axis.

    With a speed it turns about this axis, and has gyroscopic moments.
    """

    begin: _Point
    direction: _Direction
    material: str
    speed: _Speed = 0.0
    sections: tuple[SectionTable, ...] = Field(min_length=1)


class RigidTable(StrictTable):
    """A rigid body: mass, and inertia about its centre along x, y, z.

    With an axis and a speed it turns about this axis, which is x, y or z, and has
    gyroscopic moments.
    """

    position: _Point
    axis: _Direction | None = None
    speed: _Speed = 0.0
    mass: Annotated[float, with_unit("mass"), Field(gt=0)]
    inertia: tuple[
        Annotated[float, with_unit("inertia"), Field(gt=0)],
        Annotated[float, with_unit("inertia"), Field(gt=0)],
        Annotated[float, with_unit("inertia"), Field(gt=0)],
    ]

    @model_validator(mode="after")
    def _turns_about_an_axis(self) -> "RigidTable":
        if self.speed and self.axis is None:
            raise ValueError(
                "a speed needs the axis of the turn, e.g. axis = [1, 0, 0]"
            )
        if self.axis is not None and sum(map(bool, self.axis)) != 1:
            raise ValueError("the axis of a rigid body is x, y or z, e.g. [1, 0, 0]")
        return self


class SpringTable(StrictTable):
    """A guide, bearing or screw: springs and dampers between pieces of two bodies.

    A piece of a solid is its nodes within the radius, or one of its sides (or a patch
    of it); an empty side takes the radius. Directions are x, y, z, or the axis and two
    directions across it. Directions without a value are free.
    """

    between: tuple[str, str]
    position: _Point
    radius: _Size | None = None
    face: tuple[str, str] = ("", "")
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
    stiffness_matrix: Annotated[_Matrix | None, _matrix_of("stiffness")] = None
    damping_matrix: Annotated[_Matrix | None, _matrix_of("damping")] = None

    @model_validator(mode="after")
    def _holds(self) -> "SpringTable":
        single = any(self.stiffness) or any(self.rotational_stiffness)
        if single == (self.stiffness_matrix is not None):
            raise ValueError(
                "give either stiffness (and rotational_stiffness) above zero, or a "
                "stiffness_matrix"
            )
        if self.damping_matrix is not None and self.stiffness_matrix is None:
            raise ValueError("a damping_matrix needs a stiffness_matrix")
        return self


class MassTable(StrictTable):
    """A small mass on a body: at a point, or on a whole side."""

    body: str
    mass: Annotated[float, with_unit("mass"), Field(gt=0)]
    position: _Point | None = None
    face: str | None = None

    @model_validator(mode="after")
    def _one_place(self) -> "MassTable":
        if (self.position is None) == (self.face is None):
            raise ValueError("give either its position, or the side of the body")
        return self
