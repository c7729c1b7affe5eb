# SPDX-License-Identifier: MIT
"""A joint by its pressure: field, totals, even assumption, what is uncertain."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData
from jointbench.analysis.structures.matrices.contact_interface import JointFace
from jointbench.analysis.structures.matrices.parts import GROUND
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.pressure.clamped_loads import (
    ClampBolt,
    bolt_load,
    weight_load,
)
from jointbench.analysis.structures.pressure.closed_patch import open_share
from jointbench.analysis.structures.pressure.interface_compliance import (
    InterfaceCompliance,
    interface_compliance,
)
from jointbench.analysis.structures.pressure.interface_law import InterfaceLaw
from jointbench.analysis.structures.pressure.pressed_surface import (
    PressedSurface,
    press,
)
from jointbench.analysis.structures.pressure.pressure_totals import (
    SurfacePoints,
    joint_totals,
)

_GRID = np.geomspace(1e-3, 1e3, 61)
"""Pressures at which a law is asked for, over the mean one [-]."""
_WIDE = 1.96

LawAt = Callable[[FloatArray, float], InterfaceLaw]
"""A law at pressures [Pa], with its reference area multiplied by a factor."""


@dataclass(frozen=True, slots=True, eq=False)
class PressureCase:
    """What presses a joint.

    Attributes:
        between: the two bodies, first the one whose outward normal is the joint's.
        bolts: across it.
        law: of the interface.
        gravity: direction in which things fall, shape (3,), or None for no weight.
        common_sd: of ln of all preloads together: wrench, nut factor [-].
        area_sd: of ln of the law's reference area [-].
        crown: gap at the corner farthest from the centroid before anything presses,
            as of two crowned surfaces [m].
    """

    between: tuple[str, str]
    bolts: tuple[ClampBolt, ...]
    law: LawAt
    gravity: FloatArray | None = None
    common_sd: float = 0.0
    area_sd: float = 0.0
    crown: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class JointPressure:
    """A joint by its pressure.

    Attributes:
        points: of the surface.
        law: of the interface.
        surface: pressures and gaps at the points.
        force: on the surface [N].
        totals: see `QUANTITIES`, shape (6,).
        interval: 95 % of them, shape (6, 2).
        even: totals if the pressure were the same everywhere, shape (6,).
        opened: share of the surface that is open [-].
        parts: standard deviation of ln of the totals by cause, each shape (6,).
        frame: rows normal, first and second tangent, shape (3, 3).
        element_share: largest element beside a bolt over the diameter of its head [-];
            0 without bolts.
    """

    points: SurfacePoints
    law: InterfaceLaw
    surface: PressedSurface
    force: float
    totals: FloatArray
    interval: FloatArray
    even: FloatArray
    opened: float
    parts: dict[str, FloatArray]
    frame: FloatArray
    element_share: float

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "totals", "interval", "even", "frame")

    @property
    def mean(self) -> float:
        """Force over the area of the surface [Pa]."""
        return self.force / self.points.total


def joint_pressure(
    structure: Structure, joint: str, case: PressureCase
) -> JointPressure:
    """Compute the pressure over a joint, and its stiffness from it.

    Args:
        structure: the bodies with their supports.
        joint: name of the joint.
        case: bolts, weight and law.

    Raises:
        BadData: nothing presses the joint, a bolt is not on the bodies, or the search
            does not end.
    """
    number = structure.joints.index(joint)
    face = structure.faces[number]
    points = _points(structure, number, case.bolts)
    weight = None if case.gravity is None else weight_load(structure, case.gravity)
    clamp = sum(one.preload for one in case.bolts)
    weights = 0.0 if weight is None else float(np.abs(weight).sum())
    if not clamp + weights > 0:
        raise BadData(
            f"nothing presses joint {joint!r}: no bolt has a preload and there is no "
            "gravity; give a preload or a torque"
        )
    columns = [bolt_load(structure, face, case.between, bolt) for bolt in case.bolts]
    sizes = [bolt.preload for bolt in case.bolts]
    if weight is not None:
        columns, sizes = [*columns, weight], [*sizes, 1.0]
    guess = (clamp or weights) / points.total
    law = case.law(_GRID * guess, 1.0)
    springs = float(law.stiffness(np.array(guess)))
    bodies = interface_compliance(structure, number, columns, springs)
    solver = _Solver(bodies, points, np.array(sizes), _form(points, case.crown))
    surface = solver.press(law, np.ones(len(sizes)))
    force = float(points.area @ surface.pressure)
    totals = joint_totals(points, law, surface.pressure)
    parts = _parts(solver, case, law, surface, guess)
    wide = _WIDE * np.sqrt(np.sum([one**2 for one in parts.values()], axis=0))
    interval = np.stack([totals * np.exp(-wide), totals * np.exp(wide)], axis=1)
    even = joint_totals(points, law, np.full(points.area.size, force / points.total))
    opened = open_share(points, law, surface)
    return JointPressure(
        points,
        law,
        surface,
        force,
        totals,
        interval,
        even,
        opened,
        parts,
        face.frame,
        _element_share(face, case),
    )


@dataclass(frozen=True, slots=True)
class _Solver:
    bodies: InterfaceCompliance
    points: SurfacePoints
    sizes: FloatArray
    form: FloatArray

    def press(
        self, law: InterfaceLaw, factors: FloatArray, start: FloatArray | None = None
    ) -> PressedSurface:
        loads = self.sizes * factors
        return press(self.bodies, law, self.points.area, loads, self.form, start=start)


def _points(
    structure: Structure, number: int, bolts: Sequence[ClampBolt]
) -> SurfacePoints:
    """Return the points of the surface; within the holes of bolts nothing touches."""
    face = structure.faces[number]
    place = face.points.position @ face.frame[1:].T
    area = face.points.weight.copy()
    for bolt in bolts:
        reach = np.linalg.norm(place - np.asarray(bolt.position), axis=1)
        if float(reach.min()) > bolt.head / 2:
            raise BadData(
                f"{bolt.name}: it is {1e3 * float(reach.min()):.3g} mm outside of the "
                "surface of the joint; check position and unit"
            )
        area[reach < bolt.hole / 2] = 0.0
    return SurfacePoints(place, area)


def _element_share(face: JointFace, case: PressureCase) -> float:
    """Return the largest element within a head's diameter of a bolt, over the head."""
    size = np.zeros(face.points.weight.size)
    sides = (face.points.first, face.points.second)
    for name, cells in zip(case.between, sides, strict=True):
        if name != GROUND:
            area = np.bincount(cells, weights=face.points.weight)
            size = np.maximum(size, np.sqrt(area)[cells])
    place = face.points.position @ face.frame[1:].T
    shares = [0.0]
    for bolt in case.bolts:
        away = np.linalg.norm(place - np.asarray(bolt.position), axis=1)
        shares.append(float(size[away <= bolt.head].max(initial=0.0)) / bolt.head)
    return max(shares)


