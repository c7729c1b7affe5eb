# SPDX-License-Identifier: MIT
"""The structure model file (TOML): meshed bodies, joints, supports, sensors.

`identify` takes it where it has a table [joints]; a file with [links] is a lumped
bench (`bench_model`). Units are written beside every number.
"""

from collections.abc import Mapping
from pathlib import Path

from pydantic import Field, model_validator

from jointbench.acquisition.basics.errors import BadData
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
    solid_body,
)
from jointbench.analysis.structures.matrices.structure import (
    Structure,
    build_structure,
)
from jointbench.analysis.structures.meshes.mesh import Mesh, box_mesh
from jointbench.analysis.structures.meshes.polygons import Patch, disc, rectangle
from jointbench.analysis.structures.meshes.solid_shapes import SolidShape, mesh_shapes
from jointbench.analysis.structures.reduction.mounted_sensors import MountedSensor
from jointbench.station.files.toml_file import StrictTable
from jointbench.station.joints.gap_table import StructureGapTable
from jointbench.station.joints.pattern_file import read_pattern
from jointbench.station.joints.pressure_table import PressureTable
from jointbench.station.joints.shape_table import PatchTable, ShapeTable
from jointbench.station.joints.structure_contact import TheoryTable, joint_of
from jointbench.station.joints.structure_tables import (
    DesignTable,
    IdentifyTable,
    JointTable,
    MaterialTable,
    MeasuredTable,
    SensorTable,
    SolidTable,
    SupportTable,
)
from jointbench.station.schemas.bolted_joint_table import BoltedLinkTable


class StructureModel(StrictTable):
    """A meshed structure and what is sought of its joints."""

    materials: dict[str, MaterialTable] = Field(default_factory=dict)
    bodies: dict[str, SolidTable] = Field(min_length=1)
    joints: dict[str, JointTable] = Field(min_length=1)
    supports: tuple[SupportTable, ...] = ()
    sensors: dict[str, SensorTable] = Field(default_factory=dict)
    hits: dict[str, SensorTable] = Field(default_factory=dict)
    reachable: dict[str, SensorTable] = Field(default_factory=dict)
    design: DesignTable | None = None
    measured: MeasuredTable | None = None
    identify: IdentifyTable = IdentifyTable()
    contact: TheoryTable | None = None
    bolted_joint: BoltedLinkTable | None = None
    pressure: PressureTable | None = None
    gap: StructureGapTable | None = None

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
        own = self.bolted_joint
        if own is not None and own.link not in self.parametric_joints:
            raise ValueError(
                f"bolted_joint.link is {own.link!r}; joints that are not glued are "
                f"{self.parametric_joints}"
            )
        return self

    @property
    def parametric_joints(self) -> list[str]:
        """Names of the joints that are not glued."""
        return [name for name, one in self.joints.items() if not one.glued]

    def with_masses(self, factors: Mapping[str, float]) -> "StructureModel":
        """Return the model with the masses of sensors multiplied, by their names."""
        sensors = {
            name: one.model_copy(update={"mass": one.mass * factors.get(name, 1.0)})
            for name, one in self.sensors.items()
        }
        return self.model_copy(update={"sensors": sensors})


def structure_of(model: StructureModel, folder: Path) -> Structure:
    """Mesh and assemble a model file; files in it are relative to `folder`."""
    bodies = [
        meshed_body(name, table, model.materials, folder)
        for name, table in model.bodies.items()
    ]
    joints = [joint_of_table(name, one, folder) for name, one in model.joints.items()]
    supports = [Support(s.body, s.face, s.kind, s.stiffness) for s in model.supports]
    masses = list(masses_of(model).values())
    return build_structure(bodies, joints, supports=supports, masses=masses)


def joint_of_table(name: str, table: JointTable, folder: Path) -> Joint:
    """Return the joint of a table; its pattern is relative to `folder`."""
    patches = tuple(map(patch_of, table.patches))
    pattern = None if table.pattern is None else read_pattern(folder / table.pattern)
    return Joint(name, table.between, patches, table.face, table.glued, pattern)


def masses_of(model: StructureModel) -> dict[str, PointMass]:
    """Return the masses of the sensors that have one, by name."""
    return {
        name: PointMass(one.body, one.position, one.mass)
        for name, one in model.sensors.items()
        if one.mass > 0
    }


def sensors_of(tables: dict[str, SensorTable]) -> dict[str, MountedSensor]:
    """Return sensors or hit points by name."""
    return {
        name: MountedSensor(name, one.body, one.position, one.direction)
        for name, one in tables.items()
    }


def meshed_body(
    name: str, table: SolidTable, materials: dict[str, MaterialTable], folder: Path
) -> MeshedBody:
    """Mesh a body, and assemble it unless files hold its matrices."""
    mesh = _mesh(table, folder)
    if table.stiffness is not None and table.mass is not None:
        stiffness = read_matrix(folder / table.stiffness)
        mass = read_matrix(folder / table.mass)
        loss = 0.0
        if table.material is not None:
            loss = materials[table.material].loss_factor
        return matrix_body(name, mesh, stiffness, mass, loss_factor=loss)
    material = material_of(materials[table.material or ""])
    try:
        return solid_body(name, mesh, material)
    except BadData as error:
        raise BadData(f"body {name!r}: {error}") from error


def material_of(table: MaterialTable) -> Material:
    """Return the material of a table."""
    return Material(
        table.youngs_modulus, table.poisson_ratio, table.density, table.loss_factor
    )


def _mesh(table: SolidTable, folder: Path) -> Mesh:
    if table.box is not None and table.cells is not None:
        return box_mesh(table.box, table.cells, origin=table.origin, kind=table.element)
    if table.shapes and table.element_size is not None:
        return mesh_shapes([_shape(one) for one in table.shapes], table.element_size)
    return read_mesh(folder / (table.mesh or Path()), unit=table.mesh_unit)


def _shape(table: ShapeTable) -> SolidShape:
    if table.box is not None:
        return SolidShape(table.origin, table.box, None, table.cut)
    return SolidShape(
        table.origin, table.axis or (0.0, 0.0, 0.0), table.radius, table.cut
    )


def patch_of(table: PatchTable) -> Patch:
    """Return the part of a plane of a table."""
    if table.rectangle is not None:
        return rectangle(*table.rectangle)
    return disc(table.centre or (0.0, 0.0), table.radius or 0.0)
