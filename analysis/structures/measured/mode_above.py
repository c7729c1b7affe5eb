# SPDX-License-Identifier: MIT
"""A mode just above the band of a measured body, from the FRFs below it.

Powers of s^2 describe modes far above the band. One that lies a few per cent above it
has a pole there: a series converges slowly or not at all.
"""

from collections.abc import Callable, Sequence

import numpy as np
from scipy.optimize import minimize_scalar

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.acquisition.basics.tail_probabilities import chi2_limit
from jointbench.analysis.structures.measured.frf_coupling import FrfBlock

# Candidates over the end of the band: from next to it to where a series will do.
_NEAREST, _FARTHEST, _CANDIDATES = 1.001, 1.5, 24
# Beyond this share a series describes the mode as well, and its place is open.
_LAST = 1.25
# A mode is there if noise lowers chi2 as much in less than one of a million fits.
_CHANCE = 1e-6
# Lines that are used of each FRF.
_MOST_LINES = 400
_STEP = 1e-3


def mode_above(
    block: FrfBlock,
    band: tuple[float, float],
    columns: Sequence[Callable[[ComplexArray], ComplexArray]],
    ratio: float,
) -> tuple[float, float] | None:
    """Find a mode above the band that the direct FRFs of a body show.

    Args:
        block: FRFs of the body.
        band: of the fit [Hz].
        columns: the other terms of the fit over s.
        ratio: damping ratio of the mode [-], which the FRFs below hardly show.

    Returns:
        Frequency and its standard deviation [Hz]; None if no mode is needed.
    """
    inside = np.flatnonzero((block.frequency >= band[0]) & (block.frequency <= band[1]))
    few = inside[:: max(1, inside.size // _MOST_LINES)]
    laplace = np.asarray(2j * np.pi * block.frequency[few], complex)
    basis = np.array([one(laplace) for one in columns]).T
    points = range(block.receptance.shape[0])
    response = np.array([block.receptance[i, i, few] for i in points])
    weight = 1.0 / np.sqrt(0.5 * np.array([block.variance[i, i, few] for i in points]))

    def chi2(log_frequency: float) -> float:
        omega = 2.0 * np.pi * float(np.exp(log_frequency))
        pole = 1.0 / (laplace**2 + 2.0 * ratio * omega * laplace + omega**2)
        return _chi2(np.column_stack([basis, pole]), response, weight)

    grid = np.log(band[1] * np.geomspace(_NEAREST, _FARTHEST, _CANDIDATES))
    level = [chi2(one) for one in grid.tolist()]
    at = int(np.argmin(level))
    ends = grid[max(at - 1, 0)], grid[min(at + 1, grid.size - 1)]
    best = minimize_scalar(chi2, bounds=ends, method="bounded").x
    least = chi2(best)
    freedom = 2 * response.size - len(points) * (basis.shape[1] + 1)
    noise = max(1.0, least / max(freedom, 1))
    gain = (_chi2(basis, response, weight) - least) / noise
    frequency = float(np.exp(best))
    if gain < chi2_limit(_CHANCE, len(points) + 1) or frequency > _LAST * band[1]:
        return None
    bend = (chi2(best + _STEP) - 2.0 * least + chi2(best - _STEP)) / _STEP**2
    return frequency, frequency * float(np.sqrt(2.0 * noise / max(bend, 1.0)))


def _chi2(basis: ComplexArray, response: ComplexArray, weight: FloatArray) -> float:
    """Return chi2 of fits with real coefficients, one for each FRF."""
    whole = 0.0
    for one, own in zip(response, weight, strict=True):
        scaled = basis * own[:, None]
        rows = np.concatenate([scaled.real, scaled.imag])
        rows = rows / np.linalg.norm(rows, axis=0)
        wanted = np.concatenate([(one * own).real, (one * own).imag])
        space = np.linalg.qr(rows)[0]
        left = wanted - space @ (space.T @ wanted)
        whole += float(left @ left)
    return whole
