# SPDX-License-Identifier: MIT
"""The machine model file (TOML): bodies, joints, springs, loads, the tool.

Units are written beside every number. Files named in it are relative to its folder.
"""

from pathlib import Path

import numpy as np
from pydantic import Field, model_validator

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.structures.machine.loads import (
    HarmonicLoad,
    Load,
    TableLoad,
)
from jointbench.analysis.structures.machine.machine_parts import (
    JointSetting,
    Machine,
    MachinePoint,
    MachineSpring,
    RigidPart,
)
from jointbench.analysis.structures.matrices.beam_body import (
    BeamBody,
    BeamSection,
    beam_body,
)
from jointbench.analysis.structures.matrices.parts import (
    FaceMass,
    PointMass,
    Support,
)
from jointbench.analysis.structures.matrices.structure import build_structure
from jointbench.analysis.structures.matrices.surface_motion import Attachment
from jointbench.station.files.toml_file import StrictTable
from jointbench.station.joints.structure_model import (
    joint_of_table,
    material_of,
    meshed_body,
    patch_of,
)
from jointbench.station.joints.structure_tables import (
    MaterialTable,
    SolidTable,
    SupportTable,
)
from jointbench.station.machine.machine_part_tables import (
    BeamTable,
    MachineJointTable,
    MassTable,
    RigidTable,
    SpringTable,
)
from jointbench.station.machine.machine_tables import (
    AnalysisTable,
    ChatterTable,
    LoadTable,
    PointTable,
    TransientTable,
)
from jointbench.station.machine.measured_bodies import links_of, measured_parts
from jointbench.station.machine.measured_tables import (
    BandedBodyTable,
    MixedLinkTable,
)

TOOL = "tool"
"""The point whose receptance is reported."""
# A table of a load: a million points.
_MOST_BYTES = 50_000_000


class MachineModel(StrictTable):
    """A machine: bodies, what joins them, and what is computed."""

    materials: dict[str, MaterialTable] = Field(default_factory=dict)
    bodies: dict[str, SolidTable] = Field(min_length=1)
    beams: dict[str, BeamTable] = Field(default_factory=dict)
    rigid: dict[str, RigidTable] = Field(default_factory=dict)
    joints: dict[str, MachineJointTable] = Field(default_factory=dict)
    springs: dict[str, SpringTable] = Field(default_factory=dict)
    supports: tuple[SupportTable, ...] = ()
    masses: tuple[MassTable, ...] = ()
    measured: dict[str, BandedBodyTable] = Field(default_factory=dict)
    links: dict[str, MixedLinkTable] = Field(default_factory=dict)
    points: dict[str, PointTable] = Field(min_length=1)
    loads: tuple[LoadTable, ...] = ()
    transient: TransientTable | None = None
    chatter: ChatterTable | None = None
    analysis: AnalysisTable

    @model_validator(mode="after")
    def _names_exist(self) -> "MachineModel":
        wanted = {name: one.material for name, one in self.bodies.items()}
        wanted |= {name: one.material for name, one in self.beams.items()}
        for name, material in wanted.items():
            if material is not None and material not in self.materials:
                raise ValueError(
                    f"body {name!r} is of {material!r}; materials are "
                    f"{list(self.materials)}"
                )
        if TOOL not in self.points:
            raise ValueError(f"points are {list(self.points)}; one must be {TOOL!r}")
        for load in self.loads:
            if load.at not in self.points:
                raise ValueError(
                    f"a load acts at {load.at!r}; points are {list(self.points)}"
                )
        if self.transient is not None and not self.loads:
            raise ValueError("a table [transient] needs [[loads]]")
        if not self.joints and not self.springs and not self.links:
            raise ValueError("give [joints.*] or [springs.*] between the bodies")
        return self


def machine_of(model: MachineModel, folder: Path) -> Machine:
    """Mesh and assemble the bodies of a machine file.

    Args:
        model: the file.
        folder: of the files that it names.

    Returns:
        The machine.
    """
    solids = [
        meshed_body(name, table, model.materials, folder)
        for name, table in model.bodies.items()
    ]
    joints = [joint_of_table(name, one, folder) for name, one in model.joints.items()]
    supports = [Support(s.body, s.face, s.kind, s.stiffness) for s in model.supports]
    structure = build_structure(
        solids, joints, supports=supports, masses=[_mass(one) for one in model.masses]
    )
    return Machine(
        structure=structure,
        beams=tuple(_beam(name, one, model) for name, one in model.beams.items()),
        rigid=tuple(
            RigidPart(name, one.position, one.mass, one.inertia, one.axis)
            for name, one in model.rigid.items()
        ),
        settings=settings_of(model),
        springs=springs_of(model),
        points={
            name: MachinePoint(one.body, one.position)
            for name, one in model.points.items()
        },
        speeds=speeds_of(model),
        measured=measured_parts(model.measured, folder),
        links=links_of(model.links, [*model.bodies, *model.beams, *model.rigid]),
    )