def _form(points: SurfacePoints, crown: float) -> FloatArray:
    """Return the gap of crowned surfaces [m], shape (n_points,)."""
    reach = ((points.place - points.centre) ** 2).sum(axis=1)
    farthest = ((points.corners - points.centre) ** 2).sum(axis=2).max()
    return np.asarray(crown * reach / farthest)


def _parts(
    solver: _Solver,
    case: PressureCase,
    law: InterfaceLaw,
    surface: PressedSurface,
    guess: float,
) -> dict[str, FloatArray]:
    """Return what each cause leaves open of ln of the totals, each shape (6,)."""
    ones = np.ones(solver.sizes.size)
    bolts = np.arange(ones.size) < len(case.bolts)

    def moved(low: InterfaceLaw, high: InterfaceLaw, step: FloatArray) -> FloatArray:
        ends = []
        for one, sign in ((low, -1.0), (high, 1.0)):
            found = solver.press(one, ones * np.exp(sign * step), surface.pressure)
            ends.append(joint_totals(solver.points, one, found.pressure))
        kept = np.minimum(*ends) > 0
        ratio = np.where(kept, ends[1], 1.0) / np.where(kept, ends[0], 1.0)
        return np.asarray(0.5 * np.log(ratio))

    none = 0.0 * ones
    parts = {}
    if law.log_sd:
        ends = law.scaled(np.exp(-law.log_sd)), law.scaled(np.exp(law.log_sd))
        parts["contact law"] = moved(*ends, none)
    if case.area_sd:
        grid = _GRID * guess
        ends = (
            case.law(grid, np.exp(-case.area_sd)),
            case.law(grid, np.exp(case.area_sd)),
        )
        parts["reference area"] = moved(*ends, none)
    if case.common_sd and bolts.any():
        parts["all preloads"] = moved(law, law, np.where(bolts, case.common_sd, 0.0))
    own = [
        moved(law, law, bolt.log_sd * (np.arange(ones.size) == i))
        for i, bolt in enumerate(case.bolts)
        if bolt.log_sd and bolt.preload
    ]
    if own:
        parts["each preload"] = np.sqrt(np.sum([one**2 for one in own], axis=0))
    return parts
