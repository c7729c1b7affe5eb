"""Force laws of a joint, and their time integration by Newmark's method.

Source:
    Newmark 1959, J. Eng. Mech. Div. ASCE 85, 67 (beta = 1/4, gamma = 1/2).
"""

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
from numba import njit

Floats = npt.NDArray[np.float64]

OUTSIDE = {
    "slot": "contact",
    "dead_zone_damping": "damping",
    "stiffness_in_time": "",
    "quintic_stiffness": "stiffness",
    "root_stiffness": "stiffness",
}
"""Effects that the catalogue lacks, with the family that is true of each: a slot is a
two-sided stop, and a stiffness that drifts within a record is of no family of laws."""


@dataclass(frozen=True)
class Law:
    """The force of the joint beyond its linear spring and damper.

    Attributes:
        numbers: cubic [N/m^3], quadratic [N/m^2], stop stiffness [N/m] and gap [m],
            dry friction [N] and its speed [m/s], quadratic damping [N s^2/m^2], slot
            stiffness [N/m] and half gap [m], dead-zone damping [N s/m] and zone [m],
            quintic [N/m^5], root [N/m] and the motion of its bend [m].
        sliders: stiffness [N/m] and slip force [N] of each, shape (2, n).
        hysteresis: k [N/m], n, b, g, zy [m] of a Bouc-Wen element.
        drift: relative change of the joint's stiffness over the record [-].
    """

    numbers: Floats = field(default_factory=lambda: np.zeros(14))
    sliders: Floats = field(default_factory=lambda: np.zeros((2, 0)))
    hysteresis: Floats = field(default_factory=lambda: np.zeros(5))
    drift: float = 0.0

    def __add__(self, other: "Law") -> "Law":
        """Return both laws together; only one may have a slot of its own."""
        numbers = np.where(self.numbers != 0.0, self.numbers, other.numbers)
        sliders = np.concatenate([self.sliders, other.sliders], axis=1)
        own = self.hysteresis if self.hysteresis[0] else other.hysteresis
        return Law(numbers, sliders, own, self.drift + other.drift)

    @property
    def stuck(self) -> float:
        """Stiffness of all sliders before slip [N/m]."""
        return float(self.sliders[0].sum() + self.hysteresis[0])


@njit(cache=False)
def _law_force(u, v, dt, numbers, sliders, place, moved, hysteresis, z):  # type: ignore[no-untyped-def]
    """Return the force of the joint law and the new state of its Bouc-Wen element."""
    total = numbers[0] * u**3 + numbers[1] * u * u
    total += numbers[2] * max(u - numbers[3], 0.0)
    total += numbers[4] * np.tanh(v / numbers[5]) if numbers[4] != 0.0 else 0.0
    total += numbers[6] * v * abs(v)
    if numbers[7] != 0.0:
        total += numbers[7] * (max(u - numbers[8], 0.0) + min(u + numbers[8], 0.0))
    if numbers[9] != 0.0:
        square = (u / numbers[10]) ** 2
        total += numbers[9] * v * square**4 / (1.0 + square**4)
    total += numbers[11] * u**5
    if numbers[12] != 0.0:
        total += numbers[12] * u / (1.0 + (u / numbers[13]) ** 2) ** 0.25
    for i in range(sliders.shape[1]):
        reach = sliders[1, i] / sliders[0, i]
        moved[i] = min(max(place[i], u - reach), u + reach)
        total += sliders[0, i] * (u - moved[i])
    new = z
    if hysteresis[0] != 0.0:
        for _ in range(3):
            middle = 0.5 * (z + new)
            turn = hysteresis[2] * np.sign(v * middle) + hysteresis[3]
            share = abs(middle / hysteresis[4]) ** hysteresis[1]
            new = z + dt * v * (1.0 - share * turn)
        total += hysteresis[0] * new
    return total, new


