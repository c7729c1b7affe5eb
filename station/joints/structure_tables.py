# SPDX-License-Identifier: MIT
"""The tables of a structure model file: what each holds, in which units."""

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, model_validator

from jointbench.analysis.structures.matrices.parts import (
    SupportKind,
)
from jointbench.analysis.structures.meshes.elements import ElementKind
from jointbench.station.files.toml_file import StrictTable, with_unit
from jointbench.station.joints.shape_table import PatchTable, ShapeTable
from jointbench.station.schemas.positive_quantities import Torque

_Length = Annotated[float, with_unit("length")]
_Point = tuple[_Length, _Length, _Length]
_Frequency = Annotated[float, with_unit("frequency"), Field(gt=0)]
_Stiffness = Annotated[float, with_unit("stiffness"), Field(ge=0)]
_Share = Annotated[float, with_unit("ratio"), Field(gt=0, lt=1)]
_Trust = Annotated[float, with_unit("ratio"), Field(ge=0, lt=1)]


class MaterialTable(StrictTable):
    """An isotropic solid: modulus [Pa], density [kg/m^3], loss factor [-]."""

    youngs_modulus: Annotated[float, with_unit("pressure"), Field(gt=0)]
    density: Annotated[float, with_unit("density"), Field(gt=0)]
    poisson_ratio: Annotated[float, Field(gt=-1, lt=0.5)] = 0.3
    loss_factor: Annotated[float, Field(ge=0, lt=1)] = 0.0


class SolidTable(StrictTable):
    """A box with cells, shapes to mesh, or a mesh file.

    K and M files replace the assembly.
    """

    material: str | None = None
    box: _Point | None = None
    cells: tuple[int, int, int] | None = None
    origin: _Point = (0.0, 0.0, 0.0)
    element: ElementKind = ElementKind.HEX20
    shapes: tuple[ShapeTable, ...] = ()
    element_size: Annotated[float, with_unit("length"), Field(gt=0)] | None = None
    mesh: Path | None = None
    mesh_unit: _Length = 1.0
    stiffness: Path | None = None
    mass: Path | None = None

    @model_validator(mode="after")
    def _one_geometry(self) -> "SolidTable":
        forms = [
            self.box is not None and self.cells is not None,
            bool(self.shapes) and self.element_size is not None,
            self.mesh is not None,
        ]
        if forms.count(True) != 1:
            raise ValueError(
                "give either box and cells, or shapes and element_size, or mesh"
            )
        if (self.stiffness is None) != (self.mass is None):
            raise ValueError("give both stiffness and mass files, or neither")
        if self.stiffness is None and self.material is None:
            raise ValueError("name its material, or give stiffness and mass files")
        return self


class JointTable(StrictTable):
    """Where two bodies, or a body and ``ground``, touch.

    `pattern` is a table of points that ``jointbench pressure`` wrote: springs and
    dampers are spread over the joint like the stiffness in it.
    """

    between: tuple[str, str]
    face: str | None = None
    patches: tuple[PatchTable, ...] = ()
    glued: bool = False
    pattern: Path | None = None


class SupportTable(StrictTable):
    """A surface held by the ground; stiffness: normal and two tangential totals."""

    body: str
    face: str
    kind: SupportKind = SupportKind.FIXED
    stiffness: tuple[_Stiffness, _Stiffness, _Stiffness] = (0.0, 0.0, 0.0)


class SensorTable(StrictTable):
    """A channel, or a hit point: where it sits, its direction, the mass on it."""

    body: str
    position: _Point
    direction: tuple[float, float, float]
    mass: Annotated[float, with_unit("mass"), Field(ge=0)] = 0.0


class MeasuredTable(StrictTable):
    """Frequencies as a paper prints them, where there is no session."""

    frequencies: tuple[_Frequency, ...] = Field(min_length=1)
    relative_sd: _Share = 0.002


class IdentifyTable(StrictTable):
    """What to identify from: frequencies, modes (with shapes) or the FRFs.

    The standard deviations, relative, are those of the model (mesh, material): they
    widen those of measured frequencies and damping ratios. `modulus_sd` makes the
    modulus of a body unknown, with this relative standard deviation around its table;
    `mass_sd` does the same for the mass of a sensor;
    `gain_sd` is that of the gain of a sensor, `force_sd` that of the force at a point
    (aim, direction), which FRFs have in common;
    `priors` hold stiffness and relative standard deviation of a joint's direction;
    `band` is that of the modes, where the command states none;
    `known` holds the stiffness of the directions that are not `sought`; `hypotheses`
    tries what else could explain the modes.
    """

    data: Literal["frequencies", "modes", "frf"] = "modes"
    band: tuple[_Frequency, _Frequency] | None = None
    modes: Annotated[int, Field(gt=0, le=200)] | None = None
    sought: tuple[str, ...] | None = None
    known: dict[str, Annotated[float, with_unit("stiffness"), Field(gt=0)]] = Field(
        default_factory=dict
    )
    shared: tuple[str, ...] = ()
    stiffness_box: tuple[_Stiffness, _Stiffness] = (1e6, 1e11)
    lines: Annotated[int, Field(gt=3)] = 200
    frequency_sd: _Trust = 0.0
    damping_sd: _Trust = 0.0
    gain_sd: _Trust = 0.0
    force_sd: _Trust = 0.0
    modulus_sd: dict[str, _Share] = Field(default_factory=dict)
    mass_sd: dict[str, _Share] = Field(default_factory=dict)
    priors: dict[str, tuple[_Stiffness, _Share]] = Field(default_factory=dict)
    hypotheses: bool = False

    @property
    def band_words(self) -> str | None:
        """The band as `--band` takes it."""
        return None if self.band is None else f"{self.band[0]}:{self.band[1]}"


class DesignTable(StrictTable):
    """What a test plan is designed for, before the first hit.

    Stiffness and damping by direction are expected ones, where no identified values are
    given; gain and force deviations are relative. `torque` is that of these values or
    of the chosen state, `torques` those that could follow, `torque_scatter` what a
    state departs from the law over the torque; `states` holds torques by the labels of
    identified states that name no preload.
    """

    sensors: Annotated[int, Field(ge=1, le=100)] = 3
    hits: Annotated[int, Field(ge=1, le=100)] = 5
    repeats: Annotated[int, Field(ge=1, le=1000)] = 3
    band: tuple[_Frequency, _Frequency]
    peak: Annotated[float, with_unit("force"), Field(gt=0)] = 500.0
    contact: Annotated[float, with_unit("time"), Field(gt=0)] = 3e-4
    noise: Annotated[float, with_unit("acceleration"), Field(gt=0)] = 0.02
    sample_rate: _Frequency = 25600.0
    duration: Annotated[float, with_unit("time"), Field(gt=0)] = 1.0
    gain_sd: _Trust = 0.02
    force_sd: _Trust = 0.02
    torque: Torque | None = None
    torques: tuple[Torque, ...] = ()
    torque_scatter: _Trust = 0.02
    states: dict[str, Torque] = Field(default_factory=dict)
    wanted: tuple[str, ...] = ()
    criterion: Literal["D", "E"] = "D"
    stiffness: dict[str, Annotated[float, with_unit("stiffness"), Field(gt=0)]] = Field(
        default_factory=dict
    )
    damping: dict[str, Annotated[float, with_unit("damping"), Field(gt=0)]] = Field(
        default_factory=dict
    )
