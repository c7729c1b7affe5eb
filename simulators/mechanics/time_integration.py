# SPDX-License-Identifier: MIT
"""The stepper: fourth-order Runge-Kutta for bodies, links and joint laws."""

from typing import NamedTuple

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.compiled import compiled
from jointbench.simulators.mechanics.joint_laws import (
    LawArrays,
    LawKind,
    law_force,
    state_rate,
)
from jointbench.simulators.mechanics.sliders import move_slider


class LinearPart(NamedTuple):
    """Bodies and links for the stepper."""

    inverse_mass: FloatArray  # (n_bodies,)
    stiffness: FloatArray  # (n_bodies, n_bodies)
    damping: FloatArray  # (n_bodies, n_bodies)


@compiled(error_model="numpy")
def integrate(
    linear: LinearPart,
    laws: LawArrays,
    force: FloatArray,
    body: int,
    clock: tuple[float, float],
    state: FloatArray,
    memory: FloatArray,
) -> FloatArray:
    """Integrate over all half-step forces; state and slider memory change in place.

    Args:
        linear: bodies and links.
        laws: joint laws.
        force: on `body` at every half step [N], shape (2 n + 1,).
        body: index of the body that is struck.
        clock: time of the first sample, and time step [s].
        state: displacements, velocities, law states, shape (2 n_bodies + n_laws,).
        memory: of the sliders, shape (2, n_sliders).

    Returns:
        Accelerations at the start of each step [m/s^2], shape (n_bodies, n).
    """
    (begin, step), (inverse_mass, stiffness, damping) = clock, linear
    kinds, ends, numbers, banks, sliders, tables, table_step = laws
    size = inverse_mass.size
    acceleration = np.empty((size, force.size // 2))
    trial, slopes = np.empty(state.size), np.zeros((5, state.size))  # first row: rest
    for n in range(acceleration.shape[1]):
        for stage in range(4):
            ahead = 0.5 * step * ((stage + 1) // 2)
            for i in range(state.size):
                trial[i] = state[i] + ahead * slopes[stage, i]
            row, push = stage + 1, force[2 * n + (stage + 1) // 2]
            _linear_rate(
                inverse_mass, stiffness, damping, trial, body, push, slopes, row
            )
            for i in range(kinds.size):
                # No views of arrays: each would change a reference count.
                first, second = ends[i, 0], ends[i, 1]
                r = _difference(trial, first, second)
                v = _difference(trial, first, second, size)
                w, p = trial[2 * size + i], _parameters(numbers, i)
                if kinds[i] == LawKind.SLIDERS:
                    moved = r - _difference(state, first, second)
                    bank = (banks[i, 0], banks[i, 1])
                    attraction = _bank_force(
                        moved, bank, sliders, memory, tables[i], table_step[i]
                    )
                else:
                    now = begin + n * step + ahead
                    attraction = law_force(kinds[i], p, r, v, w, now)
                slopes[row, size + second] -= attraction * inverse_mass[second]
                if first >= 0:
                    slopes[row, size + first] += attraction * inverse_mass[first]
                slopes[row, 2 * size + i] = state_rate(kinds[i], p, v, w)
        for i in range(size):
            acceleration[i, n] = slopes[1, size + i]
        _advance(step, slopes, state, trial)
        for i in range(kinds.size):
            if kinds[i] == LawKind.SLIDERS:
                moved = _difference(trial, ends[i, 0], ends[i, 1])
                bank = (banks[i, 0], banks[i, 1])
                _move_bank(moved, bank, sliders, memory, tables[i], table_step[i])
    return acceleration


@compiled(error_model="numpy")
def _advance(
    step: float, slopes: FloatArray, state: FloatArray, change: FloatArray
) -> None:
    """Advance the state by one step of the classical rule and keep the change."""
    for i in range(state.size):
        mean = slopes[1, i] + 2 * slopes[2, i] + 2 * slopes[3, i] + slopes[4, i]
        change[i] = step / 6 * mean
        state[i] += change[i]


@compiled(error_model="numpy")
def _linear_rate(
    inverse_mass: FloatArray,
    stiffness: FloatArray,
    damping: FloatArray,
    state: FloatArray,
    body: int,
    push: float,
    slopes: FloatArray,
    row: int,
) -> None:
    """Fill a row with velocities and with accelerations of the linear links."""
    size = inverse_mass.size
    for i in range(size):
        total = push if i == body else 0.0
        for j in range(size):
            total -= stiffness[i, j] * state[j] + damping[i, j] * state[size + j]
        slopes[row, i] = state[size + i]
        slopes[row, size + i] = total * inverse_mass[i]


@compiled(error_model="numpy")
def _difference(values: FloatArray, first: int, second: int, offset: int = 0) -> float:
    """Return the motion of body `second` relative to `first` or the ground.

    Args:
        values: displacements, then velocities.
        first: index of a body, or -1 for the ground.
        second: index of the other body.
        offset: number of bodies for the velocity; 0 for the displacement.
    """
    if first < 0:
        return float(values[offset + second])
    return float(values[offset + second] - values[offset + first])


@compiled(error_model="numpy")
def _parameters(
    numbers: FloatArray, law: int
) -> tuple[float, float, float, float, float]:
    """Return the parameters of a law."""
    return (
        numbers[law, 0],
        numbers[law, 1],
        numbers[law, 2],
        numbers[law, 3],
        numbers[law, 4],
    )


@compiled(error_model="numpy")
def _bank_force(
    moved: float,
    bank: tuple[int, int],
    sliders: FloatArray,
    memory: FloatArray,
    table: FloatArray,
    table_step: float,
) -> float:
    """Return the force of a bank displaced by `moved` since the start of the step."""
    total = 0.0
    for k in range(bank[0], bank[1]):
        u, _ = move_slider(
            memory[0, k], memory[1, k], moved * sliders[1, k], table, table_step
        )
        total += float(sliders[0, k]) * u
    return total


@compiled(error_model="numpy")
def _move_bank(
    moved: float,
    bank: tuple[int, int],
    sliders: FloatArray,
    memory: FloatArray,
    table: FloatArray,
    table_step: float,
) -> None:
    """Update the sliders of a bank by the displacement of a whole step."""
    for k in range(bank[0], bank[1]):
        memory[0, k], memory[1, k] = move_slider(
            memory[0, k], memory[1, k], moved * sliders[1, k], table, table_step
        )
