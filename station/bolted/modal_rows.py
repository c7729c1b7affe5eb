# SPDX-License-Identifier: MIT
"""Rows of bolted areas, feet, sensors and hits in the modes of meshed bodies."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.gap.intake.mass_places import (
    PlacedSensor,
    motion_across,
    numbered_places,
    point_places,
    sensor_places,
)
from jointbench.analysis.gap.structure_response.jointed_bodies import (
    HitPoint,
    JointedBodies,
    MassPlace,
)
from jointbench.analysis.gap.structure_response.surface_around import (
    SurfaceAround,
    surface_around,
)
from jointbench.analysis.structures.matrices.structure import Structure, pick
from jointbench.analysis.structures.meshes.mesh import outer_faces
from jointbench.station.bolted.interface_motions import BoltedArea
from jointbench.station.bolted.nominal_values import nominal_stiffness
from jointbench.station.joints.gap_table import StructureGapTable
from jointbench.station.joints.structure_model import StructureModel
from jointbench.station.joints.structure_tables import SensorTable


@dataclass(frozen=True, slots=True, eq=False)
class BodyModes:
    """Reduced coordinates of all bodies in one row.

    Attributes:
        structure: matrices of the bodies.
        names: of the bodies.
        body: index of each coordinate's body, shape (n_modes,).
        omega: [rad/s], 0 for rigid motions, shape (n_modes,).
        basis: motion of the mesh, shape (n_free, n_modes).
    """

    structure: Structure
    names: tuple[str, ...]
    body: IntArray
    omega: FloatArray
    basis: FloatArray

    def at(self, body: str, position: Sequence[float]) -> FloatArray:
        """Return the motion of a point along x, y and z, shape (3, n_modes)."""
        return np.asarray(pick(self.structure, body, position) @ self.basis)

    def beside(self, body: str, position: FloatArray, step: FloatArray) -> FloatArray:
        """Return the derivative of the motion along a step [1/m], (3, n_modes).

        At an edge of the body it is that of one side.
        """
        ends: list[tuple[float, FloatArray]] = []
        for side in (1.0, -1.0, 0.0):
            try:
                ends.append((side, self.at(body, (position + side * step).tolist())))
            except BadData:
                continue
            if len(ends) == 2:
                break
        (first, there), (second, back) = ends
        length = (first - second) * float(np.linalg.norm(step))
        return np.asarray((there - back) / length)

    def around(self, body: str, position: Sequence[float]) -> SurfaceAround | None:
        """Return the surface around a place, if the mesh is fine enough."""
        at = [one.name for one in self.structure.bodies].index(body)
        mesh = self.structure.bodies[at].mesh
        outer = np.unique(outer_faces(mesh).nodes)
        number = 3 * (outer + self.structure.first_node[at])[:, None] + np.arange(3)
        place = np.searchsorted(self.structure.free, number)
        known = place.clip(max=self.structure.free.size - 1)
        free = np.all(self.structure.free[known] == number, axis=1)
        rows = self.basis[known[free].ravel()].reshape(-1, 3, self.omega.size)
        return surface_around(tuple(position), mesh.nodes[outer[free]], rows)


def jointed_rows(
    model: StructureModel,
    gap: StructureGapTable,
    areas: Sequence[BoltedArea],
    modes: BodyModes,
) -> JointedBodies:
    """Return the bodies with rows of bolted areas, feet, sensors and hits.

    Args:
        model: of the structure.
        gap: its table [gap].
        areas: bolted areas.
        modes: of the bodies.
    """
    rows = np.stack([area.rows @ modes.basis for area in areas])
    spread = [area.spread @ modes.basis for area in areas]
    numbers = np.repeat(np.arange(len(areas)), [len(one) for one in spread])
    feet = () if gap.feet is None else gap.feet.places
    stands = [modes.at(foot.body, foot.position) for foot in feet]
    sensors = [_placed(modes, name, one) for name, one in model.sensors.items()]
    sites = [modes.at(one.body, one.position) for one in model.sensors.values()]
    along = [
        np.asarray(direction) @ site
        for (*_, direction), site in zip(sensors, sites, strict=True)
    ]
    points = tuple(
        _hit_point(modes, name, one, gap.aim_sd) for name, one in model.hits.items()
    )
    names = list(dict.fromkeys(area.joint for area in areas))
    first, second, third = np.isinf(nominal_stiffness(gap)).tolist()
    return JointedBodies(
        bodies=modes.names,
        body=modes.body,
        omega=modes.omega,
        bolts=rows,
        spread=np.concatenate(spread),
        spread_of=np.stack(
            [numbers, np.concatenate([area.directions for area in areas])], axis=1
        ),
        feet=np.array(stands).reshape(-1, 3, modes.omega.size),
        channels=tuple(model.sensors),
        sensors=np.array(along),
        points=points,
        places=(
            *_bolt_places(modes, areas, rows),
            *numbered_places("foot", np.array(stands).reshape(-1, 3, modes.omega.size)),
            *point_places(points),
            *sensor_places(sensors, along, sites),
        ),
        rigid=(first, second, third),
        across=motion_across(sensors, sites, total=modes.omega.size),
        directions=np.array([direction for *_, direction in sensors]),
        around_channels=_surfaces(modes, model.sensors),
        around_points=_surfaces(modes, model.hits),
        joints={
            name: tuple(k for k, area in enumerate(areas) if area.joint == name)
            for name in names
        }
        if len(names) > 1
        else {},
        bolt_names=tuple(area.name for area in areas),
    )


def _placed(modes: BodyModes, name: str, table: SensorTable) -> PlacedSensor:
    direction = _unit(name, table)
    own = [k for k, one in enumerate(modes.names) if table.body in one.split("+")]
    return name, own[0] if own else 0, table.position, tuple(direction.tolist())


def _unit(name: str, table: SensorTable) -> FloatArray:
    direction = np.asarray(table.direction, dtype=float)
    length = float(np.linalg.norm(direction))
    if not length > 0:
        raise BadData(f"{name!r} has no direction; write e.g. [0, 0, 1]")
    return np.asarray(direction / length)


def _hit_point(modes: BodyModes, name: str, table: SensorTable, aim: float) -> HitPoint:
    direction = _unit(name, table)
    across = np.linalg.svd(direction[None])[2][1:]
    position = np.asarray(table.position)
    slopes = [modes.beside(table.body, position, aim * axis) for axis in across]
    rows = modes.at(table.body, table.position)
    return HitPoint(name, direction, across, rows, np.stack(slopes))


def _bolt_places(
    modes: BodyModes, areas: Sequence[BoltedArea], rows: FloatArray
) -> list[MassPlace]:
    """Return both sides of each bolted area as places of masses."""
    none = np.zeros((0, modes.omega.size))
    found = []
    for number, name in enumerate(modes.names):
        for area, one in zip(areas, rows, strict=True):
            own = np.where(modes.body == number, one, 0.0)
            if np.any(own):
                found.append(MassPlace(f"{name} bolt {area.name}", own, none))
    return found


def _surfaces(
    modes: BodyModes, tables: dict[str, SensorTable]
) -> dict[str, SurfaceAround]:
    found = {n: modes.around(one.body, one.position) for n, one in tables.items()}
    return {name: one for name, one in found.items() if one is not None}
