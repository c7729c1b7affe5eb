# SPDX-License-Identifier: MIT
"""The structure model file (TOML): meshed bodies, joints, supports, sensors.

`identify` takes it where it has a table [joints]; a file with [links] is a lumped
bench (`bench_model`). Units are written beside every number.
"""

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, model_validator

from jointbench.analysis.structures.matrices.element_assembly import Material
from jointbench.analysis.structures.matrices.mesh_files import (
    matrix_body,
    read_matrix,
    read_mesh,
)
from jointbench.analysis.structures.matrices.parts import (
    Joint,
    MeshedBody,
    PointMass,
    Support,
    SupportKind,
    solid_body,
)
from jointbench.analysis.structures.matrices.structure import (
    Structure,
    build_structure,
)
from jointbench.analysis.structures.meshes.elements import ElementKind
from jointbench.analysis.structures.meshes.mesh import Mesh, box_mesh
from jointbench.analysis.structures.meshes.polygons import Patch, disc, rectangle
from jointbench.analysis.structures.reduction.mounted_sensors import MountedSensor
from jointbench.station.files.toml_file import StrictTable, with_unit
from jointbench.station.joints.structure_contact import TheoryTable, joint_of

_Length = Annotated[float, with_unit("length")]
_Point = tuple[_Length, _Length, _Length]
_Span = tuple[_Length, _Length]
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
    """A box with cells, or a mesh file; K and M files replace the assembly."""

    material: str | None = None
    box: _Point | None = None
    cells: tuple[int, int, int] | None = None
    origin: _Point = (0.0, 0.0, 0.0)
    element: ElementKind = ElementKind.HEX20
    mesh: Path | None = None
    mesh_unit: _Length = 1.0
    stiffness: Path | None = None
    mass: Path | None = None

    @model_validator(mode="after")
    def _one_geometry(self) -> "SolidTable":
        if (self.box is None) == (self.mesh is None) or (
            self.box is not None and self.cells is None
        ):
            raise ValueError("give either box and cells, or mesh")
        if (self.stiffness is None) != (self.mass is None):
            raise ValueError("give both stiffness and mass files, or neither")
        if self.stiffness is None and self.material is None:
            raise ValueError("name its material, or give stiffness and mass files")
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


class JointTable(StrictTable):
    """Where two bodies, or a body and ``ground``, touch."""

    between: tuple[str, str]
    face: str | None = None
    patches: tuple[PatchTable, ...] = ()
    glued: bool = False


class SupportTable(StrictTable):
    """A face held by the ground; stiffness: normal and two tangential totals."""

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
    widen those of measured frequencies and damping ratios.
    """

    data: Literal["frequencies", "modes", "frf"] = "modes"
    modes: Annotated[int, Field(gt=0, le=200)] | None = None
    sought: tuple[str, ...] | None = None
    shared: tuple[str, ...] = ()
    stiffness_box: tuple[_Stiffness, _Stiffness] = (1e6, 1e11)
    lines: Annotated[int, Field(gt=3)] = 200
    frequency_sd: _Trust = 0.0
    damping_sd: _Trust = 0.0


class StructureModel(StrictTable):
    """A meshed structure and what is sought of its joints."""

    materials: dict[str, MaterialTable] = Field(default_factory=dict)
    bodies: dict[str, SolidTable] = Field(min_length=1)
    joints: dict[str, JointTable] = Field(min_length=1)
    supports: tuple[SupportTable, ...] = ()
    sensors: dict[str, SensorTable] = Field(default_factory=dict)
    hits: dict[str, SensorTable] = Field(default_factory=dict)
    measured: MeasuredTable | None = None
    identify: IdentifyTable = IdentifyTable()
    contact: TheoryTable | None = None

    @model_validator(mode="after")
    def _names_exist(self) -> "StructureModel":
        for name, body in self.bodies.items():
            if body.material is not None and body.material not in self.materials:
                raise ValueError(
                    f"body {name!r} is of {body.material!r}; materials are "
                    f"{list(self.materials)}"
                )
        if self.contact is not None:
            joint_of(self.contact, self.parametric_joints)
        return self

    @property
    def parametric_joints(self) -> list[str]:
        """Names of the joints that are not glued."""
        return [name for name, one in self.joints.items() if not one.glued]


def structure_of(model: StructureModel, folder: Path) -> Structure:
    """Mesh and assemble a model file; files in it are relative to `folder`."""
    bodies = [_body(model, name, folder) for name in model.bodies]
    joints = [
        Joint(name, one.between, tuple(map(_patch, one.patches)), one.face, one.glued)
        for name, one in model.joints.items()
    ]
    supports = [Support(s.body, s.face, s.kind, s.stiffness) for s in model.supports]
    masses = [
        PointMass(one.body, one.position, one.mass)
        for one in model.sensors.values()
        if one.mass > 0
    ]
    return build_structure(bodies, joints, supports=supports, masses=masses)


def sensors_of(tables: dict[str, SensorTable]) -> dict[str, MountedSensor]:
    """Return sensors or hit points by name."""
    return {
        name: MountedSensor(name, one.body, one.position, one.direction)
        for name, one in tables.items()
    }


def _body(model: StructureModel, name: str, folder: Path) -> MeshedBody:
    table = model.bodies[name]
    mesh = _mesh(table, folder)
    if table.stiffness is not None and table.mass is not None:
        stiffness = read_matrix(folder / table.stiffness)
        mass = read_matrix(folder / table.mass)
        loss = 0.0
        if table.material is not None:
            loss = model.materials[table.material].loss_factor
        return matrix_body(name, mesh, stiffness, mass, loss_factor=loss)
    material = model.materials[table.material or ""]
    solid = Material(
        material.youngs_modulus,
        material.poisson_ratio,
        material.density,
        material.loss_factor,
    )
    return solid_body(name, mesh, solid)


def _mesh(table: SolidTable, folder: Path) -> Mesh:
    if table.box is not None and table.cells is not None:
        return box_mesh(table.box, table.cells, origin=table.origin, kind=table.element)
    return read_mesh(folder / (table.mesh or Path()), unit=table.mesh_unit)


def _patch(table: PatchTable) -> Patch:
    if table.rectangle is not None:
        return rectangle(*table.rectangle)
    return disc(table.centre or (0.0, 0.0), table.radius or 0.0)
