# SPDX-License-Identifier: MIT
"""The table [pressure] of a structure model: what presses a joint, and its law."""

from typing import Annotated

from pydantic import Field, model_validator

from jointbench.acquisition.basics.errors import JointbenchError
from jointbench.analysis.contact.torque_to_preload import preload_from_torque
from jointbench.analysis.structures.pressure.clamped_loads import ClampBolt
from jointbench.analysis.structures.pressure.interface_law import PowerInterface
from jointbench.station.files.toml_file import StrictTable, with_unit

_Length = Annotated[float, with_unit("length")]
_Size = Annotated[float, with_unit("length"), Field(gt=0)]
_Spread = Annotated[float, with_unit("ratio"), Field(ge=0, lt=2)]
_Area = Annotated[float, with_unit("area"), Field(gt=0)]


class BoltTable(StrictTable):
    """A bolt: where it is along the two tangents, its force, what it presses on."""

    position: tuple[_Length, _Length]
    preload: Annotated[float, with_unit("force"), Field(ge=0)] | None = None
    torque: Annotated[float, with_unit("torque"), Field(gt=0)] | None = None
    nut_factor: Annotated[float, Field(gt=0)] = 0.2
    diameter: _Size | None = None
    scatter: _Spread = 0.0
    head: _Size
    hole: Annotated[float, with_unit("length"), Field(ge=0)] | None = None
    seat: _Length | None = None
    nut_seat: _Length | None = None
    thread: _Size | None = None

    @model_validator(mode="after")
    def _one_force(self) -> "BoltTable":
        if (self.preload is None) == (self.torque is None):
            raise ValueError("give either preload, or torque with diameter")
        needs = [
            name
            for name in ("torque", "thread")
            if getattr(self, name) is not None and self.diameter is None
        ]
        if needs:
            raise ValueError(f"{needs[0]} needs the bolt's diameter")
        try:
            self.bolt("bolt")
        except JointbenchError as error:
            raise ValueError(str(error)) from error
        return self

    def bolt(self, name: str) -> ClampBolt:
        """Return the bolt; its hole is 10 % wider than its thread unless given."""
        preload = self.preload
        if preload is None:
            preload = preload_from_torque(
                self.torque or 0.0,
                diameter=self.diameter or 0.0,
                nut_factor=self.nut_factor,
            ).value
        hole = 1.1 * (self.diameter or 0.0) if self.hole is None else self.hole
        return ClampBolt(
            name,
            self.position,
            preload,
            self.scatter,
            self.head,
            hole,
            (self.seat, self.nut_seat),
            self.thread,
            self.diameter or 0.0,
        )


class PowerLawTable(StrictTable):
    """A power law: `stiffness` on `area` at `pressure`, and how it grows."""

    stiffness: Annotated[float, with_unit("stiffness"), Field(gt=0)]
    area: _Area
    pressure: Annotated[float, with_unit("pressure"), Field(gt=0)]
    exponent: Annotated[float, Field(ge=0, le=1)]
    tangential_ratio: Annotated[float, Field(ge=0)] = 0.8
    loss_factor: Annotated[float, Field(ge=0)] = 0.0
    stiffness_sd: _Spread = 0.0

    def power(self, frequency: float) -> PowerInterface:
        """Return the law; its loss becomes damping at a frequency [Hz]."""
        return PowerInterface(
            self.stiffness / self.area,
            self.pressure,
            self.exponent,
            self.tangential_ratio,
            self.loss_factor,
            frequency,
            self.stiffness_sd,
        )


class PressureTable(StrictTable):
    """Bolts and weight on a joint, and the law of its surfaces.

    Without `law` it is the first model of [contact], which needs the area within which
    its surface was measured as `reference_area`.
    """

    joint: str | None = None
    bolts: tuple[BoltTable, ...] = ()
    preload_sd: _Spread = 0.0
    gravity: tuple[float, float, float] | None = None
    crown: Annotated[float, with_unit("length"), Field(ge=0)] = 0.0
    law: PowerLawTable | None = None
    reference_area: _Area | None = None
    reference_area_sd: _Spread = 0.0
    frequency: Annotated[float, with_unit("frequency"), Field(gt=0)] = 100.0
