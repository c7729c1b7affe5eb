# SPDX-License-Identifier: MIT
"""The model file (TOML) of bodies that were struck alone, and of links between them."""

from pathlib import Path
from typing import Annotated

from pydantic import Field, model_validator

from jointbench.station.files.toml_file import StrictTable, with_unit

_Frequency = Annotated[float, with_unit("frequency"), Field(gt=0)]
_Length = Annotated[float, with_unit("length")]
_Deviation = Annotated[float, with_unit("ratio"), Field(ge=0, le=3)]
GROUND = "ground"


class MeasuredBodyTable(StrictTable):
    """FRFs of a free body: every point struck, and measured in the same direction."""

    frfs: tuple[Path, ...] = Field(min_length=1)
    columns: str | None = None
    averages: Annotated[int, Field(ge=0)] = 0


class BandedBodyTable(MeasuredBodyTable):
    """The same among meshed bodies, with the band of its fit."""

    band: tuple[_Frequency, _Frequency]

    @model_validator(mode="after")
    def _band_rises(self) -> "BandedBodyTable":
        if not self.band[0] < self.band[1]:
            raise ValueError("give the lower end of the band first")
        return self


class MixedLinkTable(StrictTable):
    """A spring and damper from a point ``"body:point"`` of a measured body.

    The second side is such a point, a modelled body with a position, or ground; it acts
    along the direction in which the measured body was struck.
    """

    between: tuple[str, str]
    direction: tuple[float, float, float]
    position: tuple[_Length, _Length, _Length] | None = None
    stiffness: Annotated[float, with_unit("stiffness"), Field(gt=0)]
    damping: Annotated[float, with_unit("damping"), Field(ge=0)] = 0.0
    stiffness_sd: _Deviation = 0.0
    damping_sd: _Deviation = 0.0

    @model_validator(mode="after")
    def _has_a_direction(self) -> "MixedLinkTable":
        if not any(self.direction):
            raise ValueError("the direction has no length; write e.g. [0, 0, 1]")
        return self


class MeasuredLinkTable(StrictTable):
    """A spring and damper between two points ``"body:point"``, or one and ground."""

    between: tuple[str, str]
    stiffness: Annotated[float, with_unit("stiffness"), Field(gt=0)]
    damping: Annotated[float, with_unit("damping"), Field(ge=0)] = 0.0


class MeasuredMachine(StrictTable):
    """Measured bodies and their links; FRFs are wanted between `points`."""

    measured: dict[str, MeasuredBodyTable] = Field(min_length=1)
    links: dict[str, MeasuredLinkTable] = Field(min_length=1)
    points: tuple[str, ...] = Field(min_length=1)
    band: tuple[_Frequency, _Frequency]
    draws: Annotated[int, Field(ge=10, le=1000)] = 40

    @model_validator(mode="after")
    def _band_rises(self) -> "MeasuredMachine":
        if not self.band[0] < self.band[1]:
            raise ValueError("give the lower end of the band first")
        return self
