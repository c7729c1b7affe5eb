# SPDX-License-Identifier: MIT
"""Modes of the free bodies of a `campaign/1` file, as rows of joints and sensors."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import h5py
import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.acquisition.basics.errors import FormatError
from jointbench.acquisition.file_access.quoting import shown, visible
from jointbench.analysis.gap.intake.intake_settings import HITS
from jointbench.analysis.gap.intake.mass_places import (
    PlacedSensor,
    Vector,
    motion_across,
    numbered_places,
    point_places,
    sensor_places,
)
from jointbench.analysis.gap.intake.typed_hdf5 import finite_array, require_group
from jointbench.analysis.gap.structure_response.jointed_bodies import (
    HitPoint,
    JointedBodies,
)
from jointbench.analysis.gap.structure_response.surface_around import (
    SurfaceAround,
    surface_around,
)

BODIES = ("bottom", "top")


@dataclass(frozen=True, slots=True)
class PlannedPoint:
    """A hammer point of the nominal parameters.

    Attributes:
        direction: of an exact hit, a unit vector.
        body: that is hit.
        position: [m]; None if it is not stated.
    """

    direction: tuple[float, float, float]
    body: str
    position: tuple[float, float, float] | None = None


_NONE = np.zeros((0, 3))


@dataclass(frozen=True, slots=True, eq=False)
class _Table:
    """The modal table of one body.

    Attributes:
        where: of the group, for messages.
        group: that holds it.
        frequency: natural frequencies [Hz], shape (n_modes,).
        before: modes of the bodies before it.
        modes: of all bodies.
    """

    where: str
    group: h5py.Group
    frequency: FloatArray
    before: int
    modes: int

    def rows(self, group: h5py.Group, name: str, shape: tuple[int, ...]) -> FloatArray:
        """Return rows over the modes of all bodies, shape (*shape, n_all_modes)."""
        count = self.frequency.size
        own = finite_array(self.where, group, name, (*shape, count))
        rows = np.zeros((*shape, self.modes))
        rows[..., self.before : self.before + count] = own
        return rows

    def around(self, place: Vector) -> SurfaceAround | None:
        """Return the surface around a place, if the table lists its nodes."""
        if "nodes_m" not in self.group or place is None:
            return None
        nodes = finite_array(self.where, self.group, "nodes_m")
        if nodes.ndim != 2 or nodes.shape[1] != 3 or len(nodes) > HITS.most_nodes:
            raise FormatError(
                f"{self.where} has 'nodes_m' of shape {nodes.shape}, up to "
                f"{HITS.most_nodes} rows of x, y and z are read; store one row for "
                "each node"
            )
        rows = self.rows(self.group, "phi_nodes", (len(nodes), 3))
        return surface_around(place, nodes, rows)

    def points(self, name: str) -> FloatArray:
        """Return the rows of bolts or feet, shape (n_points, 3, n_all_modes)."""
        found = self.group.get(name)
        count = found.shape[0] if getattr(found, "ndim", 0) == 3 else 0
        if not 1 <= count <= HITS.most_joints:
            raise FormatError(
                f"{self.where} has {count} rows of points in {name!r}, 1 to "
                f"{HITS.most_joints} are read; store points, directions and modes"
            )
        return self.rows(self.group, name, (count, 3))


def read_bodies(
    where: str,
    file: h5py.File,
    sensors: Sequence[PlacedSensor],
    points: Mapping[str, PlannedPoint],
    rigid: BoolArray,
) -> JointedBodies:
    """Read the modal tables of both bodies.

    Args:
        where: of the file, for messages.
        file: open campaign.
        sensors: response channels in the order of the data.
        points: hammer points.
        rigid: directions without relative motion at the bolts, shape (3,).

    Raises:
        FormatError: a part is missing or malformed.
        BadData: a number is not finite.
    """
    tables = _tables(where, file)
    bolts = [table.points("phi_bolts") for table in tables]
    if bolts[0].shape != bolts[1].shape:
        raise FormatError(
            f"{where} has {len(bolts[0])} bolts at the bottom and {len(bolts[1])} at "
            "the top; store the same bolts for both bodies"
        )
    feet = tables[0].points("phi_feet")
    rows = [
        tables[body].rows(
            require_group(tables[body].where, tables[body].group, "phi_channel"),
            name,
            (),
        )
        for name, body, *_ in sensors
    ]
    sites = _sites(tables, sensors)
    hit_points = tuple(_hit_point(tables, name, p) for name, p in points.items())
    directions = [direction for *_, direction in sensors if direction is not None]
    return JointedBodies(
        bodies=BODIES,
        body=np.repeat([0, 1], [t.frequency.size for t in tables]),
        omega=2 * np.pi * np.concatenate([t.frequency for t in tables]),
        bolts=bolts[1] - bolts[0],
        feet=feet,
        channels=tuple(name for name, *_ in sensors),
        sensors=np.array(rows),
        points=hit_points,
        places=(
            *numbered_places("bottom bolt", bolts[0]),
            *numbered_places("top bolt", bolts[1]),
            *numbered_places("foot", feet),
            *point_places(hit_points),
            *sensor_places(sensors, rows, sites),
        ),
        rigid=(bool(rigid[0]), bool(rigid[1]), bool(rigid[2])),
        across=motion_across(sensors, sites, total=rows[0].size),
        directions=np.array(directions) if len(directions) == len(sensors) else _NONE,
        around_channels=_known(
            (name, tables[body].around(place))
            for name, body, place, direction in sensors
            if len(directions) == len(sensors)
        ),
        around_points=_known(
            (name, tables[BODIES.index(p.body)].around(p.position))
            for name, p in points.items()
        ),
    )


def _known(
    found: Iterable[tuple[str, SurfaceAround | None]],
) -> dict[str, SurfaceAround]:
    """Return the surfaces that the tables show, by name."""
    return {name: one for name, one in found if one is not None}


def _sites(
    tables: Sequence[_Table], sensors: Sequence[PlacedSensor]
) -> list[FloatArray] | None:
    """Return the motion at each sensor in three directions; None if not listed."""
    groups = [table.group.get("phi_site") for table in tables]
    found = []
    for name, body, *_ in sensors:
        group = groups[body]
        if not isinstance(group, h5py.Group) or name not in group:
            return None
        found.append(tables[body].rows(group, name, (3,)))
    return found


def _tables(where: str, file: h5py.File) -> tuple[_Table, ...]:
    model = require_group(where, file, "model")
    found = []
    for name in BODIES:
        place, group = f"{where} body {name}", require_group(where, model, name)
        frequency = finite_array(place, group, "freq_hz")
        if frequency.ndim != 1 or not 1 <= frequency.size <= HITS.most_modes:
            raise FormatError(
                f"{place} has 'freq_hz' of shape {frequency.shape}, 1 to "
                f"{HITS.most_modes} frequencies are read; store one row"
            )
        if frequency.min() < 0:
            raise FormatError(
                f"{place} has a frequency of {frequency.min():g} Hz; store 0 for rigid "
                "motions"
            )
        found.append((place, group, frequency))
    total = sum(f.size for _, _, f in found)
    first = found[0][2].size
    return tuple(
        _Table(*one, before, total)
        for one, before in zip(found, (0, first), strict=True)
    )


def _hit_point(
    tables: Sequence[_Table],
    name: str,
    point: PlannedPoint,
) -> HitPoint:
    if point.body not in BODIES:
        raise FormatError(
            f"hammer point {visible(name)} is on body {shown(point.body)}; write "
            f"{' or '.join(BODIES)} into the nominal parameters"
        )
    table = tables[BODIES.index(point.body)]
    shapes = require_group(table.where, table.group, "phi_hit")
    rows = table.rows(shapes, name, (3,))
    normal = np.array(point.direction)
    across = np.linalg.svd(normal[None])[2][1:]
    slopes = require_group(table.where, table.group, "phi_hit_gradient")
    gradient = table.rows(slopes, name, (3, 3))
    return HitPoint(
        name, normal, across, rows, np.einsum("ad,dcn->acn", across, gradient)
    )
