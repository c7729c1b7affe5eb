# SPDX-License-Identifier: MIT
"""Tables of a model file that hold one shape of a body, or one patch of a joint."""

from typing import Annotated

from pydantic import Field, model_validator

from jointbench.station.files.toml_file import StrictTable, with_unit

_Length = Annotated[float, with_unit("length")]
_Point = tuple[_Length, _Length, _Length]
_Span = tuple[_Length, _Length]


class ShapeTable(StrictTable):
    """A box or a cylinder, added to a body or cut from it."""

    origin: _Point = (0.0, 0.0, 0.0)
    box: _Point | None = None
    radius: Annotated[float, with_unit("length"), Field(gt=0)] | None = None
    axis: _Point | None = None
    cut: bool = False

    @model_validator(mode="after")
    def _one_shape(self) -> "ShapeTable":
        cylinder = self.radius is not None and self.axis is not None
        if cylinder == (self.box is not None):
            raise ValueError("give either box, or radius and axis of a cylinder")
        return self


class PatchTable(StrictTable):
    """A part of the joint's plane: a rectangle, or a bolt spot."""

    rectangle: tuple[_Span, _Span] | None = None
    centre: _Span | None = None
    radius: _Length | None = None

    @model_validator(mode="after")
    def _one_form(self) -> "PatchTable":
        spot = self.centre is not None and self.radius is not None
        if spot == (self.rectangle is not None):
            raise ValueError("give either rectangle, or centre and radius")
        return self
