# SPDX-License-Identifier: MIT
"""Lumped bodies on links, stepped through time: the specimen behind every bench.

The simulators own their physics: nothing here is shared with the analysis that is
judged on it. Time runs in fourth-order Runge-Kutta steps, many to a sample.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numba import njit

from jointbench.acquisition.arrays import ComplexArray, FloatArray, freeze
from jointbench.acquisition.errors import UsageError

GROUND = -1


@dataclass(frozen=True, slots=True)
class Link:
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
    """

    masses: tuple[float, ...]
    links: tuple[Link, ...]

    def __post_init__(self) -> None:
        """Refuse masses that are not positive and links that lead nowhere."""
        if not all(mass > 0 for mass in self.masses):
            raise UsageError(f"masses must be positive, got {self.masses} kg")
        for link in self.links:
            if not {link.first, link.second} <= {GROUND, *range(len(self.masses))}:
                raise UsageError(
                    f"{link} names a body beyond 0..{len(self.masses) - 1} "
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
    return Plant((m1, m2), (Link(GROUND, 0, k0, c0), Link(0, 1, kj, cj)))


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


def rest_state(plant: Plant) -> FloatArray:
    """Return the state at rest: displacements [m], then velocities [m/s]."""
    return np.zeros(2 * len(plant.masses))


def step_plant(
    plant: Plant,
    force: FloatArray,
    *,
    body: int,
    time_step: float,
    state: FloatArray | None = None,
) -> tuple[FloatArray, FloatArray]:
    """March the plant through time under a force on one body.

    Args:
        plant: the bodies and links.
        force: at every half step [N], shape (2 n + 1,) for n steps.
        body: index of the body that is struck.
        time_step: [s].
        state: displacements and velocities at the start, shape (2 n_bodies,); rest if
            None.

    Returns:
        Accelerations at the start of each step [m/s^2], shape (n_bodies, n), and the
        state after the last step.
    """
    masses = np.asarray(plant.masses, dtype=float)
    _, stiffness, damping = plant_matrices(plant)
    start = rest_state(plant) if state is None else state
    acceleration, last = _march(
        np.ascontiguousarray(force, dtype=float),
        body,
        1.0 / masses,
        stiffness,
        damping,
        time_step,
        start.copy(),
    )
    return np.asarray(acceleration), np.asarray(last)


@njit(cache=True)
def _derivative(state, inverse_mass, stiffness, damping, force, body, out):  # type: ignore[no-untyped-def]
    size = inverse_mass.size
    for i in range(size):
        total = 0.0
        for j in range(size):
            total -= stiffness[i, j] * state[j] + damping[i, j] * state[size + j]
        if i == body:
            total += force
        out[i] = state[size + i]
        out[size + i] = total * inverse_mass[i]


@njit(cache=True)
def _march(force, body, inverse_mass, stiffness, damping, step, state):  # type: ignore[no-untyped-def]
    size = inverse_mass.size
    steps = (force.size - 1) // 2
    acceleration = np.empty((size, steps))
    slopes = np.empty((4, 2 * size))
    trial = np.empty(2 * size)
    for n in range(steps):
        for stage in range(4):
            ahead = 0.0 if stage == 0 else (step if stage == 3 else 0.5 * step)
            for i in range(2 * size):
                trial[i] = state[i]
                if stage > 0:
                    trial[i] += ahead * slopes[stage - 1, i]
            push = force[2 * n + (stage + 1) // 2]
            _derivative(
                trial, inverse_mass, stiffness, damping, push, body, slopes[stage]
            )
        for i in range(size):
            acceleration[i, n] = slopes[0, size + i]
        for i in range(2 * size):
            state[i] += (
                step
                / 6.0
                * (slopes[0, i] + 2 * slopes[1, i] + 2 * slopes[2, i] + slopes[3, i])
            )
    return acceleration, state
