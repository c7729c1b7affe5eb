# SPDX-License-Identifier: MIT
"""Two bolted bodies in modal form: rows of bolts, feet, sensors and hit points."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray, freeze
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

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "body", "omega", "bolts", "feet", "sensors", "across")
        freeze(self, "directions")

    @property
    def joint_rows(self) -> FloatArray:
        """Rows of bolts, then of feet, shape (3 n_bolts + 3 n_feet, n_modes)."""
        n = self.omega.size
        return np.concatenate([self.bolts.reshape(-1, n), self.feet.reshape(-1, n)])


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
