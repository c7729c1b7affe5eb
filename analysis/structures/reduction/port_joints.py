# SPDX-License-Identifier: MIT
"""Joints and springs between ports of reduced bodies."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData

Side = tuple[str, str]
"""Names of a body and of one of its ports."""


@dataclass(frozen=True, slots=True)
class PortJoint:
    """Two ports, or a port and the ground, with a stiffness for each direction.

    Attributes:
        name: of the joint.
        first: body and port.
        second: body and port, None is the ground. Motion is that of the first side
            relative to the second.
        directions: the rows of the ports are as many equal groups, in order.
    """

    name: str
    first: Side
    second: Side | None
    directions: tuple[str, ...]

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """``"<joint>.<direction>"``."""
        return tuple(f"{self.name}.{one}" for one in self.directions)


@dataclass(frozen=True, slots=True, eq=False)
class PortSpring:
    """A known spring and damper between two ports, or a port and the ground.

    Attributes:
        name: of the spring.
        first: body and port.
        second: body and port, None is the ground.
        stiffness: symmetric, shape (n_rows, n_rows) [N/m, N/rad, N m/rad].
        damping: the same [N s/m ...].
    """

    name: str
    first: Side
    second: Side | None
    stiffness: FloatArray
    damping: FloatArray

    def __post_init__(self) -> None:
        """Check symmetry and sign."""
        for word, matrix in (("stiffness", self.stiffness), ("damping", self.damping)):
            scale = float(np.abs(matrix).max(initial=0.0))
            if np.abs(matrix - matrix.T).max(initial=0.0) > 1e-9 * scale:
                raise BadData(f"{word} of {self.name!r} is not symmetric")
            least = float(np.linalg.eigvalsh(matrix).min(initial=0.0))
            if least < -1e-9 * scale:
                raise BadData(
                    f"{word} of {self.name!r} has the eigenvalue {least:.3g}; springs "
                    "and dampers must not give energy"
                )
        freeze(self, "stiffness", "damping")


def sides_of(joint: PortJoint | PortSpring) -> list[tuple[Side, float]]:
    """Return the sides of a joint with their sign in the relative motion."""
    both = [(joint.first, 1.0)]
    return both if joint.second is None else [*both, (joint.second, -1.0)]
