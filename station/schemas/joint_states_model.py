# SPDX-License-Identifier: MIT
"""The TOML file of a joint over its preload: joint, bodies, contact law, states.

::

    [joint]
    bolts = 4
    diameter = "16 mm"             # of the bolts
    area = "0.12 m^2"              # apparent, of the contact surface

    [bodies]
    modulus = "55 GPa"
    poisson = 0.25

    [law]
    family = "asperities"          # or fractal, linear, power
    rms_height = "2.1 um"
    rms_slope = 0.11
    rms_curvature = "21 1/mm"

    [[states]]                     # or table = "states.csv" at the top
    torque = "20 N m"              # or preload = "25 kN", preload_sd = "2 %"
    branch = "rising"
    assembly = 1
    kn = "6.0e7 N/m"               # or "> 5e9 N/m", known from below at 95 %
    kn_sd = "3 %"
    loop = "loop-20.csv"           # force over displacement: kt, ct by amplitude
    frequency = "0.1 Hz"           # of its cycles
"""

import math
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, model_validator

from jointbench.acquisition.basics.errors import UnitError
from jointbench.acquisition.basics.units import parse_value
from jointbench.station.files.toml_file import StrictTable, with_unit
from jointbench.station.schemas.positive_quantities import (
    Force,
    Frequency,
    Length,
    Pressure,
    Torque,
)

Spread = Annotated[float, with_unit("ratio"), Field(ge=0, le=3)]
_Value = tuple[float, bool]
"""A value [SI], and whether it is only known to be larger."""


def _area(value: object) -> object:
    """Return an area of text such as "0.12 m^2" or "1200 cm^2" [m^2]."""
    if not isinstance(value, str):
        raise ValueError(  # noqa: TRY004
            f"write the area with its unit, as text: '{value} m^2'"
        )
    number, _, unit = value.strip().partition(" ")
    factors = {"m^2": 1.0, "m2": 1.0, "cm^2": 1e-4, "cm2": 1e-4}
    factors |= {"mm^2": 1e-6, "mm2": 1e-6}
    if unit not in factors:
        raise ValueError(f"'{unit}' is no unit of area; use m^2, cm^2 or mm^2")
    try:
        area = float(number) * factors[unit]
    except ValueError as error:
        raise ValueError(f"'{number}' is no number; write e.g. '0.12 m^2'") from error
    if not math.isfinite(area):
        raise ValueError(f"an area of {number} {unit} is impossible; give its size")
    return area


def _measured(kind: str) -> BeforeValidator:
    def parse(value: object) -> _Value:
        if not isinstance(value, str):
            raise ValueError(  # noqa: TRY004
                f"write the number with its unit, as text: '{value} ...'"
            )
        text = value.strip()
        try:
            found = parse_value(text.removeprefix(">"), kind)
        except UnitError as error:
            raise ValueError(str(error)) from error
        if found <= 0:
            raise ValueError("it must be positive; leave what is not known out")
        return found, text.startswith(">")

    return BeforeValidator(parse)


class BoltedJointTable(StrictTable):
    """What is known of bolts and contact surface."""

    bolts: Annotated[int, Field(ge=1, le=1000)] = 1
    diameter: Length
    area: Annotated[float, BeforeValidator(_area), Field(gt=0)]
    nut_factor: Annotated[float, Field(gt=0.02, lt=1)] = 0.2
    nut_factor_sd: Spread = 0.2
    torque_scatter: Spread = 0.05
    reassembly: Spread = 0.2
    rocking_radius: Length | None = None
    bolt_radius: Length | None = None
    head_diameter: Length | None = None
    clamped_length: Length | None = None
    bolt_length: Length | None = None
    bolt_modulus: Pressure = 2.1e11


class BodiesTable(StrictTable):
    """Materials; those of the second body are the first one's where not given."""

    modulus: Pressure
    poisson: Annotated[float, Field(ge=0, le=0.5)] = 0.3
    modulus_b: Pressure | None = None
    poisson_b: Annotated[float, Field(ge=0, le=0.5)] | None = None
    modulus_sd: Spread = 0.05
    hardness: Pressure | None = None
    hardness_sd: Spread = 0.1


