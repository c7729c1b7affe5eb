# SPDX-License-Identifier: MIT
"""Forces on the machine: chips that break, an unbalance, the floor; or a shaker.

None of them is white or Gaussian noise at the samples of a recording.
"""

from collections.abc import Iterator

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray

_BED, _HEADSTOCK, _SPINDLE = 0, 2, 3
_CHIPS = 900.0  # a second
_CHIP = 0.35e-3  # [s] half-sine of a chip that breaks
_STEPS = 60.0  # a second: blows of the floor
_STEP = 1.1e-3  # [s]


def spindle_forces(
    count: int, rate: float, *, seed: int, rpm: float
) -> Iterator[FloatArray]:
    """Yield the forces of an operating run, shape (4, count), piece by piece.

    Chips break at random times with random force, the spindle has an unbalance at a
    speed that drifts by 0.05 %, and the floor shakes the bed.

    Args:
        count: steps of a piece.
        rate: of the steps [Hz].
        seed: of the random times.
        rpm: speed of the spindle [1/min].
    """
    rng = np.random.default_rng([seed, 71])
    chips = _Blows(_CHIPS, 120.0, _CHIP, rate)
    floor = _Blows(_STEPS, 600.0, _STEP, rate)
    first = 0
    while True:
        forces = np.zeros((4, count))
        forces[_SPINDLE] = chips.piece(count, rng)
        forces[_BED] = floor.piece(count, rng)
        time = (first + np.arange(count)) / rate
        turns = rpm / 60 * (time + 5e-4 * 8.0 / (2 * np.pi) * np.sin(time / 8.0))
        forces[_SPINDLE] += 9.0 * np.sin(2 * np.pi * turns)
        yield forces
        first += count


def shaker_forces(
    count: int, rate: float, *, seed: int, signal: str
) -> Iterator[FloatArray]:
    """Yield the forces of a shaker at the headstock, shape (4, count).

    Args:
        count: steps of a piece.
        rate: of the steps [Hz].
        seed: of the random signal.
        signal: ``"random"``, steps of a random telegraph through the inductance of the
            shaker; or ``"sweep"``, a sine from 15 Hz to 500 Hz in 20 s and back.
    """
    rng = np.random.default_rng([seed, 72])
    first, last = 0, 0.0
    pole = np.exp(-2 * np.pi * 700.0 / rate)
    while True:
        forces = np.zeros((4, count))
        if signal == "sweep":
            time = (first + np.arange(count)) / rate
            forces[_HEADSTOCK] = 40.0 * np.sin(_sweep_phase(time))
        else:
            held = max(1, round(rate / 2600.0))
            drawn = rng.choice((-1.0, 1.0), size=-(-count // held))
            raw = 60.0 * np.repeat(drawn, held)[:count]
            forces[_HEADSTOCK], last = _lagged(raw, float(pole), last)
        yield forces
        first += count


class _Blows:
    """Half-sine blows at random times, whose tails reach into the next piece."""

    def __init__(self, often: float, force: float, width: float, rate: float) -> None:
        steps = max(2, round(width * rate))
        self._shape = np.sin(np.pi * (np.arange(steps) + 0.5) / steps)
        self._chance, self._force = often / rate, force
        self._tail = np.zeros(steps - 1)

    def piece(self, count: int, rng: np.random.Generator) -> FloatArray:
        """Return the next steps [N]."""
        hits = (rng.random(count) < self._chance) * rng.exponential(
            self._force, size=count
        )
        whole = np.convolve(hits, self._shape)
        whole[: self._tail.size] += self._tail
        self._tail = whole[count:]
        return np.asarray(whole[:count])


def _lagged(raw: FloatArray, pole: float, last: float) -> tuple[FloatArray, float]:
    """Return a signal after a first-order lag, and its last value."""
    from scipy.signal import lfilter

    out, state = lfilter([1 - pole], [1, -pole], raw, zi=[pole * last])
    return np.asarray(out), float(state[0]) / pole


def _sweep_phase(time: FloatArray) -> FloatArray:
    """Return the phase of a sine whose frequency rises and falls exponentially."""
    low, high, span = 15.0, 500.0, 20.0
    growth = np.log(high / low) / span
    up = 2 * np.pi * low / growth * np.expm1(growth * span)
    cycle, inside = np.divmod(time, 2 * span)
    rising = 2 * np.pi * low / growth * np.expm1(growth * np.minimum(inside, span))
    falling = np.where(
        inside > span,
        2 * np.pi * high / growth * -np.expm1(-growth * (inside - span)),
        0.0,
    )
    return np.asarray(cycle * 2 * up + rising + falling)
