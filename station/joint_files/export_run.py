# SPDX-License-Identifier: MIT
"""An identified joint as files of finite element programs: the work."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.structures.exchange.calculix_joint import (
    CalculixModel,
    calculix_mass,
    model_text,
    over_all_nodes,
)
from jointbench.analysis.structures.exchange.joint_pieces import (
    JointPiece,
    joint_pieces,
    piece_members,
    piece_motion,
    tiles,
)
from jointbench.analysis.structures.matrices.element_assembly import Sparse
from jointbench.analysis.structures.matrices.joint_matrices import nearest_node
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.meshes.polygons import Patch
from jointbench.analysis.structures.reduction.body_moduli import scaled_structure
from jointbench.analysis.structures.reduction.full_modes import (
    lowest_modes,
    shift_of,
    solve_full,
)
from jointbench.station.files.toml_file import read_toml
from jointbench.station.joints.state_values import (
    IdentifiedFile,
    StateValues,
    state_values,
)
from jointbench.station.joints.structure_model import (
    StructureModel,
    masses_of,
    material_of,
    patch_of,
    structure_of,
)

_ELASTIC = 10
_RIGID = 6
# Modes beyond those compared: CalculiX asks for a loose tolerance of the last ones.
_SPARE = 4


@dataclass(frozen=True, slots=True, eq=False)
class JointExport:
    """One joint, ready to be written.

    Attributes:
        name: of the joint.
        structure: at the identified moduli and masses.
        values: of the state.
        pieces: of the joint.
        stiffness: over the degrees of freedom of all nodes [N/m].
        damping: over the degrees of freedom of all nodes [N s/m].
        frequencies: elastic, of the structure with all its joints [Hz].
        of_pieces: the same with the pieces in place of the distributed springs [Hz].
    """

    name: str
    structure: Structure
    values: StateValues
    pieces: tuple[JointPiece, ...]
    stiffness: Sparse
    damping: Sparse
    frequencies: FloatArray
    of_pieces: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class ExportSource:
    """A model with identified values.

    Attributes:
        settings: the model file.
        structure: at the identified moduli and masses.
        values: of the state.
    """

    settings: StructureModel
    structure: Structure
    values: StateValues


def export_source(
    model: Path, identified: IdentifiedFile, state: str | None
) -> ExportSource:
    """Read a model and place its identified values.

    Args:
        model: structure model (TOML).
        identified: joints of the model.
        state: its label; None where there is one only.
    """
    settings = read_toml(model, StructureModel)
    structure = structure_of(settings, model.parent)
    values = state_values(identified, structure, settings.identify, state)
    if values.masses:
        structure = structure_of(settings.with_masses(values.masses), model.parent)
    if values.moduli:
        structure = scaled_structure(structure, values.moduli)
    return ExportSource(settings, structure, values)


def export_joint(
    source: ExportSource, name: str | None, counts: Sequence[int] | None
) -> JointExport:
    """Prepare one joint.

    Args:
        source: model and values.
        name: of the joint; None where there is one only.
        counts: of pieces along the tangents; None is a piece for each patch.

    Raises:
        UsageError: there is no such joint, or there are several.
    """
    structure, values = source.structure, source.values
    names = list(structure.joints)
    if name is None and len(names) != 1:
        raise UsageError(f"the model has the joints {names}; choose one with --joint")
    name = name or names[0]
    if name not in names:
        raise UsageError(f"no joint {name!r} with parameters; there are {names}")
    at = names.index(name)
    own = slice(3 * at, 3 * at + 3)
    face, joints = structure.faces[at], values.joints
    patches = _patches(source, name, at, counts)
    pieces = joint_pieces(
        name, face, patches, joints.stiffness[own], joints.damping[own]
    )
    whole = solve_full(structure, joints.stiffness, _RIGID + _ELASTIC)
    motions = [
        piece_motion(face, inside, piece)
        for inside, piece in zip(piece_members(face, patches), pieces, strict=True)
    ]
    rest = joints.stiffness.copy()
    rest[own] = 0.0
    lumped = structure.with_joints(rest)
    for motion, piece in zip(motions, pieces, strict=True):
        free = motion[:, structure.free]
        lumped = Sparse(lumped + free.T @ Sparse(piece.stiffness) @ free)
    shift = shift_of(structure.stiffness, structure.mass)
    other = lowest_modes(lumped, structure.mass, _RIGID + _ELASTIC, shift=shift)
    # As many rigid motions as the distributed springs leave.
    rigid = int(np.sum(whole.natural_frequency == 0.0))
    return JointExport(
        name,
        structure,
        values,
        pieces,
        _total(structure, own, joints.stiffness),
        _total(structure, own, joints.damping),
        whole.natural_frequency[rigid:][:_ELASTIC],
        other.natural_frequency[rigid:][:_ELASTIC],
    )


def calculix_model(source: ExportSource) -> CalculixModel:
    """Return the model with its materials, for a deck of CalculiX.

    Raises:
        UsageError: a body has matrices of another program in place of a material.
    """
    settings = source.settings
    factors = {
        part: value
        for name, value in source.values.moduli.items()
        for part in name.split("+")
    }
    materials = []
    for name, body in settings.bodies.items():
        if body.stiffness is not None or body.material is None:
            raise UsageError(
                f"body {name!r} is given by matrices, which CalculiX cannot read; its "
                "model cannot be written: leave 'calculix' out of --to"
            )
        own = material_of(settings.materials[body.material])
        modulus = own.youngs_modulus * factors.get(name, 1.0)
        materials.append(replace(own, youngs_modulus=modulus))
    return CalculixModel(
        source.structure, tuple(materials), _points(source), _RIGID + _ELASTIC + _SPARE
    )


def calculix_deck(source: ExportSource, model: CalculixModel) -> str:
    """Return the whole model, with all its joints, as a deck of CalculiX."""
    structure = source.structure
    everything = slice(0, len(structure.spread))
    joints = _total(structure, everything, source.values.joints.stiffness)
    return model_text(model, [joints])


def frequencies_with_its_mass(source: ExportSource, model: CalculixModel) -> FloatArray:
    """Return our natural frequencies with the mass of CalculiX [Hz]."""
    structure = replace(source.structure, mass=calculix_mass(model))
    found = solve_full(structure, source.values.joints.stiffness, _RIGID + _ELASTIC)
    elastic = found.natural_frequency[found.natural_frequency > 0.0]
    return np.asarray(elastic[:_ELASTIC])


def _patches(
    source: ExportSource, name: str, at: int, counts: Sequence[int] | None
) -> tuple[Patch, ...]:
    if counts is not None:
        return tiles(source.structure.faces[at], counts)
    return tuple(map(patch_of, source.settings.joints[name].patches))


def _total(structure: Structure, own: slice, values: FloatArray) -> Sparse:
    total = Sparse((structure.size, structure.size))
    for spread, value in zip(structure.spread[own], values[own], strict=True):
        total = Sparse(total + float(value) * spread)
    return over_all_nodes(structure, total)


def _points(source: ExportSource) -> tuple[tuple[int, float], ...]:
    """Return the nodes of attached masses, with the identified masses."""
    structure = source.structure
    names = [body.name for body in structure.bodies]
    found = []
    for sensor, one in masses_of(source.settings).items():
        at = names.index(one.body)
        node = nearest_node(structure.bodies[at].mesh, one.position)
        mass = one.mass * source.values.masses.get(sensor, 1.0)
        found.append((node + int(structure.first_node[at]), mass))
    return tuple(found)
