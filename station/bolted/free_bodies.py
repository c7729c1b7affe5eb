# SPDX-License-Identifier: MIT
"""Free bodies of a structure model in modal form, with rows of bolts, feet and points.

Each body is reduced by itself: its modes up to twice the band, and the static response
to forces at its bolted areas. The reduced coordinates are mass-normalised and make the
stiffness diagonal, so they stand in for modes.
"""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from jointbench.acquisition.basics.errors import UsageError
from jointbench.analysis.gap.structure_response.jointed_bodies import JointedBodies
from jointbench.analysis.structures.matrices.parts import Support, SupportKind
from jointbench.analysis.structures.matrices.structure import (
    Structure,
    build_structure,
    pick,
)
from jointbench.station.bolted.body_thickness import thickness_laws
from jointbench.station.bolted.bolted_areas import bolted_areas, joints_by_area
from jointbench.station.bolted.interface_motions import (
    BoltedArea,
    ReducedBodies,
    interface_motions,
)
from jointbench.station.bolted.modal_rows import jointed_rows
from jointbench.station.bolted.nominal_values import nominal_stiffness
from jointbench.station.bolted.reduced_bodies import reduce_bodies
from jointbench.station.joints.gap_table import StructureGapTable
from jointbench.station.joints.structure_model import (
    StructureModel,
    joint_of_table,
    masses_of,
    meshed_body,
)


@dataclass(frozen=True, slots=True, eq=False)
class BoltedModel:
    """A structure model, ready for hits.

    Attributes:
        bodies: in modal form.
        areas: bolted areas.
        structure: matrices of the bodies.
    """

    bodies: JointedBodies
    areas: tuple[BoltedArea, ...]
    structure: Structure


def bolted_model(model: StructureModel, folder: Path) -> BoltedModel:
    """Reduce the bodies of a structure model.

    Args:
        model: with a table [gap].
        folder: files of the model are relative to it.

    Raises:
        UsageError: a table is missing, or a body or joint does not fit.
        BadData: matrices or meshes cannot be used, or a point is not on its body.
    """
    gap = gap_table(model)
    _require_places(model)
    pieces = [
        (area, name)
        for name, table in model.joints.items()
        for area in joints_by_area(joint_of_table(name, table, folder))
    ]
    structure = build_structure(
        [meshed_body(n, t, model.materials, folder) for n, t in model.bodies.items()],
        [area for area, _ in pieces],
        supports=[Support(s.body, s.face, s.kind, s.stiffness) for s in model.supports],
        masses=list(masses_of(model).values()),
    )
    motions = bolted_areas(structure, {area.name: name for area, name in pieces})
    none = np.zeros((0, structure.size))
    every = {one.name: one.rows.reshape(-1, structure.size) for one in motions}
    first = reduce_bodies(structure, every, none, gap.band)
    areas = interface_motions(
        motions,
        ReducedBodies(first.omega, first.basis),
        nominal_stiffness(gap),
        gap.band,
        gap.interface_share,
    )
    points = np.concatenate(
        [
            pick(structure, one.body, one.position).toarray()
            for one in (*model.hits.values(), *model.sensors.values())
        ]
    )
    rows = {area.name: area.every_row for area in areas}
    modes = reduce_bodies(structure, rows, points, gap.band)
    bodies = replace(
        jointed_rows(model, gap, areas, modes),
        thickness=thickness_laws(model, gap, areas, modes, points),
    )
    return BoltedModel(bodies, tuple(areas), structure)


def gap_table(model: StructureModel) -> StructureGapTable:
    """Return the table [gap] of a model.

    Raises:
        UsageError: there is none.
    """
    if model.gap is None:
        raise UsageError(
            "the model has no table [gap]; give it band, damping_ratio, [gap.bolt] and "
            "[gap.feet]"
        )
    return model.gap


def _require_places(model: StructureModel) -> None:
    if not model.sensors or not model.hits:
        raise UsageError(
            "the model has no [sensors] or no [hits]; state where channels and hammer "
            "points are"
        )
    held = any(one.kind is SupportKind.FIXED for one in model.supports)
    grounded = held or any("ground" in one.between for one in model.joints.values())
    springs = any(max(one.stiffness) > 0 for one in model.supports)
    if model.gap is not None and model.gap.feet is None and not (grounded or springs):
        raise UsageError(
            "nothing holds the bodies; add [gap.feet], soft ones for bodies that hang, "
            "or [[supports]]"
        )
