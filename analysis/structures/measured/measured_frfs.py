# SPDX-License-Identifier: MIT
"""A body from its FRFs measured free-free: rigid motions, modes and the rest above."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import qr, solve_triangular

from jointbench.acquisition.basics.arrays import BoolArray, ComplexArray, FloatArray
from jointbench.acquisition.basics.errors import BadData, NoModeFound
from jointbench.acquisition.basics.tail_probabilities import chi2_limit
from jointbench.analysis.structures.measured.fitted_frfs import FittedFrfs
from jointbench.analysis.structures.measured.frf_coupling import FrfBlock
from jointbench.analysis.structures.measured.mode_above import ModeAbove, mode_above
from jointbench.signal.frf.frf import Frf, FrfKind
from jointbench.signal.modal.modes import ModalSettings, identify_modes

_REFERENCES = 2
# Lowest and highest last power of s that describes the modes above the band.
_POWERS, _MOST_POWERS = 4, 12
# A power is needed if noise gains as much with a smaller probability.
_CHANCE = 0.05
# Further powers of the second fit: an odd and an even one.
_FURTHER = 2
# Lines needed for each unknown of an FRF.
_LINES_EACH = 4
# Damping ratio of a mode above the band of a body without modes in it.
_DAMPING = 0.005
# Most modes at the end of the band and above that are modes of the fit.
_MOST_ABOVE = 2
# Rounds in which each of them is found again beside the others.
_ROUNDS = 3


_Poles = tuple[FloatArray, FloatArray, FloatArray, FloatArray]
"""Frequencies [Hz] and damping ratios [-] with standard deviations after each."""


def fit_frfs(block: FrfBlock, band: tuple[float, float]) -> FittedFrfs:
    """Fit modes, rigid motions and the response of the modes above the band to FRFs.

    A mode just above the band is one of the modes, where the FRFs need it; powers of s
    describe the others, as many as the FRFs show.

    Args:
        block: FRFs of a free body between all of its points.
        band: lowest and highest frequency of the fit [Hz]; above the suspension.

    Returns:
        Coefficients with their covariance.

    Raises:
        BadData: the band holds too few lines.

    Source:
        Ewins, Modal Testing (2000), sec. 4.4 (residual terms of a linear fit).
    """
    return fit_twice(block, band)[0]


def fit_twice(
    block: FrfBlock, band: tuple[float, float]
) -> tuple[FittedFrfs, FittedFrfs]:
    """Fit FRFs as `fit_frfs`, and once more with two further powers.

    The difference shows how well the modes above the band are described.
    """
    keep = (block.frequency >= band[0]) & (block.frequency <= band[1])
    poles = _with_mode_above(block, band, _poles(block, band))
    fixed = poles[0].size + 2
    room = int(np.count_nonzero(keep)) // _LINES_EACH - fixed
    if room < _POWERS + _FURTHER:
        raise BadData(
            f"{np.count_nonzero(keep)} lines of {block.name!r} from {band[0]:g} to "
            f"{band[1]:g} Hz for {fixed + _POWERS + _FURTHER} unknowns; widen the band"
        )
    powers = min(room, _MOST_POWERS + _FURTHER)
    laplace = np.asarray(2j * np.pi * block.frequency[keep], complex)
    basis = _basis(laplace, poles[0], poles[2], powers)
    count = block.receptance.shape[0]
    pairs = [(i, j) for i in range(count) for j in range(i, count)]
    solved = [_solved(basis, block, keep, pair) for pair in pairs]
    used = _needed(solved, fixed + _POWERS, fixed + powers - _FURTHER)

    def fitted(columns: int) -> FittedFrfs:
        terms = np.zeros((columns, count, count))
        roots = np.zeros((count, count, columns, columns))
        for (i, j), one in zip(pairs, solved, strict=True):
            terms[:, i, j], roots[i, j] = one.leading(columns)
            terms[:, j, i], roots[j, i] = terms[:, i, j], roots[i, j]
        return FittedFrfs(block.name, *poles, terms, roots, band[1])

    return fitted(used), fitted(used + _FURTHER)


def _basis(
    laplace: ComplexArray, frequency: FloatArray, ratio: FloatArray, powers: int
) -> ComplexArray:
    """Return rigid motions, modes and powers as columns."""
    columns = [_power(-2)]
    columns += [
        _pole(w, z)
        for w, z in zip((2.0 * np.pi * frequency).tolist(), ratio.tolist(), strict=True)
    ]
    columns += [_power(power) for power in range(powers + 1)]
    return np.array([one(laplace) for one in columns]).T


@dataclass(frozen=True, slots=True, eq=False)
class _Solved:
    """A weighted fit of one FRF for any number of leading columns.

    Attributes:
        factor: triangular, of the scaled columns, shape (n, n).
        scale: of the columns, shape (n,).
        along: part of the FRF along each orthonormal column, shape (n,).
        left: sum of squares outside of all columns [-].
        freedom: of `left`.
    """

    factor: FloatArray
    scale: FloatArray
    along: FloatArray
    left: float
    freedom: int

    @property
    def noise(self) -> float:
        """Sum of squares over its degrees of freedom, at least 1."""
        return max(1.0, self.left / max(self.freedom, 1))

    def leading(self, count: int) -> tuple[FloatArray, FloatArray]:
        """Return real coefficients of leading columns, and a root of their covariance.

        Columns that are left out are part of the noise.
        """
        left = self.left + float(self.along[count:] @ self.along[count:])
        freedom = self.freedom + self.along.size - count
        noise = max(1.0, left / max(freedom, 1))
        inverse = solve_triangular(self.factor[:count, :count], np.eye(count))
        inverse = inverse / self.scale[:count, None]
        return inverse @ self.along[:count], np.sqrt(noise) * inverse


def _solved(
    basis: ComplexArray, block: FrfBlock, keep: BoolArray, pair: tuple[int, int]
) -> _Solved:
    """Fit an FRF and its reciprocal one."""
    i, j = pair
    both = [(i, j)] if i == j else [(i, j), (j, i)]
    response = np.concatenate([block.receptance[a, b, keep] for a, b in both])
    variance = np.concatenate([block.variance[a, b, keep] for a, b in both])
    weight = 1.0 / np.sqrt(0.5 * variance)
    scaled = np.concatenate([basis] * len(both)) * weight[:, None]
    rows = np.concatenate([scaled.real, scaled.imag])
    wanted = np.concatenate([response.real * weight, response.imag * weight])
    scale = np.linalg.norm(rows, axis=0)
    space, factor = np.linalg.qr(rows / scale)
    along = space.T @ wanted
    left = max(float(wanted @ wanted - along @ along), 0.0)
    return _Solved(factor, scale, along, left, wanted.size - along.size)


def _needed(solved: Sequence[_Solved], least: int, most: int) -> int:
    """Return the number of columns that the FRFs need together, pair by pair."""
    limit = chi2_limit(_CHANCE, _FURTHER * len(solved))
    gain = np.asarray(sum(one.along**2 / one.noise for one in solved))
    used = least
    while used + _FURTHER <= most and gain[used : used + _FURTHER].sum() > limit:
        used += _FURTHER
    return used


def _poles(block: FrfBlock, band: tuple[float, float]) -> _Poles:
    """Return frequencies and damping ratios with their standard deviations."""
    # Two columns hold the poles; more would only cost time.
    size = np.abs(block.receptance).sum(axis=2)
    order = qr(size, pivoting=True, mode="r")[1]
    chosen = np.sort(order[:_REFERENCES])
    frf = Frf(
        block.frequency,
        block.receptance[:, chosen],
        FrfKind.RECEPTANCE,
        variance=block.variance[:, chosen],
    )
    try:
        found = identify_modes(frf, ModalSettings(band=band)).model
    except NoModeFound:
        none = np.zeros(0)
        return none, none, none, none
    inside = found.natural_frequency > band[0]
    return (
        found.natural_frequency[inside],
        found.frequency_sd[inside],
        found.damping_ratio[inside],
        found.damping_ratio_sd[inside],
    )


def _with_mode_above(
    block: FrfBlock,
    band: tuple[float, float],
    poles: _Poles,
) -> _Poles:
    """Append modes at the end of the band or just above where the FRFs need them."""
    frequency, frequency_sd, ratio, ratio_sd = poles
    damping = float(np.median(ratio)) if ratio.size else _DAMPING
    known = float(frequency.max(initial=0.0))
    columns = [_power(power) for power in (-2, *range(_POWERS + 1))]
    columns += [
        _pole(w, z)
        for w, z in zip((2.0 * np.pi * frequency).tolist(), ratio.tolist(), strict=True)
    ]
    found: list[ModeAbove] = []

    def next_to(others: Sequence[ModeAbove]) -> ModeAbove | None:
        more = [_pole(2.0 * np.pi * o.frequency, o.damping_ratio) for o in others]
        return mode_above(block, band, columns + more, damping, known)

    while len(found) < _MOST_ABOVE and (one := next_to(found)) is not None:
        found.append(one)
        # Each was found without those after it.
        for at in [*range(len(found))] * (_ROUNDS if len(found) > 1 else 0):
            found[at] = next_to(found[:at] + found[at + 1 :]) or found[at]
    return (
        np.append(frequency, [one.frequency for one in found]),
        np.append(frequency_sd, [one.frequency_sd for one in found]),
        np.append(ratio, [one.damping_ratio for one in found]),
        np.append(ratio_sd, [one.damping_sd for one in found]),
    )


def _power(power: int) -> Callable[[ComplexArray], ComplexArray]:
    return lambda s: np.asarray(s**power)


def _pole(omega: float, ratio: float) -> Callable[[ComplexArray], ComplexArray]:
    return lambda s: np.asarray(1.0 / (s**2 + 2.0 * ratio * omega * s + omega**2))
