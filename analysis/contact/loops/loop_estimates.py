# SPDX-License-Identifier: MIT
"""Tangential stiffness and energy of closed cycles, with their uncertainty."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.errors import BadData
from jointbench.acquisition.basics.tail_probabilities import chi2_limit
from jointbench.analysis.contact.loops.joint_loop import (
    JointLoop,
    LoopCycle,
    loop_cycles,
)

_WINDOWS = (0.5, 0.35, 0.25, 0.18, 0.12, 0.08)
"""Shares of a branch over which its start is fitted, the widest that fits is taken."""
_DEGREE = 3
"""Of the polynomial at the start of a branch."""
_LEAST_FITTED = 8
"""Samples below which no polynomial is fitted."""
_FIT_CHANCE = 0.01
"""Chance of the residual below which a window is too wide."""
_SAME_LEVEL = 0.07
"""Amplitudes within this share of each other are one level."""
_SHOWN = 3.0
"""Energy over its sd above which a loss is determined."""


@dataclass(frozen=True, slots=True)
class LoopLevel:
    """Cycles of one amplitude.

    Attributes:
        cycles: number.
        force: amplitude, half of the range [N].
        displacement: amplitude [m].
        energy: dissipated in a cycle, mean [J].
        energy_sd: relative sd of this mean [-].
    """

    cycles: int
    force: float
    displacement: float
    energy: float
    energy_sd: float

    @property
    def loss_factor(self) -> float:
        """Energy over 2 pi times the energy stored at the amplitude [-]."""
        return self.energy / (np.pi * self.force * self.displacement)

    @property
    def secant(self) -> float:
        """Force over displacement at the amplitude [N/m]."""
        return self.force / self.displacement

    @property
    def dissipates(self) -> bool:
        """Whether the energy is determined."""
        return self.energy > 0 and self.energy_sd * _SHOWN < 1.0

    def damping(self, frequency: float) -> float:
        """Return the viscous damping of the same energy in a cycle [N s/m].

        Args:
            frequency: of the cycles [Hz].
        """
        return self.loss_factor * self.secant / (2.0 * np.pi * frequency)


@dataclass(frozen=True, slots=True)
class LoopEstimates:
    """What a record of closed cycles says of a joint.

    Attributes:
        levels: by rising amplitude.
        stiffness: tangential, right after a reversal [N/m].
        stiffness_sd: relative sd, enlarged where the levels disagree [-].
    """

    levels: tuple[LoopLevel, ...]
    stiffness: float
    stiffness_sd: float


@dataclass(frozen=True, slots=True)
class _Numbers:
    """Numbers of one cycle, each with its variance by the noise of both channels.

    The tangent is a compliance where the displacement is the noisier channel.
    """

    force: float
    displacement: float
    energy: tuple[float, float]
    tangent: tuple[float, float]


def estimate_loop(loop: JointLoop) -> LoopEstimates:
    """Return stiffness after reversals, and energy in a cycle by amplitude.

    The stiffness is that of the contacts before they slip, whatever the amplitude: the
    slope of each branch at its start. Every variance is the larger one of that by the
    noise of both channels and that by the scatter of the cycles.

    Args:
        loop: record with at least one closed cycle.

    Raises:
        BadData: no cycle is closed or has the samples that a tangent takes, or noise
            hides the tangent.

    Source:
        Masing 1926, Proc. 2nd Int. Congr. Appl. Mech.; Mindlin and Deresiewicz 1953, J.
        Appl. Mech. 20, 327.
    """
    cycles = loop_cycles(loop)
    by_force = _by_force(loop)
    numbers = [_numbers(loop, cycle, by_force) for cycle in cycles]
    groups = _grouped(numbers)
    tangents = np.array([_mean([n.tangent for n in own]) for own in groups])
    weight = 1.0 / tangents[:, 1]
    mean = float(weight @ tangents[:, 0] / weight.sum())
    excess = float(weight @ (tangents[:, 0] - mean) ** 2) / max(len(groups) - 1, 1)
    sd = float(np.sqrt(max(excess, 1.0) / weight.sum()))
    if not mean > _SHOWN * sd:
        raise BadData(
            "noise hides how force and displacement rise together after a reversal; "
            "measure larger amplitudes or more cycles, and the displacement between "
            "both surfaces"
        )
    stiffness = 1.0 / mean if by_force else mean
    return LoopEstimates(tuple(map(_level, groups)), stiffness, sd / mean)


def _by_force(loop: JointLoop) -> bool:
    """Return whether force has less noise over its range than displacement."""
    noise_u, noise_f = loop.noise
    return bool(noise_f * np.ptp(loop.displacement) < noise_u * np.ptp(loop.force))


def _grouped(numbers: Sequence[_Numbers]) -> list[list[_Numbers]]:
    """Return the cycles by amplitude, the smallest first."""
    found: list[list[_Numbers]] = []
    for one in sorted(numbers, key=lambda n: n.force):
        if found and one.force <= (1.0 + _SAME_LEVEL) * found[-1][0].force:
            found[-1].append(one)
        else:
            found.append([one])
    return found


def _level(own: Sequence[_Numbers]) -> LoopLevel:
    """Return the mean of the cycles of one amplitude."""
    energy, variance = _mean([n.energy for n in own])
    return LoopLevel(
        len(own),
        float(np.mean([n.force for n in own])),
        float(np.mean([n.displacement for n in own])),
        energy,
        float(np.sqrt(variance)) / max(abs(energy), 1e-300),
    )


def _mean(values: Sequence[tuple[float, float]]) -> tuple[float, float]:
    """Return the mean of values with variances, and its variance."""
    known = np.array([value for value, _ in values])
    variance = float(np.mean([one for _, one in values]))
    if known.size > 1:
        variance = max(variance, float(known.var(ddof=1)))
    return float(known.mean()), variance / known.size


def _numbers(loop: JointLoop, cycle: LoopCycle, by_force: bool) -> _Numbers:
    """Return amplitudes, energy and tangent of one cycle."""
    u = loop.displacement[cycle.start : cycle.end + 1]
    f = loop.force[cycle.start : cycle.end + 1]
    noise_u, noise_f = loop.noise
    across_u, across_f = _across(u), _across(f)
    area = float(f @ across_u)
    variance = noise_f**2 * (across_u @ across_u) + noise_u**2 * (across_f @ across_f)
    corner = cycle.turn - cycle.start
    starts = [
        _start(loop, cycle.start, cycle.turn, by_force),
        _start(loop, cycle.turn, cycle.end, by_force),
    ]
    return _Numbers(
        force=0.5 * abs(float(f[corner] - 0.5 * (f[0] + f[-1]))),
        displacement=0.5 * abs(float(u[corner] - 0.5 * (u[0] + u[-1]))),
        energy=(area, float(variance)),
        tangent=(
            0.5 * (starts[0][0] + starts[1][0]),
            0.25 * (starts[0][1] + starts[1][1]),
        ),
    )


def _across(values: FloatArray) -> FloatArray:
    """Return half of the step from the sample before to that after, closed, (n,)."""
    return np.asarray(0.5 * (np.roll(values, -1) - np.roll(values, 1)))


def _start(
    loop: JointLoop, first: int, last: int, by_force: bool
) -> tuple[float, float]:
    """Return the slope of a branch at its start, and its variance.

    The noisier channel is a polynomial of the other one over the first part of the
    branch, so that noise does not flatten it.
    """
    u, f = loop.displacement[first : last + 1], loop.force[first : last + 1]
    noise_u, noise_f = loop.noise
    sign = float(np.sign(f[-1] - f[0]))
    if by_force:
        return _tangent(sign * (f - f[0]), sign * (u - u[0]), noise_f, noise_u)
    return _tangent(sign * (u - u[0]), sign * (f - f[0]), noise_u, noise_f)


def _tangent(
    x: FloatArray, y: FloatArray, noise_x: float, noise_y: float
) -> tuple[float, float]:
    """Return dy/dx at x = 0, and its variance."""
    fitted: tuple[float, float] | None = None
    for share in _WINDOWS:
        own = np.flatnonzero(x <= share * x.max())
        own = own[own > 0]
        if own.size < _LEAST_FITTED:
            break
        scale = float(x[own].max())
        basis = np.vander(x[own] / scale, _DEGREE + 1, increasing=True)
        found = np.linalg.lstsq(basis, y[own], rcond=None)[0]
        slope = float(found[1] / scale)
        sd = max(float(np.hypot(noise_y, slope * noise_x)), 1e-12 * float(y.max()))
        left = y[own] - basis @ found
        spread = np.linalg.inv(basis.T @ basis)[1, 1] / scale**2
        fitted = slope, float(sd**2 * spread)
        freedom = own.size - _DEGREE - 1
        if float(left @ left) / sd**2 <= chi2_limit(_FIT_CHANCE, freedom):
            break
    if fitted is None:
        raise BadData(
            "a branch has too few samples after its reversal for a tangent; sample "
            "each cycle at a hundred points or more"
        )
    return fitted
