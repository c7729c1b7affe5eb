# SPDX-License-Identifier: MIT
"""Masses on springs with one nonlinear joint, struck by a hammer: the second method.

Time integration by central differences on a fine step, with sliders that keep their
own state; the estimator knows neither the integrator nor the laws. Truth comes from
harmonic balance: the joint's force under a harmonic motion gives an equivalent complex
stiffness, and the eigenvalue problem with it gives frequency and damping.
"""

from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt
import scipy.linalg
from numba import njit

Floats = npt.NDArray[np.float64]

FINE_RATE = 81920.0
DECIMATION = 8
SAMPLE_RATE = FINE_RATE / DECIMATION
_PERIOD = 2048


@dataclass(frozen=True)
class Joint:
    """The force of a joint on its relative displacement u and velocity v.

    Attributes:
        slider_stiffness: of each Jenkins element [N/m].
        slider_force: at which each slips [N].
        cubic: coefficient of u^3 [N/m^3].
        quadratic_damping: coefficient of v|v| [N s^2/m^2].
        clearance: half gap [m], and
        stop_stiffness: beyond it [N/m].
    """

    slider_stiffness: Floats = field(default_factory=lambda: np.zeros(0))
    slider_force: Floats = field(default_factory=lambda: np.zeros(0))
    cubic: float = 0.0
    quadratic_damping: float = 0.0
    clearance: float = 1.0
    stop_stiffness: float = 0.0


@dataclass(frozen=True)
class Structure:
    """Masses, springs and dampers in matrices, and the joint along `direction`."""

    mass: Floats
    stiffness: Floats
    damping: Floats
    direction: Floats
    joint: Joint

    def modes(self, spring: float = 0.0) -> tuple[Floats, Floats]:
        """Return omega [rad/s] and shapes of the undamped structure."""
        extra = (spring + self.joint.slider_stiffness.sum()) * np.outer(
            self.direction, self.direction
        )
        squared, shapes = scipy.linalg.eigh(self.stiffness + extra, np.diag(self.mass))
        return np.sqrt(squared), shapes


def chain(
    rng: np.random.Generator,
    bodies: int,
    *,
    damping: tuple[float, float] = (0.003, 0.008),
    lowest: float = 80.0,
) -> Structure:
    """Return a random chain of masses held at one end, with modal damping.

    Args:
        rng: source of the draw.
        bodies: number of masses.
        damping: least and largest damping ratio of the modes [-].
        lowest: natural frequency of the first mode [Hz].
    """
    mass = rng.uniform(0.7, 1.4, bodies)
    spring = rng.uniform(0.7, 1.4, bodies + 1)
    spring[-1] *= rng.uniform(0.0, 0.5)
    stiffness = np.diag(spring[:-1] + spring[1:])
    stiffness -= np.diag(spring[1:-1], 1) + np.diag(spring[1:-1], -1)
    squared, shapes = scipy.linalg.eigh(stiffness, np.diag(mass))
    scale = (2 * np.pi * lowest) ** 2 / squared[0]
    stiffness, omega = stiffness * scale, np.sqrt(squared * scale)
    ratio = rng.uniform(*damping, bodies)
    base = np.diag(mass) @ shapes
    matrix = base @ np.diag(2 * ratio * omega) @ base.T
    direction = np.zeros(bodies)
    place = int(rng.integers(bodies))
    direction[place] = 1.0
    if place:
        direction[place - 1] = -1.0
    return Structure(mass, stiffness, matrix, direction, Joint())


def micro_slip(
    stiffness: float, largest: float, exponent: float, sliders: int = 80
) -> Joint:
    """Return an Iwan joint whose stiffness loss goes with amplitude^`exponent`.

    Args:
        stiffness: that has slipped at `largest` [N/m].
        largest: relative displacement [m].
        exponent: of the loss [-].
        sliders: from a thousandth of `largest` to four times it.
    """
    slip = largest * np.geomspace(1e-3, 4.0, sliders)
    share = slip**exponent
    share *= stiffness / share[slip <= largest].sum()
    return Joint(slider_stiffness=share, slider_force=share * slip)


