# SPDX-License-Identifier: MIT
"""Lumped bodies on links, and their modes: the specimen of every bench.

The simulators have separate physics: nothing here is shared with the analysis that is
    tested on it. The modes are those of the linear links alone.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, freeze
from jointbench.acquisition.basics.errors import UsageError
from jointbench.simulators.mechanics.joint_laws import (
    JointLaw,
)

GROUND = -1


@dataclass(frozen=True, slots=True)
class PlantLink:
    """A spring and a damper between two bodies, or a body and the ground.

    Attributes:
        first: index of a body, or `GROUND`.
        second: index of the other body; the elongation is x_second - x_first.
        stiffness: [N/m].
        damping: damping coefficient [N s/m].
    """

    first: int
    second: int
    stiffness: float
    damping: float


@dataclass(frozen=True, slots=True)
class Plant:
    """Bodies that move along one line, and the links between them.

    Attributes:
        masses: of the bodies [kg].
        links: between them.
        laws: forces beyond the linear links.
    """

    masses: tuple[float, ...]
    links: tuple[PlantLink, ...]
    laws: tuple[JointLaw, ...] = ()

    def __post_init__(self) -> None:
        """Refuse masses that are not positive and links without a body."""
        if not all(mass > 0 for mass in self.masses):
            raise UsageError(f"masses must be positive, got {self.masses} kg")
        ends = [(part.first, part.second) for part in self.links]
        ends += [(part.first, part.second) for part in self.laws]
        for first, second in ends:
            if not {first, second} <= {GROUND, *range(len(self.masses))}:
                raise UsageError(
                    f"a link from {first} to {second} leads "
                    f"beyond 0..{len(self.masses) - 1} "
                    f"(the ground is {GROUND})"
                )


@dataclass(frozen=True, slots=True, eq=False)
class PlantModes:
    """Modes of the linear plant.

    Attributes:
        natural_frequency: undamped-equivalent |pole|/(2 pi) [Hz], shape (n_modes,).
        damping_ratio: [-], shape (n_modes,).
        shapes: complex displacement shapes, largest entry 1, shape (n_bodies, n_modes).
    """

    natural_frequency: FloatArray
    damping_ratio: FloatArray
    shapes: ComplexArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "natural_frequency", "damping_ratio", "shapes")


def two_bodies(
    *, m1: float, m2: float, k0: float, c0: float, kj: float, cj: float
) -> Plant:
    """Return ground -(k0, c0)- base m1 -(kj, cj)- top m2, in kg, N/m and N s/m."""
    return Plant((m1, m2), (PlantLink(GROUND, 0, k0, c0), PlantLink(0, 1, kj, cj)))


def plant_matrices(plant: Plant) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return mass [kg], stiffness [N/m] and damping [N s/m], (n_bodies, n_bodies)."""
    size = len(plant.masses)
    stiffness = np.zeros((size, size))
    damping = np.zeros((size, size))
    for link in plant.links:
        elongation = np.zeros(size)
        for body, sign in ((link.first, -1.0), (link.second, 1.0)):
            if body != GROUND:
                elongation[body] += sign
        outer = np.outer(elongation, elongation)
        stiffness += link.stiffness * outer
        damping += link.damping * outer
    return np.diag(plant.masses).astype(float), stiffness, damping


def plant_modes(plant: Plant) -> PlantModes:
    """Solve the state-space eigenvalue problem of the linear plant.

    Args:
        plant: the bodies and links.

    Returns:
        The oscillating modes by ascending frequency.

    Source:
        Ewins, Modal Testing (2000), sec. 2.7.
    """
    mass, stiffness, damping = plant_matrices(plant)
    size = mass.shape[0]
    state = np.block(
        [
            [np.zeros((size, size)), np.eye(size)],
            [-np.linalg.solve(mass, stiffness), -np.linalg.solve(mass, damping)],
        ]
    )
    poles, vectors = scipy.linalg.eig(state)
    upper = np.flatnonzero(poles.imag > 0)
    order = upper[np.argsort(np.abs(poles[upper]))]
    shapes = vectors[:size, order]
    largest = np.argmax(np.abs(shapes), axis=0)
    shapes = shapes / shapes[largest, np.arange(order.size)]
    magnitude = np.abs(poles[order])
    return PlantModes(magnitude / (2 * np.pi), -poles[order].real / magnitude, shapes)