@njit(cache=False)
def newmark(mass, damping, stiffness, direction, drift, force, at, dt, law):  # type: ignore[no-untyped-def]
    """Return accelerations at every step, shape (n_bodies, n_steps)."""
    numbers, sliders, hysteresis = law
    n, steps = mass.size, force.size
    effective = stiffness + 2.0 / dt * damping + np.diag(4.0 / dt**2 * mass)
    inverse = np.linalg.inv(effective)
    across = inverse @ direction
    x, v, a = np.zeros(n), np.zeros(n), np.zeros(n)
    out = np.zeros((n, steps))
    place, moved = np.zeros(sliders.shape[1]), np.zeros(sliders.shape[1])
    z, joint = 0.0, 0.0
    for k in range(1, steps):
        right = mass * (4.0 / dt**2 * x + 4.0 / dt * v + a)
        right += damping @ (2.0 / dt * x + v)
        right[at] += force[k]
        free = inverse @ right
        new = z
        for _ in range(30):
            trial = free - across * joint
            speed = 2.0 / dt * (trial - x) - v
            u, w = direction @ trial, direction @ speed
            before = joint
            joint, new = _law_force(
                u, w, dt, numbers, sliders, place, moved, hysteresis, z
            )
            joint += drift * k / steps * u
            if abs(joint - before) < 1e-10 * (1.0 + abs(joint)):
                break
        trial = free - across * joint
        speed = 2.0 / dt * (trial - x) - v
        a = 4.0 / dt**2 * (trial - x) - 4.0 / dt * v - a
        x, v, z = trial, speed, new
        place[:] = moved
        out[:, k] = a
    return out


def law_of(
    name: str,
    size: float,
    motion: tuple[float, float],
    kj: float,
    rng: np.random.Generator,
) -> Law:
    """Return a law whose largest force is about `size` times that of the spring."""
    u, v = motion
    if size <= 0.0:
        return Law()
    numbers, force = np.zeros(14), size * kj * u
    numbers[5] = 1e-3 * v
    if name == "cubic_stiffness":
        numbers[0] = force / u**3 * (1.0 if rng.random() < 0.6 else -0.4)
    elif name == "quadratic_stiffness":
        numbers[1] = force / u**2 * rng.choice([-0.6, 0.6])
    elif name == "gap":
        gap = u * rng.uniform(0.08, 0.5)
        numbers[2:4] = force / (u - gap), gap
    elif name == "coulomb":
        numbers[4] = 0.04 * force
    elif name == "quadratic_damping":
        numbers[6] = force / v**2
    elif name == "slot":
        gap = u * rng.uniform(0.08, 0.5)
        numbers[7:9] = force / (u - gap), gap
    elif name == "dead_zone_damping":
        numbers[9:11] = force / v, u * rng.uniform(0.1, 0.4)
    elif name == "quintic_stiffness":
        numbers[11] = force / u**5
    elif name == "root_stiffness":
        bend = u * rng.uniform(0.05, 0.2)
        numbers[12:14] = force / u * (1.0 + (u / bend) ** 2) ** 0.25, bend
    elif name == "stiffness_in_time":
        return Law(drift=size * kj * rng.choice([-1.0, 1.0]))
    elif name == "bouc_wen":
        b = rng.uniform(0.4, 0.8)
        n, g = rng.choice([1.0, 1.5, 2.0]), (1.0 - b)
        slip = u * rng.uniform(0.1, 0.6)
        own = min(force / slip, 0.6 * kj)
        return Law(hysteresis=np.array([own, n, b, g, slip]))
    else:
        return Law(sliders=_sliders(name, force, u, kj, rng))
    return Law(numbers)


def _sliders(
    name: str, force: float, u: float, kj: float, rng: np.random.Generator
) -> Floats:
    """Return the sliders of a Jenkins or an Iwan element."""
    if name == "jenkins":
        slip = u * rng.uniform(0.06, 0.5)
        stiffness = min(force / slip, 0.6 * kj)
        return np.array([[stiffness], [stiffness * slip]])
    count, chi = 60, rng.uniform(-0.7, 0.0)
    top = u * rng.uniform(0.3, 2.0)
    edges = np.linspace(0.0, 1.0, count + 1)
    share = np.diff(edges ** (chi + 2.0))
    slips = top * 0.5 * (edges[1:] + edges[:-1])
    each = share * min(2.0 * force / top, 0.6 * kj)
    return np.stack([each, each * slips])
