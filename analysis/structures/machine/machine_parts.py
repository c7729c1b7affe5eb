# SPDX-License-Identifier: MIT
"""Parts of a machine: solids, beams, rigid bodies, springs, points."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData, UsageError
from jointbench.analysis.structures.machine.measured_parts import (
    MachineLink,
    MeasuredPart,
    require_points,
)
from jointbench.analysis.structures.matrices.beam_body import BeamBody, cross_matrix
from jointbench.analysis.structures.matrices.parts import GROUND
from jointbench.analysis.structures.matrices.structure import Structure
from jointbench.analysis.structures.matrices.surface_motion import Attachment

SPRING_DIRECTIONS = ("x", "y", "z", "turn_x", "turn_y", "turn_z")
"""Of a spring: displacement along, and rotation about, its axis and two others."""
# Largest asymmetry of a symmetric matrix, as a share of its largest value.
_ASYMMETRY = 1e-9


@dataclass(frozen=True, slots=True)
class RigidPart:
    """A rigid body.

    Attributes:
        name: of the body.
        position: of its centre [m].
        mass: [kg].
        inertia: about the centre along x, y and z [kg m^2].
        axis: about which it can turn, a principal axis; None is none.
    """

    name: str
    position: tuple[float, float, float]
    mass: float
    inertia: tuple[float, float, float]
    axis: tuple[float, float, float] | None = None

    @property
    def gyroscopic(self) -> FloatArray:
        """G of a turn about the axis at 1 rad/s [kg m^2], shape (6, 6)."""
        found = np.zeros((6, 6))
        if self.axis is not None:
            axis = np.asarray(self.axis) / np.linalg.norm(self.axis)
            polar = float(axis**2 @ np.asarray(self.inertia))
            found[3:, 3:] = -polar * cross_matrix(axis)
        return found


@dataclass(frozen=True, slots=True)
class JointSetting:
    """Values of a joint over an area.

    Attributes:
        stiffness: totals, normal and two tangents [N/m].
        damping: totals [N s/m].
        stiffness_sd: relative standard deviation [-].
        damping_sd: relative standard deviation [-].
    """

    stiffness: tuple[float, float, float]
    damping: tuple[float, float, float] = (0.0, 0.0, 0.0)
    stiffness_sd: float = 0.0
    damping_sd: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class MachineSpring:
    """Springs and dampers between pieces of two bodies, or of a body and the ground.

    Attributes:
        name: of the spring.
        between: two bodies, or a body and ``"ground"``.
        pieces: of the two bodies; both move as at the position of the first.
        axis: first direction; None is x, y, z.
        stiffness: of `SPRING_DIRECTIONS` [N/m, N m/rad].
        damping: [N s/m, N m s/rad].
        deviations: relative standard deviations of stiffness and damping [-].
        matrices: coupled stiffness and damping in place of single values, each of shape
            (6, 6); None uses the single values.
    """

    name: str
    between: tuple[str, str]
    pieces: tuple[Attachment, Attachment]
    axis: tuple[float, float, float] | None
    stiffness: tuple[float, ...]
    damping: tuple[float, ...]
    deviations: tuple[float, float] = (0.0, 0.0)
    matrices: tuple[FloatArray, FloatArray] | None = None

    def __post_init__(self) -> None:
        """Check that coupled matrices are symmetric and give no energy."""
        for word, matrix in zip(
            ("stiffness", "damping"), self.matrices or (), strict=False
        ):
            scale = float(np.abs(matrix).max())
            if np.abs(matrix - matrix.T).max() > _ASYMMETRY * scale:
                raise BadData(f"the {word} matrix of {self.name!r} is not symmetric")
            least = float(np.linalg.eigvalsh(matrix)[0])
            if least < -_ASYMMETRY * scale:
                raise BadData(
                    f"the {word} matrix of {self.name!r} has the eigenvalue {least:.3g}"
                    "; springs and dampers must not give energy"
                )


@dataclass(frozen=True, slots=True)
class MachinePoint:
    """A point where loads act and motion is read.

    Attributes:
        body: its name.
        position: [m].
    """

    body: str
    position: tuple[float, float, float]


@dataclass(frozen=True, slots=True, eq=False)
class Machine:
    """A machine.

    Attributes:
        structure: solids with their joints, supports and attached masses.
        beams: spindles and screws.
        rigid: rigid bodies.
        settings: values of the joints of `structure`, by name.
        springs: between bodies of any kind.
        points: by name.
        speeds: of the beams and rigid bodies that turn about their axes, by name
            [rad/s].
        measured: bodies that were measured alone.
        links: between these and other bodies.
    """

    structure: Structure
    beams: tuple[BeamBody, ...]
    rigid: tuple[RigidPart, ...]
    settings: Mapping[str, JointSetting]
    springs: tuple[MachineSpring, ...]
    points: Mapping[str, MachinePoint]
    speeds: Mapping[str, float] = field(default_factory=dict)
    measured: tuple[MeasuredPart, ...] = ()
    links: tuple[MachineLink, ...] = ()

    def __post_init__(self) -> None:
        """Check that names are used once, and that those named exist."""
        names = self.bodies
        require_points(self.measured, self.links)
        all_of = [*names, *self.structure.joints, *(s.name for s in self.springs)]
        all_of += [one.name for one in self.measured]
        all_of += [one.name for one in self.links]
        twice = {one for one in all_of if all_of.count(one) > 1}
        if twice:
            raise UsageError(f"names of bodies and joints are given twice: {twice}")
        for spring in self.springs:
            first, second = spring.between
            if first not in names or second not in {*names, GROUND} or first == second:
                raise UsageError(
                    f"spring {spring.name!r} is between {spring.between}; it must join "
                    f"two of {names}, or one of them (first) and {GROUND!r}"
                )
        for name, point in self.points.items():
            if point.body not in names:
                raise UsageError(
                    f"point {name!r} is on {point.body!r}; bodies are {names}"
                )
        turning = [one.name for one in self.beams]
        turning += [one.name for one in self.rigid if one.axis is not None]
        for name in self.speeds:
            if name not in turning:
                raise UsageError(
                    f"body {name!r} has a speed; beams, and rigid bodies with an axis, "
                    f"can turn: {turning}"
                )

    @property
    def bodies(self) -> list[str]:
        """Names of all modelled bodies: solids, beams, rigid ones."""
        return [
            *(one.name for one in self.structure.bodies),
            *(one.name for one in self.beams),
            *(one.name for one in self.rigid),
        ]
