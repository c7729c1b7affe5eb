# SPDX-License-Identifier: MIT
"""Bolted bodies in modal form: rows of bolts, feet, sensors and hit points.

A bolt may stand for a bolted area with many nodes: its rows are the mean relative
motion there, and `spread` holds patterns in which it changes across the area. They are
orthonormal over it, so springs that are spread evenly act on each of them with the
stiffness of the whole.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
from jointbench.analysis.gap.structure_response.structure_settings import STRUCTURE
from jointbench.analysis.gap.structure_response.surface_around import SurfaceAround

DIRECTIONS = ("x", "y", "z")
NORMAL = 2
"""Index of the direction along the bolts."""


@dataclass(frozen=True, slots=True, eq=False)
class MassPlace:
    """A point of a body at which a mass or an oscillator may sit.

    Attributes:
        name: site name, for example ``"P1"`` or ``"top bolt 0"``.
        rows: its motion in the known directions, shape (n_directions, n_modes).
        normal: its motion along the direction of a hit or a sensor, shape
            (1, n_modes); (0, n_modes) where it has no such direction.
    """

    name: str
    rows: FloatArray
    normal: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "rows", "normal")


@dataclass(frozen=True, slots=True, eq=False)
class HitPoint:
    """A hammer point with its neighbourhood.

    Attributes:
        name: of the point.
        direction: unit vector of an exact hit, shape (3,).
        across: two unit vectors at right angles to it, shape (2, 3).
        rows: motion of the point, shape (3, n_modes).
        gradient: derivative of the rows along `across` [1/m], shape (2, 3, n_modes).
    """

    name: str
    direction: FloatArray
    across: FloatArray
    rows: FloatArray
    gradient: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "direction", "across", "rows", "gradient")

    def beside(self, around: SurfaceAround, u: float, v: float) -> "HitPoint":
        """Return the point with its mark beside its place.

        Args:
            around: the surface around it.
            u: offset along the first axis of the surface [m].
            v: along the second [m].
        """
        turned = self.across[:, list(around.axes)]
        slopes = np.einsum("as,scn->acn", turned, around.change_of_slopes(u, v))
        return replace(
            self, rows=self.rows + around.change(u, v), gradient=self.gradient + slopes
        )


@dataclass(frozen=True, slots=True, eq=False)
class JointedBodies:
    """The free bodies by their modes; modes of all bodies in one row.

    Attributes:
        bodies: names of the bodies.
        body: index of each mode's body, shape (n_modes,).
        omega: natural angular frequencies at the nominal modulus [rad/s], 0 for rigid
            motions, shape (n_modes,).
        bolts: relative motion across each bolt, shape (n_bolts, 3, n_modes).
        feet: motion at each foot, shape (n_feet, 3, n_modes).
        channels: names of the response channels.
        sensors: motion along each sensor, shape (n_channels, n_modes).
        points: hammer points.
        places: points at which something may be attached.
        rigid: directions without relative motion at the bolts in the model.
        across: motion at right angles to each sensor along two axes, shape
            (n_channels, 2, n_modes); empty if the table does not list it.
        directions: unit vector of each sensor, shape (n_channels, 3); empty if it is
            not stated.
        around_channels: surface around each sensor that the table shows, by channel.
        around_points: the same around hammer points, by point.
        spread: relative motion beside the mean one of a bolted area, in orthonormal
            patterns, shape (n_spread, n_modes); none for bolts at points.
        spread_of: bolt and direction of each of them, shape (n_spread, 2).
        joints: bolts of each joint, by its name, where there are several joints.
        bolt_names: of the bolts; empty for their numbers.
        thickness: the bodies with one of them thicker by a factor, by its name; none
            for modal tables, which do not show what another thickness would change.
    """

    bodies: tuple[str, ...]
    body: IntArray
    omega: FloatArray
    bolts: FloatArray
    feet: FloatArray
    channels: tuple[str, ...]
    sensors: FloatArray
    points: tuple[HitPoint, ...]
    places: tuple[MassPlace, ...]
    rigid: tuple[bool, bool, bool]
    across: FloatArray
    directions: FloatArray = field(default_factory=lambda: np.zeros((0, 3)))
    around_channels: Mapping[str, SurfaceAround] = field(default_factory=dict)
    around_points: Mapping[str, SurfaceAround] = field(default_factory=dict)
    spread: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    spread_of: IntArray = field(default_factory=lambda: np.zeros((0, 2), np.int64))
    joints: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    bolt_names: tuple[str, ...] = ()
    thickness: Mapping[str, Callable[[float], "JointedBodies"]] = field(
        default_factory=dict
    )

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "body", "omega", "bolts", "feet", "sensors", "across")
        freeze(self, "directions", "spread", "spread_of")

    @property
    def bolt_rows(self) -> FloatArray:
        """Rows that springs of bolts act on: of bolts, then `spread`, (n, n_modes)."""
        n = self.omega.size
        return np.concatenate([self.bolts.reshape(-1, n), self.spread.reshape(-1, n)])

    @property
    def row_bolts(self) -> IntArray:
        """Bolt of each of these rows, shape (n,)."""
        own = np.repeat(np.arange(len(self.bolts)), len(DIRECTIONS))
        return np.concatenate([own, self.spread_of[:, 0]])

    @property
    def row_directions(self) -> IntArray:
        """Direction of each of these rows, shape (n,)."""
        own = np.tile(np.arange(len(DIRECTIONS)), len(self.bolts))
        return np.concatenate([own, self.spread_of[:, 1]])

    @property
    def joint_rows(self) -> FloatArray:
        """Rows of bolts, then of feet, shape (n_joint_rows, n_modes)."""
        feet = self.feet.reshape(-1, self.omega.size)
        return np.concatenate([self.bolt_rows, feet])

    def modes_near(self, band: float) -> IntArray:
        """Return the elastic modes up to some way above a band.

        Args:
            band: highest frequency with force [Hz].
        """
        highest = 2.0 * np.pi * band * STRUCTURE.counted_band
        elastic = self.omega > STRUCTURE.rigid_share * 2.0 * np.pi * band
        return np.flatnonzero(elastic & (self.omega < highest))

    def in_modes(
        self, shapes: FloatArray, omega: FloatArray, body: IntArray
    ) -> "JointedBodies":
        """Return the bodies in modes that are combinations of these.

        Args:
            shapes: of the new modes, shape (n_modes, n_new).
            omega: their natural angular frequencies [rad/s], shape (n_new,).
            body: index of their bodies, shape (n_new,).
        """
        return replace(
            self,
            omega=omega,
            body=body,
            bolts=self.bolts @ shapes,
            spread=self.spread @ shapes,
            feet=self.feet @ shapes,
            sensors=self.sensors @ shapes,
            across=self.across @ shapes,
            points=tuple(
                replace(p, rows=p.rows @ shapes, gradient=p.gradient @ shapes)
                for p in self.points
            ),
            places=tuple(
                replace(p, rows=p.rows @ shapes, normal=p.normal @ shapes)
                for p in self.places
            ),
            around_channels={
                name: one.in_modes(shapes) for name, one in self.around_channels.items()
            },
            around_points={
                name: one.in_modes(shapes) for name, one in self.around_points.items()
            },
        )

    def bolt_name(self, number: int) -> str:
        """Return the name of a bolt."""
        return self.bolt_names[number] if self.bolt_names else f"{number}"

    def bolt_number(self, name: str) -> int:
        """Return the number of a bolt."""
        return self.bolt_names.index(name) if self.bolt_names else int(name)

    def bolts_of(self, name: str) -> tuple[int, ...]:
        """Return the bolts of a joint or, where there is none of that name, a bolt."""
        found = self.joints.get(name)
        return (self.bolt_number(name),) if found is None else found


@dataclass(frozen=True, slots=True, eq=False)
class NominalBench:
    """Nominal parameters of the bench and their uncertainty.

    Attributes:
        stiffness: of each bolt along x, y, z [N/m]; infinite if rigid, shape (3,).
        damping: of each bolt along x, y, z [N s/m], shape (3,).
        stiffness_sd: sd of the log stiffness common to all bolts [-].
        damping_sd: sd of the log damping common to all bolts [-].
        bolt_sd: sd of the log stiffness from bolt to bolt [-].
        foot: stiffness [N/m] and damping [N s/m] of each foot.
        foot_sd: sd of their logarithms [-].
        loss: damping ratio of the free modes [-], and the sd of its logarithm.
        modulus_sd: sd of the log modulus of each body [-].
        mass_sd: sd of the log mass of each body [-].
        aim_sd: sd of the landing point in each direction [m].
        tilt_sd: sd of the direction of a hit [rad].
        torque_reference: bolt torque that the stiffness belongs to [N m].
        bolt_places: of the bolts in the plane of the joint [m], shape (n_bolts, 2);
            empty if they are not stated.
        table_sd: sd of the log frequencies of the modal table [-], and of its shapes as
            a share of their norm [-]; zeros for an exact table.
    """

    stiffness: FloatArray
    damping: FloatArray
    stiffness_sd: float
    damping_sd: float
    bolt_sd: float
    foot: tuple[float, float]
    foot_sd: tuple[float, float]
    loss: tuple[float, float]
    modulus_sd: float
    mass_sd: float
    aim_sd: float
    tilt_sd: float
    torque_reference: float
    bolt_places: FloatArray
    table_sd: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "stiffness", "damping", "bolt_places")