def speeds_of(model: MachineModel) -> dict[str, float]:
    """Return the speeds of the bodies that turn, by name [rad/s]."""
    speeds = {name: one.speed for name, one in model.beams.items()}
    speeds |= {name: one.speed for name, one in model.rigid.items()}
    return {name: 2.0 * np.pi * speed for name, speed in speeds.items() if speed}


def settings_of(model: MachineModel) -> dict[str, JointSetting]:
    """Return the values of the joints over areas, by name."""
    return {
        name: JointSetting(one.stiffness, one.damping, one.stiffness_sd, one.damping_sd)
        for name, one in model.joints.items()
        if one.stiffness is not None
    }


def springs_of(model: MachineModel) -> tuple[MachineSpring, ...]:
    """Return the springs between pieces of bodies."""
    return tuple(_spring(name, one) for name, one in model.springs.items())


def loads_of(model: MachineModel, folder: Path) -> tuple[Load, ...]:
    """Return the loads, each along x, y and z of its point.

    Inputs are numbered point by point, x, y, z of each.
    """
    found: list[Load] = []
    names = list(model.points)
    for one in model.loads:
        direction = np.asarray(one.direction) / np.linalg.norm(one.direction)
        first = 3 * names.index(one.at)
        table = _table(one, folder)
        for axis in np.flatnonzero(direction).tolist():
            share = float(direction[axis])
            if table is not None:
                found.append(TableLoad(first + axis, table[0], share * table[1]))
            elif one.amplitude is not None and one.rate is not None:
                found.append(
                    HarmonicLoad(
                        first + axis, share * one.amplitude, one.rate, one.phase
                    )
                )
    return tuple(found)


def _table(
    load: LoadTable, folder: Path
) -> tuple[np.ndarray[tuple[int], np.dtype[np.float64]], ...] | None:
    if load.time:
        return np.asarray(load.time), np.asarray(load.force)
    if load.file is None:
        return None
    path = folder / load.file
    if path.is_file() and path.stat().st_size > _MOST_BYTES:
        raise BadData(f"{path}: more than {_MOST_BYTES} bytes; shorten the table")
    try:
        values = np.loadtxt(path, delimiter=",", comments="#", ndmin=2)
    except (OSError, ValueError) as error:
        raise BadData(
            f"{path}: no table of time [s] and force [N] with a comma between ({error})"
        ) from error
    if values.shape[1] != 2:
        raise BadData(f"{path}: {values.shape[1]} columns; time [s], force [N] needed")
    return values[:, 0].copy(), values[:, 1].copy()


def _mass(one: MassTable) -> PointMass | FaceMass:
    if one.position is not None:
        return PointMass(one.body, one.position, one.mass)
    return FaceMass(one.body, one.face or "", one.mass)


def _beam(name: str, one: BeamTable, model: MachineModel) -> BeamBody:
    sections = [
        BeamSection(part.length, part.diameter, part.bore, part.elements)
        for part in one.sections
    ]
    material = material_of(model.materials[one.material])
    return beam_body(name, one.begin, one.direction, sections, material)


def _spring(name: str, one: SpringTable) -> MachineSpring:
    patch = None if one.patch is None else patch_of(one.patch)
    sides = tuple(
        Attachment(one.position, one.radius, face or None, patch if face else None)
        for face in one.face
    )
    return MachineSpring(
        name=name,
        between=one.between,
        pieces=(sides[0], sides[1]),
        axis=one.axis,
        stiffness=(*one.stiffness, *one.rotational_stiffness),
        damping=(*one.damping, *one.rotational_damping),
        deviations=(one.stiffness_sd, one.damping_sd),
        matrices=_matrices(one),
    )


def _matrices(one: SpringTable) -> tuple[FloatArray, FloatArray] | None:
    if one.stiffness_matrix is None:
        return None
    none = np.zeros((6, 6))
    damping = none if one.damping_matrix is None else np.array(one.damping_matrix)
    return np.array(one.stiffness_matrix), damping
