# SPDX-License-Identifier: MIT
"""Time integration of laws at all ports in complex modes of the closed structure.

Only the deviation d of a law from its linear spring acts as a force, so the linear
response stays exact. Between two samples force and d change linearly: each mode then
moves by X+ = E X + a0 u0 + a1 u1. The ports of one step are coupled by their
instantaneous receptance, and their laws are corrected together.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, IntArray
from jointbench.acquisition.basics.compiled import compiled
from jointbench.analysis.gap.structure_bench.joint_state import JointState
from jointbench.analysis.gap.structure_bench.jointed_bodies import JointedBodies
from jointbench.analysis.gap.structure_bench.port_laws import LawForm, law_ports
from jointbench.analysis.gap.structure_bench.structure_settings import STRUCTURE

_Laws = tuple[IntArray, FloatArray, FloatArray, FloatArray, FloatArray]
"""Kinds, sizes, gaps, slips and weights of the ports."""


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
        ValueError: the joint rocks, which has no stiffness of its own.
    """
    if state.rocking is not None:
        raise ValueError("a rocking compliance is not integrated in time")
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
    omega = state.omega(bodies)
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
    k += (state.foot[0] * np.repeat(state.foot_factor, 3) * feet.T) @ feet
    c += state.foot[1] * feet.T @ feet
    for one in state.attached:
        # An oscillator above the band is a mass; below it, its spring holds the place.
        rows = one.rows(bodies)
        m += one.mass * rows.T @ rows
        k += one.stiffness * rows.T @ rows
    return m, c, k


def _null_space(rows: FloatArray) -> FloatArray:
    """Return an orthonormal basis of the motions without any of the rows."""
    if not len(rows):
        return np.eye(rows.shape[1])
    return np.asarray(scipy.linalg.null_space(rows, rcond=STRUCTURE.constraint_rank))


@dataclass(frozen=True, slots=True, eq=False)
class ActingLaws:
    """All laws of a state, a row for each port.

    Attributes:
        rows: relative motion of each port, shape (n_ports, n_modes).
        kinds: of the law of each port, shape (n_ports,).
        sizes: stiffness of all sliders together [N/m], or as `LawForm` states,
            shape (n_ports,).
        gaps: clearance [m], shape (n_ports,).
        slips: slip displacement of each slider [m], shape (n_ports, n_sliders).
        weights: share of each slider in the stiffness, shape (n_ports, n_sliders).
        preload: power of the slip displacements in the torque [-], shape (n_ports,).
    """

    rows: FloatArray
    kinds: IntArray
    sizes: FloatArray
    gaps: FloatArray
    slips: FloatArray
    weights: FloatArray
    preload: FloatArray

    @property
    def slides(self) -> bool:
        """Whether all laws are friction, which ends where no slider slips again."""
        return bool(np.all(self.kinds == LawForm.FRICTION))


