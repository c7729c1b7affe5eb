# SPDX-License-Identifier: MIT
"""Time integration of a plant under a force, from a given state."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.simulators.mechanics.joint_laws import (
    pack_laws,
    resting_sliders,
)
from jointbench.simulators.mechanics.plant import Plant, plant_matrices
from jointbench.simulators.mechanics.time_integration import LinearPart, integrate


@dataclass(frozen=True, slots=True, eq=False)
class PlantState:
    """State of a plant between two time integrations.

    Attributes:
        time: [s].
        values: displacements [m], velocities [m/s], then one state of each law,
            shape (2 n_bodies + n_laws,).
        sliders: memory of all sliders, shape (2, n_sliders).
    """

    time: float
    values: FloatArray
    sliders: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "values", "sliders")


def rest_state(plant: Plant) -> PlantState:
    """Return the state at rest at time 0."""
    laws = pack_laws(plant.laws)
    values = np.zeros(2 * len(plant.masses) + laws.kind.size)
    return PlantState(0.0, values, resting_sliders(laws))


def step_plant(
    plant: Plant,
    force: FloatArray,
    *,
    body: int,
    time_step: float,
    state: PlantState | None = None,
) -> tuple[FloatArray, PlantState]:
    """Integrate the plant in time under a force on one body.

    Args:
        plant: the bodies, links and laws.
        force: at every half step [N], shape (2 n + 1,) for n steps.
        body: index of the body that is struck.
        time_step: [s].
        state: at the start; rest if None.

    Returns:
        Accelerations at the start of each step [m/s^2], shape (n_bodies, n), and the
        state after the last step.
    """
    start = rest_state(plant) if state is None else state
    _, stiffness, damping = plant_matrices(plant)
    inverse_mass = 1 / np.asarray(plant.masses, dtype=float)
    values, sliders = start.values.copy(), start.sliders.copy()
    acceleration = integrate(
        LinearPart(inverse_mass, stiffness, damping),
        pack_laws(plant.laws),
        np.array(force, dtype=float),
        body,
        (start.time, time_step),
        values,
        sliders,
    )
    end = start.time + time_step * acceleration.shape[1]
    return np.asarray(acceleration), PlantState(end, values, sliders)
