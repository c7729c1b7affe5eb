# SPDX-License-Identifier: MIT
"""A mode at the end of the band of a measured body or just above, from the FRFs below.

Powers of s describe modes far above the band. One that lies a few per cent above it has
a pole there: a series converges slowly or not at all. One on the last lines of the band
is missed by a fit of poles.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.basics.tail_probabilities import chi2_limit
from jointbench.analysis.structures.measured.frf_coupling import FrfBlock

# Candidates around the end of the band: from its last lines to where a series will do.
_NEAREST, _FARTHEST, _CANDIDATES = 0.985, 1.5, 32
# Beyond this share a series describes the mode as well, and its place is open.
_LAST = 1.25
# Share by which a candidate is above all modes that are known.
_CLEAR = 1.003
# A mode is there if noise lowers chi2 as much in less than one of a million fits.
_CHANCE = 1e-6
# Standard deviation of the logarithm of its damping ratio before the fit.
_RATIO_SPREAD = 1.0
# Lines that are used of each FRF.
_MOST_LINES = 400
# First and largest steps of ln frequency and ln damping ratio in differences of chi2,
# and the curvature in steps that counts as none.
_FIRST_STEPS, _LAST_STEP, _FLAT = (1e-7, 1e-3), 0.3, 1e-3


@dataclass(frozen=True, slots=True)
class ModeAbove:
    """A mode at the end of a band or above.

    Attributes:
        frequency: [Hz].
        frequency_sd: [Hz].
        damping_ratio: [-].
        damping_sd: [-].
    """

    frequency: float
    frequency_sd: float
    damping_ratio: float
    damping_sd: float


@dataclass(frozen=True, slots=True, eq=False)
class _DirectFrfs:
    """Direct FRFs of all points, and what the known terms leave of them.

    Attributes:
        laplace: lines [1/s], shape (n_lines,).
        weight: of each FRF, shape (n_points, n_lines).
        space: orthonormal known columns, shape (n_points, 2 n_lines, n_columns).
        left: FRFs outside of these, shape (n_points, 2 n_lines).
    """

    laplace: ComplexArray
    weight: FloatArray
    space: FloatArray
    left: FloatArray

    def gain(self, frequency: float, ratio: float) -> float:
        """Return how much a mode lowers chi2, with a residue for each FRF."""
        omega = 2.0 * np.pi * frequency
        s = self.laplace
        pole = self.weight / (s**2 + 2.0 * ratio * omega * s + omega**2)
        column = np.concatenate([pole.real, pole.imag], axis=1)
        column /= np.linalg.norm(column, axis=1, keepdims=True)
        along = np.einsum("prc,pr->pc", self.space, column)
        column -= np.einsum("prc,pc->pr", self.space, along)
        size = np.einsum("pr,pr->p", column, column)
        return float((np.einsum("pr,pr->p", column, self.left) ** 2 / size).sum())


def mode_above(
    block: FrfBlock,
    band: tuple[float, float],
    columns: Sequence[Callable[[ComplexArray], ComplexArray]],
    ratio: float,
    known: float = 0.0,
) -> ModeAbove | None:
    """Find a mode at the end of the band or above that direct FRFs of a body show.

    Args:
        block: FRFs of the body.
        band: of the fit [Hz].
        columns: the other terms of the fit over s.
        ratio: expected damping ratio of the mode [-].
        known: highest frequency of the modes that are known [Hz].

    Returns:
        The mode; None if none is needed.
    """
    direct = _prepared(block, band, columns)
    least = max(_NEAREST * band[1], _CLEAR * known)
    grid = np.log(np.geomspace(least, _FARTHEST * band[1], _CANDIDATES))
    gains = [direct.gain(float(np.exp(one)), ratio) for one in grid.tolist()]
    at = int(np.argmax(gains))
    freedom = direct.left.size - direct.space.shape[0] * (direct.space.shape[2] + 1)
    noise = _noise(direct, gains[at], freedom)

    def cost(point: FloatArray) -> float:
        frequency, damping = np.exp(point).tolist()
        prior = ((point[1] - np.log(ratio)) / _RATIO_SPREAD) ** 2
        return float(prior - direct.gain(frequency, damping) / noise)

    ends = float(grid[max(at - 1, 0)]), float(grid[min(at + 1, grid.size - 1)])
    wide = 4.0 * _RATIO_SPREAD
    best = minimize(
        cost,
        np.array([grid[at], np.log(ratio)]),
        method="Nelder-Mead",
        bounds=[ends, (np.log(ratio) - wide, np.log(ratio) + wide)],
        options={"xatol": 1e-6, "fatol": 1e-3},
    ).x
    frequency, damping = np.exp(best).tolist()
    gain = direct.gain(frequency, damping)
    enough = chi2_limit(_CHANCE, direct.space.shape[0] + 2)
    noise = _noise(direct, gain, freedom)
    if gain / noise < enough or frequency > _LAST * band[1]:
        return None
    sd = _deviations(cost, best)
    return ModeAbove(frequency, frequency * sd[0], damping, damping * sd[1])


def _noise(direct: _DirectFrfs, gain: float, freedom: int) -> float:
    """Return chi2 over its degrees of freedom, at least 1."""
    whole = float(np.einsum("pr,pr->", direct.left, direct.left))
    return max(1.0, (whole - gain) / max(freedom, 1))


def _prepared(
    block: FrfBlock,
    band: tuple[float, float],
    columns: Sequence[Callable[[ComplexArray], ComplexArray]],
) -> _DirectFrfs:
    inside = np.flatnonzero((block.frequency >= band[0]) & (block.frequency <= band[1]))
    few = inside[:: max(1, inside.size // _MOST_LINES)]
    laplace = np.asarray(2j * np.pi * block.frequency[few], complex)
    basis = np.array([one(laplace) for one in columns]).T
    points = range(block.receptance.shape[0])
    weight = 1.0 / np.sqrt(0.5 * np.array([block.variance[i, i, few] for i in points]))
    spaces, rest = [], []
    for point, own in zip(points, weight, strict=True):
        scaled = basis * own[:, None]
        rows = np.concatenate([scaled.real, scaled.imag])
        space = np.linalg.qr(rows / np.linalg.norm(rows, axis=0))[0]
        response = block.receptance[point, point, few] * own
        wanted = np.concatenate([response.real, response.imag])
        spaces.append(space)
        rest.append(wanted - space @ (space.T @ wanted))
    return _DirectFrfs(laplace, weight, np.array(spaces), np.array(rest))


def _deviations(
    cost: Callable[[FloatArray], float], best: FloatArray
) -> tuple[float, float]:
    """Return standard deviations of both logarithms from the curvature of chi2."""
    least = cost(best)
    steps = []
    for axis, step in zip(np.eye(2), _FIRST_STEPS, strict=True):
        while step < _LAST_STEP and cost(best + step * axis) - least < 1.0:
            step *= 2.0
        steps.append(step * axis)
    curve = np.zeros((2, 2))
    for i, one in enumerate(steps):
        for j, other in enumerate(steps):
            ends = cost(best + one + other) - cost(best + one - other)
            ends -= cost(best - one + other) - cost(best - one - other)
            curve[i, j] = ends / 4.0
    value, vector = np.linalg.eigh(curve)
    # In steps: a direction without curvature is open by many of them.
    covariance = (vector / np.maximum(0.5 * value, _FLAT)) @ vector.T
    size = np.sqrt(np.diag(covariance)) * np.array([steps[0][0], steps[1][1]])
    return float(size[0]), float(size[1])