def acting_laws(bodies: JointedBodies, state: JointState, torque: float) -> ActingLaws:
    """Return the laws of a state.

    Args:
        bodies: modes and rows.
        state: with at least one law.
        torque: factor of the torque on stiffness and damping of the bolts [-].
    """
    ports = np.array(law_ports(state.laws), dtype=int)
    own = np.repeat(np.arange(len(state.laws)), [len(w.ports) for w in state.laws])
    laws = [state.laws[k] for k in own]
    kinds = np.array([law.kind for law in laws], dtype=np.int64)
    spring = state.bolt[ports // 3] * torque / state.compliance[ports % 3]
    sizes = np.array([law.size for law in laws])
    count = max(law.slips.size for law in laws)
    slips, weights = np.zeros((len(laws), count)), np.zeros((len(laws), count))
    for k, law in enumerate(laws):
        slips[k, : law.slips.size] = law.slips
        weights[k, : law.weights.size] = law.weights
    return ActingLaws(
        rows=bodies.bolts.reshape(-1, bodies.omega.size)[ports],
        kinds=kinds,
        sizes=np.where(kinds == LawForm.FRICTION, sizes * spring, sizes),
        gaps=np.array([law.gap for law in laws]),
        slips=slips,
        weights=weights,
        preload=np.array([law.preload for law in laws]),
    )


def integrate_laws(
    modes: ClosedModes,
    laws: ActingLaws,
    columns: FloatArray,
    force: FloatArray,
    steps: tuple[float, int],
    preload: FloatArray,
) -> FloatArray:
    """Return the forces of laws beyond the linear springs of their ports.

    Args:
        modes: of the closed structure.
        laws: at its ports.
        columns: force row of each record in free modes, shape (n_records, n_modes).
        force: [N], shape (n_records, n_samples).
        steps: sample rate [Hz], and steps per sample.
        preload: torque of each record over the reference [-], shape (n_records,).

    Returns:
        Force across each port [N], averaged about each sample as `averaging` states,
        shape (n_records, n_ports, n_samples).
    """
    rate, parts = steps
    h = 1.0 / (parts * rate)
    z = modes.poles * h
    grown = np.expm1(z)
    a1 = (grown - z) / (modes.poles * z)
    a0 = grown / modes.poles - a1
    across = laws.rows @ modes.outputs
    push = -(modes.inputs @ laws.rows.T)
    struck = (modes.inputs @ columns.T).T
    found = np.zeros((len(force), len(laws.rows), force.shape[1]))
    corrections = STRUCTURE.slider_corrections
    if not laws.slides:
        corrections = STRUCTURE.law_corrections
    _integrate(
        (
            _parts_of(np.exp(z)),
            _parts_of(a0),
            _parts_of(a1),
            _parts_of(-1 / modes.poles),
        ),
        (_parts_of(across), _parts_of(across * modes.poles), _parts_of(push.T)),
        (
            np.ascontiguousarray(np.real((across * a1) @ push)),
            np.ascontiguousarray(np.real((across * modes.poles * a1) @ push)),
        ),
        (laws.kinds, laws.sizes, laws.gaps, laws.slips, laws.weights),
        preload[:, None] ** laws.preload,
        (_parts_of(struck), np.ascontiguousarray(_sharpened(force))),
        (parts, corrections, STRUCTURE.rest_steps if laws.slides else 0),
        found,
    )
    return found


def averaging(s: ComplexArray, sample_rate: float, parts: int) -> ComplexArray:
    """Return the factor by which the average about a sample changes each line.

    A force with kinks has a spectrum far beyond the sample rate, which would fold back.
    Its average over the steps from one sample before to one after, with weights of a
    triangle, is reduced by 40 dB about the sample rate; the factor restores the rest.

    Args:
        s: Laplace variable of each line [rad/s], shape (n_lines,).
        sample_rate: [Hz].
        parts: steps per sample.
    """
    at = np.arange(1 - parts, parts)
    weights = (1.0 - np.abs(at) / parts) / parts
    return np.asarray(np.exp(-s[:, None] * at / (parts * sample_rate)) @ weights)


def _parts_of(values: ComplexArray) -> FloatArray:
    """Return real and imaginary parts in rows of their own, shape (2, ...)."""
    return np.ascontiguousarray(np.stack([values.real, values.imag]))


def _sharpened(force: FloatArray) -> FloatArray:
    """Return forces whose straight lines have the spectrum of the forces themselves.

    Straight lines between samples reduce a harmonic by 1 - (omega h)^2 / 12, which a
    second difference restores; without it a pulse of 1 ms is wrong by 0.05 %.
    """
    found = force.copy()
    found[:, 1:-1] -= np.diff(force, 2, axis=1) / 12.0
    return found


@compiled(fastmath=True)
def _motion(rows: FloatArray, x: FloatArray, out: FloatArray) -> None:
    """Write the motion of the ports at modal coordinates x."""
    for p in range(out.size):
        total = 0.0
        for j in range(x.shape[1]):
            total += rows[0, p, j] * x[0, j] - rows[1, p, j] * x[1, j]
        out[p] = total


@compiled(fastmath=True)
def _port_forces(
    laws: _Laws,
    scale: FloatArray,
    motion: tuple[FloatArray, FloatArray, FloatArray],
    stretch: tuple[FloatArray, FloatArray],
    d: FloatArray,
) -> None:
    """Write the force of each law, and the stretch of its sliders.

    Args:
        laws: kinds, sizes, gaps, slips and weights.
        scale: of the slips of each port.
        motion: of the ports before and after the step, and velocity after it.
        stretch: of the sliders before the step, and after it (written).
        d: force of each port (written).
    """
    kinds, sizes, gaps, slips, weights = laws
    old, new, speed = motion
    before, after = stretch
    for p in range(d.size):
        r = new[p]
        if kinds[p] == 0:
            moved, held, s = r - old[p], 0.0, scale[p]
            for i in range(slips.shape[1]):
                limit = s * slips[p, i]
                e = min(max(before[p, i] + moved, -limit), limit)
                after[p, i] = e
                held += weights[p, i] * e
            d[p] = sizes[p] * (held - r)
        elif kinds[p] == 1:
            d[p] = sizes[p] * max(r - gaps[p], 0.0)
        elif kinds[p] == 2:
            d[p] = sizes[p] * r * r * r
        elif kinds[p] == 3:
            d[p] = sizes[p] * r * r
        else:
            d[p] = sizes[p] * speed[p] * abs(speed[p])


@compiled(fastmath=True)
def _rests(
    ports: FloatArray,
    at_rest: tuple[FloatArray, FloatArray],
    x: FloatArray,
    sliders: tuple[FloatArray, FloatArray, FloatArray],
    now: FloatArray,
) -> bool:
    """Return whether no slider can slip again.

    With constant forces each mode decays about its rest, so the sum of its magnitudes
    bounds the motion of every port from now on.

    Args:
        ports: real and imaginary part of the motion of the ports, (2, n_ports, n).
        at_rest: modal coordinates per modal force, and modal forces, (2, n) each.
        x: modal coordinates, shape (2, n).
        sliders: slips and stretch, (n_ports, n_sliders), and scale of the slips.
        now: motion of the ports, shape (n_ports,).
    """
    gain, push = at_rest
    slips, stretch, scale = sliders
    for p in range(now.size):
        centre, reach = 0.0, 0.0
        for j in range(x.shape[1]):
            re = gain[0, j] * push[0, j] - gain[1, j] * push[1, j]
            im = gain[0, j] * push[1, j] + gain[1, j] * push[0, j]
            centre += ports[0, p, j] * re - ports[1, p, j] * im
            size = ports[0, p, j] ** 2 + ports[1, p, j] ** 2
            reach += np.sqrt(size * ((x[0, j] - re) ** 2 + (x[1, j] - im) ** 2))
        for i in range(slips.shape[1]):
            middle = stretch[p, i] + centre - now[p]
            if abs(middle) + reach > scale[p] * slips[p, i]:
                return False
    return True


@compiled(fastmath=True)
def _integrate(
    steps: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
    ports: tuple[FloatArray, FloatArray, FloatArray],
    instant: tuple[FloatArray, FloatArray],
    laws: _Laws,
    scale: FloatArray,
    hits: tuple[FloatArray, FloatArray],
    numbers: tuple[int, int, int],
    found: FloatArray,
) -> None:
    """Integrate all records; `found` receives the forces. Complex values in two rows.

    Args:
        steps: E, a0, a1 and the rest per modal force of each pole, (2, n_poles) each.
        ports: motion and velocity of the ports per mode, and modal forces of the
            ports, shape (2, n_ports, n_poles) each.
        instant: motion and velocity of the ports by their forces at a step's end.
        laws: kinds, sizes, gaps, slips and weights of the ports.
        scale: of the slips, shape (n_records, n_ports).
        hits: modal force of each record per N, shape (2, n_records, n_poles), and
            force [N], shape (n_records, n_samples).
        numbers: steps per sample, corrections per step, and steps between two
            questions whether the sliders rest (0: never).
        found: shape (n_records, n_ports, n_samples).
    """
    grow, a0, a1, gain = steps
    shown, speeds, push = ports
    parts, corrections, asked = numbers
    struck, force = hits
    n_poles, n_ports, n_sliders = grow.shape[1], found.shape[1], laws[3].shape[1]
    x, before = np.empty((2, n_poles)), np.empty((2, n_poles))
    first, last = np.empty((n_ports, n_sliders)), np.empty((n_ports, n_sliders))
    old, new, base = np.empty(n_ports), np.empty(n_ports), np.empty(n_ports)
    d, speed, speed_base = np.empty(n_ports), np.zeros(n_ports), np.zeros(n_ports)
    moving = np.any(laws[0] == 4)
    for record in range(force.shape[0]):
        x[:], before[:], first[:], old[:], d[:] = 0.0, 0.0, 0.0, 0.0, 0.0
        end = force.shape[1] - 1
        while end > 0 and force[record, end] == 0.0:
            end -= 1
        for t in range(force.shape[1] - 1):
            rise = (force[record, t + 1] - force[record, t]) / parts
            for part in range(parts):
                f0 = force[record, t] + part * rise
                f1 = f0 + rise
                for j in range(n_poles):
                    re, im = x[0, j], x[1, j]
                    u, v = before[0, j], before[1, j]
                    x[0, j] = grow[0, j] * re - grow[1, j] * im
                    x[1, j] = grow[0, j] * im + grow[1, j] * re
                    x[0, j] += a0[0, j] * u - a0[1, j] * v
                    x[1, j] += a0[0, j] * v + a0[1, j] * u
                if t <= end:
                    for j in range(n_poles):
                        u, v = struck[0, record, j], struck[1, record, j]
                        re = a0[0, j] * f0 + a1[0, j] * f1
                        im = a0[1, j] * f0 + a1[1, j] * f1
                        x[0, j] += u * re - v * im
                        x[1, j] += u * im + v * re
                _motion(shown, x, base)
                if moving:
                    _motion(speeds, x, speed_base)
                for _ in range(corrections):
                    for p in range(n_ports):
                        total, rate = base[p], speed_base[p]
                        for q in range(n_ports):
                            total += instant[0][p, q] * d[q]
                            rate += instant[1][p, q] * d[q]
                        new[p], speed[p] = total, rate
                    _port_forces(
                        laws, scale[record], (old, new, speed), (first, last), d
                    )
                first[:], old[:], before[:] = last, new, 0.0
                for p in range(n_ports):
                    for j in range(n_poles):
                        before[0, j] += push[0, p, j] * d[p]
                        before[1, j] += push[1, p, j] * d[p]
                for j in range(n_poles):
                    u, v = before[0, j], before[1, j]
                    x[0, j] += a1[0, j] * u - a1[1, j] * v
                    x[1, j] += a1[0, j] * v + a1[1, j] * u
                share = (part + 1) / parts
                for p in range(n_ports):
                    found[record, p, t + 1] += share * d[p] / parts
                    found[record, p, t] += (1.0 - share) * d[p] / parts
            if (
                asked > 0
                and t > end
                and t % asked == 0
                and _rests(
                    shown, (gain, before), x, (laws[3], first, scale[record]), old
                )
            ):
                for p in range(n_ports):
                    found[record, p, t + 1] += 0.5 * (1.0 - 1.0 / parts) * d[p]
                    found[record, p, t + 2 :] = d[p]
                break
