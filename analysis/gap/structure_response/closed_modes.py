# SPDX-License-Identifier: MIT
"""Complex modes of the closed structure, in which laws at its joints are integrated."""

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.analysis.gap.structure_response.joint_state import JointState
from jointbench.analysis.gap.structure_response.jointed_bodies import (
    NORMAL,
    JointedBodies,
)
from jointbench.analysis.gap.structure_response.structure_settings import STRUCTURE


@dataclass(frozen=True, slots=True, eq=False)
class ClosedModes:
    """Complex modes of the closed structure, those with Im >= 0.

    Attributes:
        poles: [rad/s], shape (n_poles,).
        inputs: modal force per force on a free mode, shape (n_poles, n_modes).
        outputs: motion of the free modes per mode; a real motion is the real part of
            the sum over the poles, shape (n_modes, n_poles).
    """

    poles: ComplexArray
    inputs: ComplexArray
    outputs: ComplexArray


def closed_modes(
    bodies: JointedBodies, state: JointState, torque: float
) -> ClosedModes:
    """Return the complex modes of bodies closed by their joints.

    Rigid directions are constraints: the free modes move in their null space only.

    Args:
        bodies: modes and rows.
        state: of the model.
        torque: factor of the torque on stiffness and damping of the bolts [-].

    Raises:
        ValueError: the joint rocks while its bolts are rigid, which leaves no stiffness
            between them.
    """
    if state.rocking is not None and state.compliance[NORMAL] == 0.0:
        raise ValueError("a joint rocks in time about bolts that yield alone")
    m, c, k = mass_damping_stiffness(bodies, state, torque)
    free = free_motions(bodies, state)
    m, c, k = (free.T @ x @ free for x in (m, c, k))
    n = len(m)
    inverse = np.linalg.inv(m)
    system = np.zeros((2 * n, 2 * n))
    system[:n, n:] = np.eye(n)
    system[n:, :n], system[n:, n:] = -inverse @ k, -inverse @ c
    poles, vectors = np.linalg.eig(system)
    left = np.linalg.inv(vectors)[:, n:] @ inverse @ free.T
    kept = poles.imag >= 0.0
    twice = np.where(poles[kept].imag > 0.0, 2.0, 1.0)
    return ClosedModes(poles[kept], left[kept], (free @ vectors[:n])[:, kept] * twice)


@dataclass(frozen=True, slots=True, eq=False)
class RealModes:
    """Undamped modes of the closed structure.

    Attributes:
        omega: natural angular frequencies [rad/s], shape (n,).
        damping: between modes [rad/s], shape (n, n).
        shapes: in the free modes, of unit modal mass, shape (n_modes, n).
    """

    omega: FloatArray
    damping: FloatArray
    shapes: FloatArray

    @property
    def ratios(self) -> FloatArray:
        """Damping ratios [-], shape (n,)."""
        return np.asarray(np.diag(self.damping) / (2.0 * self.omega))


def real_modes(bodies: JointedBodies, state: JointState) -> RealModes:
    """Return the undamped modes of bodies closed by their joints.

    Args:
        bodies: modes and rows.
        state: of the model.
    """
    m, c, k = mass_damping_stiffness(bodies, state, 1.0)
    free = free_motions(bodies, state)
    m, c, k = (free.T @ x @ free for x in (m, c, k))
    square, vectors = scipy.linalg.eigh(k, m)
    omega = np.sqrt(np.maximum(square, STRUCTURE.least_direction))
    return RealModes(omega, vectors.T @ c @ vectors, free @ vectors)


def mass_damping_stiffness(
    bodies: JointedBodies, state: JointState, torque: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return mass, damping and stiffness of the free modes with elastic joints.

    Args:
        bodies: modes and rows.
        state: of the model.
        torque: factor of the torque on stiffness and damping of the bolts [-].
    """
    omega = state.omega(bodies)
    mass = state.mass[bodies.body]
    m = np.diag(mass)
    c = np.diag(2.0 * state.loss[bodies.body] * omega * mass)
    k = np.diag(omega**2 * mass)
    for d in range(3):
        if state.compliance[d] > 0.0:
            own = bodies.row_directions == d
            along = bodies.bolt_rows[own]
            stiffness = _between_bolts(state, d, torque)[bodies.row_bolts[own]]
            square = along.T @ stiffness[:, bodies.row_bolts[own]] @ along
            k += square
            c += square * state.compliance[d] * state.damping[d]
    feet = bodies.feet.reshape(-1, omega.size)
    k += (state.foot[0] * np.repeat(state.foot_factor, 3) * feet.T) @ feet
    c += state.foot[1] * feet.T @ feet
    if state.tuned is not None:
        k += state.tuned.rows.T @ state.tuned.stiffness @ state.tuned.rows
    for one in state.attached:
        # An oscillator above the band is a mass; below it, its spring holds the place.
        rows = one.rows(bodies)
        m += one.mass * rows.T @ rows
        k += one.stiffness * rows.T @ rows
    return m, c, k


def _between_bolts(state: JointState, direction: int, torque: float) -> FloatArray:
    """Return the stiffness of the bolts in a direction [N/m], (n_bolts, n_bolts).

    Its inverse is what couples them where the joint rocks. It loses as much energy per
    cycle as the bolts do.
    """
    own = state.bolt * torque / state.compliance[direction]
    if direction != NORMAL or state.rocking is None:
        return np.diag(own)
    return np.asarray(np.linalg.inv(np.diag(1.0 / own) + state.rocking))


def free_motions(bodies: JointedBodies, state: JointState) -> FloatArray:
    """Return an orthonormal basis of the motions that rigid directions allow."""
    held = [d for d in range(3) if state.compliance[d] == 0.0]
    rows = bodies.bolt_rows[np.isin(bodies.row_directions, held)]
    if not len(rows):
        return np.eye(rows.shape[1])
    return np.asarray(scipy.linalg.null_space(rows, rcond=STRUCTURE.constraint_rank))