class LawTable(StrictTable):
    """The contact law with the uncertainty of its inputs."""

    family: Literal["asperities", "fractal", "linear", "power"]
    rms_height: Length | None = None
    rms_height_sd: Spread = 0.1
    rms_slope: Annotated[float, Field(gt=0, lt=10)] | None = None
    rms_slope_sd: Spread = 0.15
    rms_curvature: Annotated[float, with_unit("curvature"), Field(gt=0)] | None = None
    rms_curvature_sd: Spread = 0.3
    hurst: Annotated[float, Field(gt=0, lt=1)] = 0.8
    share: Annotated[float, Field(gt=0, lt=3)] = 0.45
    share_sd: Spread = 0.1
    model: str = "ke_3d"
    dimension: Annotated[float, Field(gt=1, lt=3)] | None = None
    dimension_sd: Annotated[float, Field(ge=0, lt=0.5)] = 0.02
    roughness: Length | None = None
    roughness_sd: Spread = 0.5
    stiffness: Annotated[float, with_unit("stiffness"), Field(gt=0)] | None = None
    stiffness_sd: Spread = 0.3
    exponent: Annotated[float, Field(gt=0, le=2)] | None = None
    exponent_sd: Annotated[float, Field(ge=0, le=1)] = 0.02
    preload: Force | None = None

    @model_validator(mode="after")
    def _complete(self) -> "LawTable":
        needed = {
            "asperities": ("rms_height", "rms_slope", "rms_curvature"),
            "fractal": ("dimension", "roughness"),
            "linear": ("rms_height",),
            "power": ("stiffness", "exponent", "preload"),
        }[self.family]
        lost = [name for name in needed if getattr(self, name) is None]
        if lost:
            raise ValueError(
                f"family {self.family!r} needs {', '.join(needed)}; add {lost[0]}"
            )
        return self


class JointStateTable(StrictTable):
    """One state: torque or preload, branch, assembly, and what was measured."""

    torque: Torque | None = None
    preload: Force | None = None
    preload_sd: Spread = 0.02
    branch: Literal["rising", "falling"] = "rising"
    assembly: Annotated[int, Field(ge=1, le=1000)] = 1
    time: Annotated[float, with_unit("time"), Field(ge=0)] | None = None
    shear: Force | None = None
    frequency: Frequency | None = None
    kn: Annotated[_Value, _measured("stiffness")] | None = None
    kt: Annotated[_Value, _measured("stiffness")] | None = None
    kt2: Annotated[_Value, _measured("stiffness")] | None = None
    kr: Annotated[_Value, _measured("rotational_stiffness")] | None = None
    cn: Annotated[_Value, _measured("damping")] | None = None
    ct: Annotated[_Value, _measured("damping")] | None = None
    kn_sd: Spread = 0.05
    kt_sd: Spread = 0.05
    kt2_sd: Spread = 0.05
    kr_sd: Spread = 0.05
    cn_sd: Spread = 0.2
    ct_sd: Spread = 0.2
    correlation: dict[str, Annotated[float, Field(gt=-1, lt=1)]] = Field(
        default_factory=dict
    )
    loop: str | None = None
    loop_sd: Spread = 0.01
    loop_loss_sd: Spread = 0.05
    identified: str | None = None
    parameters: dict[Literal["kn", "kt", "kt2", "kr", "cn", "ct"], str] = Field(
        default_factory=dict
    )

    @model_validator(mode="after")
    def _loaded(self) -> "JointStateTable":
        if self.torque is None and self.preload is None:
            raise ValueError(
                "a state needs its torque or its preload; add torque = '20 N m'"
            )
        if self.loop is not None and self.frequency is None:
            raise ValueError(
                "a loop needs the frequency of its cycles; add frequency = '0.1 Hz'"
            )
        own = {k for k in ("kt", "ct") if getattr(self, k) is not None}
        if self.loop is not None and own | ({"kt", "ct"} & set(self.parameters)):
            raise ValueError(
                "kt and ct of this state are those of its loop; leave them out, or "
                "write a state of their own"
            )
        if (self.identified is None) != (not self.parameters):
            raise ValueError(
                "identified and parameters belong together, e.g. identified = "
                "'joint-20.json', parameters = { kn = 'mount.stiffness' }"
            )
        return self


class JointStatesModel(StrictTable):
    """A joint over its preload, with a contact law."""

    joint: BoltedJointTable
    bodies: BodiesTable
    law: LawTable
    states: tuple[JointStateTable, ...] = ()
    table: str | None = None
    covariance: str | None = None

    @model_validator(mode="after")
    def _one_source(self) -> "JointStatesModel":
        if bool(self.states) == (self.table is not None):
            raise ValueError(
                "give the states either as [[states]] or as table = 'states.csv'"
            )
        return self
