# SPDX-License-Identifier: MIT
"""Time integration of sliders at all ports in complex modes of the closed structure.

Only the deviation d of a law from its linear spring acts as a force, so the linear
response stays exact. Between two samples force and d change linearly: each mode then
moves by X+ = E X + a0 u0 + a1 u1. The ports of one step are coupled by their
instantaneous receptance, and their laws are corrected together.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.basics.compiled import compiled
from jointbench.analysis.gap.structure_bench.joint_state import JointState
from jointbench.analysis.gap.structure_bench.jointed_bodies import JointedBodies
from jointbench.analysis.gap.structure_bench.structure_settings import STRUCTURE


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
    """
    m, c, k = _matrices(bodies, state, torque)
    held = [d for d in range(3) if state.compliance[d] == 0.0]
    rows = bodies.bolts[:, held].reshape(-1, bodies.omega.size)
    free = _null_space(rows)
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


def _matrices(
    bodies: JointedBodies, state: JointState, torque: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return mass, damping and stiffness of the free modes with elastic joints."""
    omega = bodies.omega * np.sqrt(state.modulus)[bodies.body]
    mass = state.mass[bodies.body]
    m = np.diag(mass)
    c = np.diag(2.0 * state.loss[bodies.body] * omega * mass)
    k = np.diag(omega**2 * mass)
    for i, bolt in enumerate(bodies.bolts):
        factor = state.bolt[i] * torque
        for d in range(3):
            if state.compliance[d] > 0.0:
                square = factor * np.outer(bolt[d], bolt[d])
                k += square / state.compliance[d]
                c += square * state.damping[d]
    feet = bodies.feet.reshape(-1, omega.size)
    k += state.foot[0] * feet.T @ feet
    c += state.foot[1] * feet.T @ feet
    for one in state.attached:
        # An oscillator above the band is a mass; below it, its spring holds the place.
        rows = bodies.places[one.place].rows
        m += one.mass * rows.T @ rows
    return m, c, k


def _null_space(rows: FloatArray) -> FloatArray:
    """Return an orthonormal basis of the motions without any of the rows."""
    if not len(rows):
        return np.eye(rows.shape[1])
    return np.asarray(scipy.linalg.null_space(rows, rcond=STRUCTURE.constraint_rank))


@dataclass(frozen=True, slots=True, eq=False)
class PortSliders:
    """Sliders at the ports.

    Attributes:
        rows: relative motion of each port, shape (n_ports, n_modes).
        stiffness: of all sliders of a port together [N/m], shape (n_ports,).
        slips: slip displacement of each slider [m], shape (n_sliders,).
        weights: share of each slider in the stiffness, shape (n_sliders,).
    """

    rows: FloatArray
    stiffness: FloatArray
    slips: FloatArray
    weights: FloatArray


def port_sliders(
    bodies: JointedBodies, state: JointState, torque: float
) -> PortSliders:
    """Return the sliders of a state's laws.

    Raises:
        ValueError: the state has no laws.
    """
    laws = state.laws
    if laws is None:
        raise ValueError("the state has no laws at its ports")
    ports = np.array(laws.ports, dtype=int)
    rows = bodies.bolts.reshape(-1, bodies.omega.size)[ports]
    spring = state.bolt[ports // 3] * torque / state.compliance[ports % 3]
    return PortSliders(rows, laws.share * spring, laws.slips, laws.weights)


def integrate_sliders(
    modes: ClosedModes,
    sliders: PortSliders,
    columns: FloatArray,
    force: FloatArray,
    sample_rate: float,
) -> FloatArray:
    """Return the deviation of the sliders from their springs.

    Args:
        modes: of the closed structure.
        sliders: at its ports.
        columns: force row of each record in free modes, shape (n_records, n_modes).
        force: [N], shape (n_records, n_samples).
        sample_rate: [Hz].

    Returns:
        Force across each port beyond its linear spring [N], shape
        (n_records, n_ports, n_samples).
    """
    parts = STRUCTURE.integration_steps
    h = 1.0 / (parts * sample_rate)
    z = modes.poles * h
    grown = np.expm1(z)
    a1 = (grown - z) / (modes.poles * z)
    a0 = grown / modes.poles - a1
    across = sliders.rows @ modes.outputs
    push = -(modes.inputs @ sliders.rows.T)
    instant = np.ascontiguousarray(np.real((across * a1) @ push))
    struck = np.ascontiguousarray((modes.inputs @ columns.T).T)
    found = np.empty((len(force), len(sliders.rows), force.shape[1]))
    _integrate(
        (np.exp(z), a0, a1),
        (
            np.ascontiguousarray(across.real),
            np.ascontiguousarray(across.imag),
            np.ascontiguousarray(push.T),
        ),
        instant,
        (sliders.stiffness, sliders.slips, sliders.weights),
        struck,
        np.ascontiguousarray(_sharpened(force)),
        parts,
        found,
    )
    return found


def _sharpened(force: FloatArray) -> FloatArray:
    """Return forces whose straight lines have the spectrum of the forces themselves.

    Straight lines between samples reduce a harmonic by 1 - (omega h)^2 / 12, which a
    second difference restores; without it a pulse of 1 ms is wrong by 0.05 %.
    """
    found = force.copy()
    found[:, 1:-1] -= np.diff(force, 2, axis=1) / 12.0
    return found


@compiled(fastmath=True)
def _integrate(
    steps: tuple[ComplexArray, ComplexArray, ComplexArray],
    ports: tuple[FloatArray, FloatArray, ComplexArray],
    instant: FloatArray,
    laws: tuple[FloatArray, FloatArray, FloatArray],
    struck: ComplexArray,
    force: FloatArray,
    parts: int,
    found: FloatArray,
) -> None:
    """Integrate all records; `found` receives the deviations.

    Args:
        steps: E, a0 and a1 of each pole, shape (n_poles,) each.
        ports: real and imaginary part of the motion of the ports per mode, shape
            (n_ports, n_poles), and modal forces of the ports, same shape.
        instant: motion of the ports by their forces at the end of a step.
        laws: stiffness of the ports, slips and weights of the sliders.
        struck: modal force of each record per N, shape (n_records, n_poles).
        force: [N], shape (n_records, n_samples).
        parts: steps per sample.
        found: shape (n_records, n_ports, n_samples).
    """
    grow, a0, a1 = steps
    real, imag, push = ports
    stiffness, slips, weights = laws
    n_poles, n_ports, n_sliders = grow.size, stiffness.size, slips.size
    x = np.empty(n_poles, dtype=np.complex128)
    before = np.empty(n_poles, dtype=np.complex128)
    stretch = np.empty((n_ports, n_sliders))
    old, new, base = np.empty(n_ports), np.empty(n_ports), np.empty(n_ports)
    d = np.empty(n_ports)
    for record in range(force.shape[0]):
        x[:], before[:], stretch[:], old[:], d[:] = 0.0, 0.0, 0.0, 0.0, 0.0
        found[record, :, 0] = 0.0
        for t in range(force.shape[1] - 1):
            rise = (force[record, t + 1] - force[record, t]) / parts
            for part in range(parts):
                f0 = force[record, t] + part * rise
                f1 = f0 + rise
                for j in range(n_poles):
                    x[j] = grow[j] * x[j] + a0[j] * before[j]
                    if f0 != 0.0 or f1 != 0.0:
                        x[j] += struck[record, j] * (a0[j] * f0 + a1[j] * f1)
                for p in range(n_ports):
                    total = 0.0
                    for j in range(n_poles):
                        total += real[p, j] * x[j].real - imag[p, j] * x[j].imag
                    base[p] = total
                for _ in range(3):
                    for p in range(n_ports):
                        total = base[p]
                        for q in range(n_ports):
                            total += instant[p, q] * d[q]
                        new[p] = total
                    for p in range(n_ports):
                        held = 0.0
                        for i in range(n_sliders):
                            e = stretch[p, i] + new[p] - old[p]
                            held += weights[i] * min(max(e, -slips[i]), slips[i])
                        d[p] = stiffness[p] * (held - new[p])
                for p in range(n_ports):
                    for i in range(n_sliders):
                        e = stretch[p, i] + new[p] - old[p]
                        stretch[p, i] = min(max(e, -slips[i]), slips[i])
                    old[p] = new[p]
                for j in range(n_poles):
                    total_push = 0.0j
                    for p in range(n_ports):
                        total_push += push[p, j] * d[p]
                    x[j] += a1[j] * total_push
                    before[j] = total_push
            for p in range(n_ports):
                found[record, p, t + 1] = d[p]
