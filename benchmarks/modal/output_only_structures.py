# SPDX-License-Identifier: MIT
"""Long records of random structures under forces that are not recorded.

Chains of three to six masses with springs to the ground and between them, each mode
with its own damping, integrated by Runge and Kutta's fourth order at eight times the
sample rate (relative error of a pole below 1e-5 up to 400 Hz). White forces act on all
masses; all accelerations are recorded, with 3 % of white noise. A spindle adds steady
sines at multiples of its speed.
"""

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numba import njit
from scipy.signal import firwin, upfirdn

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.records.recordings import Channel, Quantity, Recording

RATE, FINE = 1024.0, 8
BAND = (20.0, 400.0)
_APART = 1.06
"""Least ratio of neighbouring natural frequencies."""
_SEEN = 0.01
"""Least share of a mode in the power of the record."""
_SWING_IN = 4.0
_NOISE = 0.03
ORDERS, SHARE = (1, 2, 3), 0.05
_HALF_FILTER = 64


@dataclass(frozen=True, slots=True, eq=False)
class OperatedStructure:
    """A structure and its modes.

    Attributes:
        mass: [kg], shape (n,).
        stiffness: [N/m], shape (n, n).
        damping: [N s/m], shape (n, n).
        frequency: natural frequencies [Hz], ascending, shape (n,).
        ratio: damping ratios [-], shape (n,).
    """

    mass: FloatArray
    stiffness: FloatArray
    damping: FloatArray
    frequency: FloatArray
    ratio: FloatArray


def random_structure(seed: int) -> OperatedStructure:
    """Return a chain whose modes lie in the band, apart, and are all seen."""
    rng = np.random.default_rng([seed, 11])
    while True:
        n = int(rng.integers(3, 7))
        mass = rng.uniform(0.5, 2.0, n)
        ground, joint = rng.uniform(0.2, 1.0, n), rng.uniform(0.5, 4.0, n - 1)
        matrix = np.diag(ground)
        for i, k in enumerate(joint):
            matrix[i : i + 2, i : i + 2] += k * np.array([[1.0, -1.0], [-1.0, 1.0]])
        values, shapes = scipy.linalg.eigh(matrix, np.diag(mass))
        top = rng.uniform(250.0, 380.0)
        omega = np.sqrt(values / values[-1]) * 2.0 * np.pi * top
        ratio = rng.uniform(0.005, 0.02, n)
        frequency = omega / (2.0 * np.pi)
        # Power of the acceleration of each mode under white forces on all masses.
        power = (shapes**2).sum(axis=0) ** 2 * omega / ratio
        apart = np.all(frequency[1:] > _APART * frequency[:-1])
        inside = frequency[0] > 1.2 * BAND[0]
        if apart and inside and np.all(power > _SEEN * power.sum()):
            scaled = matrix * (omega[-1] ** 2 / values[-1])
            modal = mass[:, None] * shapes
            damping = (modal * (2.0 * ratio * omega)) @ modal.T
            return OperatedStructure(mass, scaled, damping, frequency, ratio)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _integrated(
    state: FloatArray, matrix: FloatArray, force: FloatArray, step: float
) -> FloatArray:
    """Return accelerations, shape (n_steps, n); forces are linear between steps."""
    n = state.size // 2
    found = np.empty((force.shape[0] - 1, n))
    for i in range(force.shape[0] - 1):
        first, last = force[i], force[i + 1]
        middle = 0.5 * (first + last)
        one = matrix @ state
        one[n:] += first
        two = matrix @ (state + 0.5 * step * one)
        two[n:] += middle
        three = matrix @ (state + 0.5 * step * two)
        three[n:] += middle
        four = matrix @ (state + step * three)
        four[n:] += last
        found[i] = one[n:]
        state = state + step / 6.0 * (one + 2.0 * two + 2.0 * three + four)
    return found


def operated(
    structure: OperatedStructure, seconds: float, seed: int, *, harmonics: bool
) -> tuple[Recording, float]:
    """Return a record, and the speed of the spindle [Hz], 0 without one."""
    rng = np.random.default_rng([seed, 13])
    n, fine = structure.mass.size, RATE * FINE
    count = round((seconds + _SWING_IN) * fine) + 2 * _HALF_FILTER * FINE
    inverse = np.diag(1.0 / structure.mass)
    matrix = np.block(
        [
            [np.zeros((n, n)), np.eye(n)],
            [-inverse @ structure.stiffness, -inverse @ structure.damping],
        ]
    )
    force = rng.normal(size=(count + 1, n)) / structure.mass
    motion = _integrated(np.zeros(2 * n), matrix, force, 1.0 / fine)
    taps = firwin(2 * _HALF_FILTER * FINE + 1, 0.9 / FINE)
    start = round(_SWING_IN * fine) + _HALF_FILTER * FINE
    whole = upfirdn(taps, motion, down=1, axis=0)[_HALF_FILTER * FINE + start :: FINE]
    samples = whole[: round(seconds * RATE)].T.copy()
    level = samples.std(axis=1, keepdims=True)
    samples += _NOISE * level * rng.normal(size=samples.shape)
    speed = 0.0
    if harmonics:
        speed = float(rng.uniform(30.0, 100.0))
        turn = 2.0 * np.pi * speed * np.arange(samples.shape[1]) / RATE
        for order in ORDERS:
            phase = rng.uniform(0.0, 2.0 * np.pi, (n, 1))
            samples += SHARE * np.sqrt(2.0) * level * np.sin(order * turn + phase)
    channels = tuple(
        Channel(f"a{i}", Quantity.ACCELERATION, point=str(i)) for i in range(1, n + 1)
    )
    return Recording("run", samples, RATE, channels), speed