@njit(cache=False)
def _joint_force(u, v, spring, force, state, cubic, quadratic, gap, stop):  # type: ignore[no-untyped-def]
    total = cubic * u**3 + quadratic * v * abs(v)
    if u > gap:
        total += stop * (u - gap)
    elif u < -gap:
        total += stop * (u + gap)
    for j in range(spring.size):
        spring_force = spring[j] * (u - state[j])
        if spring_force > force[j]:
            spring_force = force[j]
            state[j] = u - spring_force / spring[j]
        elif spring_force < -force[j]:
            spring_force = -force[j]
            state[j] = u - spring_force / spring[j]
        total += spring_force
    return total


@njit(cache=False)
def _along(row, values):  # type: ignore[no-untyped-def]
    """Return a product of vectors: `np.dot` takes seconds to compile."""
    total = 0.0
    for k in range(row.size):
        total += row[k] * values[k]
    return total


@njit(cache=False)
def _integrate(  # type: ignore[no-untyped-def]
    mass,
    stiffness,
    damping,
    inverse,
    direction,
    spring,
    limit,
    numbers,
    push,
    where,
    start,
    step,
    every,
    aside,
):
    cubic, quadratic, gap, stop = numbers
    n = mass.size
    old, now, new = start.copy(), start.copy(), np.zeros(n)
    right = np.zeros(n)
    state = np.zeros(spring.size)
    samples = np.zeros((n, push.size // every))
    u_old, v_old = _along(direction, old), 0.0
    for i in range(push.size):
        u = _along(direction, now)
        v = (u - u_old) / step
        speed = 1.5 * v - 0.5 * v_old
        f = _joint_force(u, speed, spring, limit, state, cubic, quadratic, gap, stop)
        v_old, u_old = v, u
        for k in range(n):
            right[k] = (
                mass[k] * (2 * now[k] - old[k]) / step**2
                + _along(damping[k], old) / (2 * step)
                - _along(stiffness[k], now)
                - f * direction[k]
            )
        right[where] += (1.0 - aside) * push[i]
        right[(where + 1) % n] += aside * push[i]
        for k in range(n):
            new[k] = _along(inverse[k], right)
            if i % every == 0:
                samples[k, i // every] = (new[k] - 2 * now[k] + old[k]) / step**2
        old, now, new = now, new, old
    return samples


def _numbers(joint: Joint) -> tuple[float, float, float, float]:
    return joint.cubic, joint.quadratic_damping, joint.clearance, joint.stop_stiffness


def strike(
    structure: Structure,
    impulse: float,
    *,
    where: int,
    width: float = 1.2e-3,
    duration: float = 2.0,
    lead: float = 0.01,
    aside: float = 0.0,
) -> tuple[Floats, Floats]:
    """Return force and accelerations of all masses after one hammer hit.

    Args:
        structure: at rest before.
        impulse: of the half-sine pulse [N s].
        where: mass that is struck.
        width: of the pulse [s].
        duration: of the record [s].
        lead: quiet time before the pulse [s].
        aside: share of the force that goes to the next mass [-].
    """
    time = np.arange(int(duration * FINE_RATE)) / FINE_RATE - lead
    inside = (time >= 0) & (time < width)
    push = np.where(inside, np.sin(np.pi * time / width) ** 2, 0.0)
    push *= impulse * FINE_RATE / push.sum()
    # Inverted here: numba takes longer to compile an inverse than to integrate.
    step = 1.0 / FINE_RATE
    left = np.diag(structure.mass) / step**2 + structure.damping / (2 * step)
    samples = _integrate(
        structure.mass,
        structure.stiffness,
        structure.damping,
        np.linalg.inv(left),
        structure.direction,
        structure.joint.slider_stiffness,
        structure.joint.slider_force,
        _numbers(structure.joint),
        push,
        where,
        np.zeros(structure.mass.size),
        step,
        DECIMATION,
        aside,
    )
    return push[::DECIMATION], samples


def equivalent(joint: Joint, amplitude: float, omega: float) -> complex:
    """Return force over displacement of a joint under a harmonic motion [N/m]."""
    angle = 2 * np.pi * np.arange(3 * _PERIOD) / _PERIOD
    force = _cycle(
        amplitude * np.cos(angle),
        -amplitude * omega * np.sin(angle),
        joint.slider_stiffness,
        joint.slider_force,
        _numbers(joint),
    )[-_PERIOD:]
    harmonic = 2.0 / _PERIOD * np.sum(force * np.exp(-1j * angle[-_PERIOD:]))
    return complex(harmonic / amplitude)


@njit(cache=False)
def _cycle(u, v, spring, limit, numbers):  # type: ignore[no-untyped-def]
    cubic, quadratic, gap, stop = numbers
    state = np.zeros(spring.size)
    force = np.zeros(u.size)
    for i in range(u.size):
        force[i] = _joint_force(
            u[i], v[i], spring, limit, state, cubic, quadratic, gap, stop
        )
    return force


@dataclass(frozen=True)
class TrueCurve:
    """Amplitude of the acceleration at each mass, frequency and damping of a mode."""

    amplitude: Floats
    frequency: Floats
    damping_ratio: Floats

    def at(self, mass: int, amplitude: Floats) -> tuple[Floats, Floats]:
        """Return frequency [Hz] and damping ratio where `mass` has that amplitude."""
        # A joint that softens much has a largest acceleration; curves end there.
        up = int(np.argmax(self.amplitude[:, mass])) + 1
        known = np.log(self.amplitude[:up, mass])
        wanted = np.log(amplitude)
        return (
            np.interp(wanted, known, self.frequency[:up]),
            np.interp(wanted, known, self.damping_ratio[:up]),
        )


def true_curve(structure: Structure, mode: int, displacements: Floats) -> TrueCurve:
    """Return frequency and damping of a mode by harmonic balance.

    Args:
        structure: with its joint.
        mode: index, by ascending frequency.
        displacements: amplitudes of the joint [m], ascending.
    """
    omegas, shapes = structure.modes()
    omega = omegas[mode]
    pole, shape = complex(-0.005 * omega, omega), shapes[:, mode].astype(complex)
    rows = []
    for size in displacements:
        for _ in range(4):
            stiff = equivalent(structure.joint, float(size), pole.imag)
            pole, shape = _nearest(structure, stiff, pole, shape)
        at_joint = abs(structure.direction @ shape)
        # Central differences shorten periods by omega^2 h^2 / 24.
        slow = 1.0 + (abs(pole) / FINE_RATE) ** 2 / 24.0
        amplitude = abs(pole) ** 2 * size * np.abs(shape) / at_joint
        rows.append((amplitude, abs(pole) * slow / 2 / np.pi, -pole.real / abs(pole)))
    return TrueCurve(
        np.array([r[0] for r in rows]),
        np.array([r[1] for r in rows]),
        np.array([r[2] for r in rows]),
    )


def _nearest(
    structure: Structure,
    stiff: complex,
    pole: complex,
    shape: npt.NDArray[np.complex128],
) -> tuple[complex, npt.NDArray[np.complex128]]:
    """Return the eigenvalue and vector closest to a pole and a shape."""
    n = structure.mass.size
    along = np.outer(structure.direction, structure.direction)
    stiffness = structure.stiffness + stiff.real * along
    damping = structure.damping + stiff.imag / pole.imag * along
    upper = np.hstack((np.zeros((n, n)), np.eye(n)))
    weight = structure.mass[:, None]
    lower = np.hstack((-stiffness / weight, -damping / weight))
    values, vectors = np.linalg.eig(np.vstack((upper, lower)))
    up = values.imag > 0
    values, vectors = values[up], vectors[:n, up]
    alike = np.abs(shape.conj() @ (structure.mass[:, None] * vectors)) / np.linalg.norm(
        vectors, axis=0
    )
    near = np.abs(values - pole) / abs(pole)
    best = int(np.argmax(alike / alike.max() - near))
    return complex(values[best]), vectors[:, best]


def with_joint(structure: Structure, joint: Joint, base: float) -> Structure:
    """Return a structure with a joint; sliders take their stuck stiffness from `base`.

    Args:
        structure: whose modes are those of the stuck joint.
        joint: to put in.
        base: stiffness that the sliders replace [N/m].
    """
    along = np.outer(structure.direction, structure.direction)
    return replace(structure, stiffness=structure.stiffness - base * along, joint=joint)
