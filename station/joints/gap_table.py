# SPDX-License-Identifier: MIT
"""The table [gap] of a structure model file: what is known before the hits."""

from typing import Annotated, Literal

from pydantic import Field

from jointbench.station.files.toml_file import StrictTable, with_unit
from jointbench.station.schemas.positive_quantities import Force

_Stiffness = Annotated[float, with_unit("stiffness"), Field(gt=0)]
_Damping = Annotated[float, with_unit("damping"), Field(gt=0)]
_Length = Annotated[float, with_unit("length")]
_Sd = Annotated[float, with_unit("ratio"), Field(gt=0, le=3)]
_Error = Annotated[float, with_unit("ratio"), Field(ge=0, le=0.3)]
RIGID = "rigid"


class BoltedAreaTable(StrictTable):
    """One bolted area: total stiffness and damping, with relative standard deviations.

    Every patch of a joint is one; a joint without patches is one as a whole. A
    direction without relative motion in the model is ``"rigid"``. `scatter` is the
    standard deviation from one to the next.
    """

    normal: _Stiffness | Literal["rigid"]
    tangential_1: _Stiffness | Literal["rigid"]
    tangential_2: _Stiffness | Literal["rigid"]
    normal_damping: _Damping
    tangential_damping: _Damping
    stiffness_sd: _Sd = 0.1
    damping_sd: _Sd = 0.3
    scatter: _Sd = 0.03


class FootTable(StrictTable):
    """A point of a body that stands on a foot."""

    body: str
    position: tuple[_Length, _Length, _Length]


class FeetTable(StrictTable):
    """Feet: a spring and a damper at each, alike in all directions."""

    places: Annotated[tuple[FootTable, ...], Field(min_length=1, max_length=64)]
    stiffness: _Stiffness
    damping: _Damping
    stiffness_sd: _Sd = 0.2
    damping_sd: _Sd = 0.3


class StructureGapTable(StrictTable):
    """What `gap` needs beside bodies, joints, sensors and hits.

    Hits are compared up to `band`. The bodies' damping ratio, modulus and mass have
    relative standard deviations, so have the modes of the bodies where K and M are not
    exact (`frequency_sd`, `shape_sd`). Hits miss their point by `aim_sd` and tilt by
    `tilt_sd`. Of the relative motions
    across a bolted area those are followed that hold `interface_share` of the strain
    energy of a mode. The bolts' values belong to `preload_reference`; the sessions to
    examine stand beside this file.
    """

    band: Annotated[float, with_unit("frequency"), Field(gt=0)]
    bolt: BoltedAreaTable
    feet: FeetTable | None = None
    damping_ratio: Annotated[float, with_unit("ratio"), Field(gt=0, lt=1)]
    damping_sd: _Sd = 0.3
    modulus_sd: _Sd = 0.015
    mass_sd: _Sd = 0.001
    frequency_sd: _Error = 0.0
    shape_sd: _Error = 0.0
    aim_sd: Annotated[float, with_unit("length"), Field(gt=0)] = 1e-3
    tilt_sd: Annotated[float, with_unit("angle"), Field(gt=0, lt=1)] = 0.02
    interface_share: Annotated[float, Field(gt=0, lt=1)] = 1e-4
    preload_reference: Force | None = None
    sessions: tuple[str, ...] = ()
