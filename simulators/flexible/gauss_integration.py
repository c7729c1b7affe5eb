# SPDX-License-Identifier: MIT
"""Time integration by Gauss collocation with two stages, all hits of a torque at once.

The method is implicit, of fourth order, and conserves the energy of an undamped linear
structure. Joint laws act at ports; their forces at both stages are found by iteration,
which contracts by the square of step times port frequency. The linear structure and the
hammer take four smaller steps in each step, so that modes far above those that the
laws excite keep their phase.

Source:
    Hairer, Lubich and Wanner 2006, Geometric Numerical Integration, sec. II.1.3, IV.2.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import sqrt

import numpy as np
import scipy.linalg

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.simulators.flexible.closed_structure import ClosedStructure
from jointbench.simulators.flexible.friction_and_stops import LawBank, PortMemory

NODES = (0.5 - sqrt(3) / 6, 0.5 + sqrt(3) / 6)
"""Stages as shares of a step [-]."""
_WEIGHTS = np.array([[0.25, 0.25 - sqrt(3) / 6], [0.25 + sqrt(3) / 6, 0.25]])
_BLOCK = 64  # steps without force that are taken at once
_PASSES = 2  # evaluations of the laws in a step
_PARTS = 4  # steps of the linear structure in a step of the laws

Force = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, slots=True, eq=False)
class HitSet:
    """Hits on one structure, integrated together.

    Attributes:
        load: generalised force of one newton of each hit, shape (n_all, n_hits).
        force: of the hits [N] at times [s]: shape (n_times,) to (n_hits, n_times).
        sensors: rows of the accelerometers, shape (n_sensors, n_all).
    """

    load: FloatArray
    force: Force
    sensors: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "load", "sensors")


@dataclass(frozen=True, slots=True, eq=False)
class _Steps:
    """Matrices of one step.

    Attributes:
        rate: time derivative of the state (q, v), shape (2 n, 2 n).
        inverse: of the mass, shape (n, n).
        onward: of the state, shape (2 n, 2 n).
        hammer: of accelerations at the stages of all smaller steps into the state,
            shape (2 parts, 2 n, n).
        entry: of an acceleration at each stage into the state, shape (2, 2 n, n).
        stage: states at the stages, shape (2, 2 n, 2 n).
        reach: of an acceleration at stage j into stage i, shape (2, 2, 2 n, n).
    """

    rate: FloatArray
    inverse: FloatArray
    onward: FloatArray
    hammer: FloatArray
    entry: FloatArray
    stage: FloatArray
    reach: FloatArray


def integrate_hits(
    structure: ClosedStructure,
    hits: HitSet,
    laws: LawBank | None,
    *,
    steps: int,
    step: float,
) -> FloatArray:
    """Return the accelerations of hits on a structure from rest.

    Args:
        structure: assembled.
        hits: loads, forces and sensors.
        laws: of the ports beyond the linear joint; None for none.
        steps: number of steps.
        step: [s].

    Returns:
        Accelerations at the start of each step [m/s^2], shape (n_hits, n_sensors,
        steps).
    """
    matrices = _matrices(structure, step)
    times: FloatArray = step * np.arange(steps, dtype=float)
    force = [hits.force(times + node * step) for node in (*_part_nodes(), *NODES)]
    now = hits.force(times)
    push = np.asarray(matrices.inverse @ (structure.lift.T @ hits.load), dtype=float)
    sense = hits.sensors @ structure.lift
    if laws is None:
        found = _linear(matrices, push, force, sense)
    else:
        found = _with_laws(matrices, structure, push, force, sense, laws)
    struck = np.flatnonzero(now.any(axis=0))
    found[:, :, struck] += (sense @ push).T[:, :, None] * now[:, None, struck]
    return found


def energy(structure: ClosedStructure, state: FloatArray) -> FloatArray:
    """Return kinetic and elastic energy of states (q, v) [J].

    Args:
        structure: assembled.
        state: shape (2 n, any).
    """
    q, v = np.split(state, 2)
    kinetic = np.sum(v * (structure.mass @ v), axis=0)
    elastic = np.sum(q * (structure.stiffness @ q), axis=0)
    return np.asarray(0.5 * (kinetic + elastic))


def propagate(
    structure: ClosedStructure, state: FloatArray, *, step: float, steps: int
) -> FloatArray:
    """Return states some steps later without any force.

    Args:
        structure: assembled.
        state: displacements, then velocities, shape (2 n, any).
        step: [s].
        steps: number of steps.
    """
    onward = _matrices(structure, step).onward
    return np.asarray(np.linalg.matrix_power(onward, steps) @ state)


def _part_nodes() -> tuple[float, ...]:
    """Return the stages of the smaller steps as shares of a step [-]."""
    return tuple((part + node) / _PARTS for part in range(_PARTS) for node in NODES)


def _matrices(structure: ClosedStructure, step: float) -> _Steps:
    """Return the matrices of a step whose linear part is several smaller ones."""
    whole, small = _one_step(structure, step), _one_step(structure, step / _PARTS)
    hammer: list[FloatArray] = []
    after = np.eye(small.onward.shape[0])
    for _ in range(_PARTS):
        hammer = [after @ small.entry, *hammer]
        after = after @ small.onward
    return replace(whole, onward=after, hammer=np.concatenate(hammer))


def _one_step(structure: ClosedStructure, step: float) -> _Steps:
    size = structure.mass.shape[0]
    inverse = np.asarray(np.linalg.inv(structure.mass), dtype=float)
    rate = np.zeros((2 * size, 2 * size))
    rate[:size, size:] = np.eye(size)
    rate[size:, :size] = -inverse @ structure.stiffness
    rate[size:, size:] = -inverse @ structure.damping
    whole = np.eye(4 * size) - step * np.kron(_WEIGHTS, rate)
    solved = np.linalg.inv(whole).reshape(2, 2 * size, 2, 2 * size)
    slopes = np.einsum("iajb,bc->iac", solved, rate)
    jumps = solved[:, :, :, size:].transpose(0, 2, 1, 3)
    onward = np.eye(2 * size) + 0.5 * step * slopes.sum(axis=0)
    stage = np.eye(2 * size) + step * np.einsum("ij,jab->iab", _WEIGHTS, slopes)
    entry = 0.5 * step * jumps.sum(axis=0)
    return _Steps(
        rate=rate,
        inverse=inverse,
        onward=onward,
        hammer=entry,
        entry=entry,
        stage=stage,
        reach=step * np.einsum("ik,kjab->ijab", _WEIGHTS, jumps),
    )


def _linear(
    matrices: _Steps, push: FloatArray, force: list[FloatArray], sense: FloatArray
) -> FloatArray:
    """Return the accelerations without the direct part of the force."""
    size = push.shape[0]
    hits, steps = force[0].shape
    exits = sense @ matrices.rate[size:]
    force = force[: 2 * _PARTS]
    entries = [each @ push for each in matrices.hammer]
    rows = [exits]
    for _ in range(_BLOCK - 1):
        rows.append(rows[-1] @ matrices.onward)
    whole = np.vstack(rows)
    far = np.linalg.matrix_power(matrices.onward, _BLOCK)
    state = np.zeros((2 * size, hits))
    found = np.zeros((hits, sense.shape[0], steps))
    for start in range(0, steps, _BLOCK):
        past = min(start + _BLOCK, steps)
        if all(not f[:, start:past].any() for f in force):
            block = (whole[: (past - start) * sense.shape[0]] @ state).T
            block = block.reshape(hits, past - start, sense.shape[0])
            found[:, :, start:past] = block.transpose(0, 2, 1)
            state = far @ state
            continue
        for k in range(start, past):
            found[:, :, k] = (exits @ state).T
            state = matrices.onward @ state
            for entry, f in zip(entries, force, strict=True):
                state += entry * f[:, k]
    return found


def _with_laws(
    matrices: _Steps,
    structure: ClosedStructure,
    push: FloatArray,
    force: list[FloatArray],
    sense: FloatArray,
    laws: LawBank,
) -> FloatArray:
    """Return the accelerations with laws, without the direct part of the force."""
    size = push.shape[0]
    hits, steps = force[0].shape
    ports = laws.rows @ structure.lift
    both = scipy.linalg.block_diag(ports, ports)
    kick = -matrices.inverse @ ports.T
    count = ports.shape[0]
    exits = sense @ matrices.rate[size:]
    # One product gives the next state, the stages' port motions and the sensors.
    whole = np.vstack(
        (matrices.onward, both @ matrices.stage[0], both @ matrices.stage[1], exits)
    )
    entries = [each @ push for each in matrices.hammer]
    hammer, staged = force[: 2 * _PARTS], force[2 * _PARTS :]
    kicks = np.hstack([matrices.entry[j] @ kick for j in (0, 1)])
    pushed = [
        np.vstack([both @ matrices.reach[i, j] @ push for i in (0, 1)]) for j in (0, 1)
    ]
    coupling = np.block(
        [[both @ matrices.reach[i, j] @ kick for j in (0, 1)] for i in (0, 1)]
    )
    memory = PortMemory(laws, hits)
    direct = sense @ kick
    state = np.zeros((2 * size, hits))
    found = np.zeros((hits, sense.shape[0], steps))
    law_force = np.zeros((2 * count, hits))
    struck = np.any([f.any(axis=0) for f in force], axis=0)
    past = 2 * size + 4 * count
    across, seen = slice(2 * size, past), slice(past, None)
    for k in range(steps):
        product = whole @ state
        state, free = product[: 2 * size], product[across]
        found[:, :, k] = (product[seen] + direct @ memory.force).T
        if struck[k]:
            for row, f in zip(pushed, staged, strict=True):
                free += row * f[:, k]
            for entry, f in zip(entries, hammer, strict=True):
                state += entry * f[:, k]
        for _ in range(_PASSES):
            law_force = memory.stage_forces(free + coupling @ law_force)
        state += kicks @ law_force
        memory.commit(free + coupling @ law_force, both @ state)
    return found
