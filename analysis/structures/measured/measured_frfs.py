# SPDX-License-Identifier: MIT
"""A body from its FRFs measured free-free: rigid motions, modes and the rest above."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import qr

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData, NoModeFound
from jointbench.analysis.structures.measured.frf_coupling import FrfBlock
from jointbench.analysis.structures.measured.measured_body import ModalTable
from jointbench.analysis.structures.measured.mode_above import mode_above
from jointbench.signal.frf.frf import Frf, FrfKind
from jointbench.signal.modal.modes import ModalSettings, identify_modes

# A rigid motion counts if it exceeds its noise by this factor.
_ABOVE_NOISE = 3.0
_MOST_RIGID = 6
_REFERENCES = 2
# Powers of s^2 that describe the modes above the band.
_POWERS = 2
# Lines needed for each unknown of an FRF.
_LINES_EACH = 4
# Damping ratio of a mode above the band of a body without modes in it.
_DAMPING = 0.005


@dataclass(frozen=True, slots=True, eq=False)
class FittedFrfs:
    """Real coefficients of all FRFs of a body.

    H(s) = rigid / s^2 + sum over modes residue / (s^2 + 2 z w s + w^2) + flexibility +
    curvature s^2.

    Attributes:
        name: of the body.
        frequency: of the elastic modes [Hz], shape (n_modes,).
        frequency_sd: [Hz], shape (n_modes,).
        damping_ratio: [-], shape (n_modes,).
        damping_sd: [-], shape (n_modes,).
        terms: rigid [1/kg], residues [1/kg], flexibility [m/N], curvature [m s^2/N],
            shape (n_modes + 3, n_points, n_points), symmetric.
        terms_sd: of each, same shape.
        band_hz: highest frequency of the fit [Hz].
    """

    name: str
    frequency: FloatArray
    frequency_sd: FloatArray
    damping_ratio: FloatArray
    damping_sd: FloatArray
    terms: FloatArray
    terms_sd: FloatArray
    band_hz: float

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, *(one for one in self.__slots__ if one not in ("name", "band_hz")))

    def table(self) -> ModalTable:
        """Return modes of rank one, rigid motions and a positive flexibility."""
        count = self.frequency.size
        rigid, flexibility = self.terms[0], self.terms[-2]
        shapes = [_leading(one) for one in self.terms[1 : count + 1]]
        spread = [_shape_sd(one) for one in self.terms_sd[1 : count + 1]]
        points = rigid.shape[0]
        value, vector = np.linalg.eigh(flexibility)
        positive = (vector * np.maximum(value, 0.0)) @ vector.T
        none = np.zeros((0, points))
        return ModalTable(
            self.name,
            self.frequency,
            self.frequency_sd,
            self.damping_ratio,
            self.damping_sd,
            np.array(shapes).reshape(count, points),
            np.array(spread).reshape(count, points),
            np.concatenate([none, _rigid_rows(rigid, self.terms_sd[0])]),
            positive,
            -self.terms[-1],
            self.band_hz,
        )

    def drawn(self, random: np.random.Generator) -> "FittedFrfs":
        """Return coefficients drawn from their uncertainty."""
        noise = random.standard_normal(self.terms.shape)
        noise = (noise + np.swapaxes(noise, 1, 2)) / np.sqrt(2.0)
        at = np.arange(noise.shape[1])
        noise[:, at, at] /= np.sqrt(2.0)
        shift = random.standard_normal((2, self.frequency.size))
        return replace(
            self,
            frequency=np.sort(self.frequency + self.frequency_sd * shift[0]),
            damping_ratio=np.maximum(
                self.damping_ratio + self.damping_sd * shift[1], 0.0
            ),
            terms=self.terms + self.terms_sd * noise,
        )


def fit_frfs(
    block: FrfBlock, band: tuple[float, float], *, powers: int = _POWERS
) -> FittedFrfs:
    """Fit modes, rigid motions and the flexibility above the band to FRFs.

    A mode just above the band is one of the modes, where the FRFs need it.

    Args:
        block: FRFs of a free body between all of its points.
        band: lowest and highest frequency of the fit [Hz]; above the suspension.
        powers: of s^2 in the response of the modes above the band, at least 1.

    Returns:
        Coefficients with standard deviations.

    Raises:
        BadData: the band holds too few lines.

    Source:
        Ewins, Modal Testing (2000), sec. 4.4 (residual terms of a linear fit).
    """
    keep = (block.frequency >= band[0]) & (block.frequency <= band[1])
    frequency, frequency_sd, ratio, ratio_sd = _with_mode_above(
        block, band, _poles(block, band)
    )
    unknowns = frequency.size + 2 + powers
    if np.count_nonzero(keep) < _LINES_EACH * unknowns:
        raise BadData(
            f"{np.count_nonzero(keep)} lines of {block.name!r} from {band[0]:g} to "
            f"{band[1]:g} Hz for {unknowns} unknowns; widen the band"
        )
    laplace = 2j * np.pi * block.frequency[keep]
    omega = 2.0 * np.pi * frequency
    columns = [
        laplace**-2,
        *(
            1.0 / (laplace**2 + 2 * z * w * laplace + w**2)
            for z, w in zip(ratio, omega, strict=True)
        ),
        np.ones_like(laplace),
        *(laplace ** (2 * power) for power in range(1, powers + 1)),
    ]
    basis = np.array(columns).T
    count, kept = block.receptance.shape[0], frequency.size + 3
    terms = np.zeros((unknowns, count, count))
    spread = np.zeros_like(terms)
    for i in range(count):
        for j in range(i, count):
            both = [(i, j)] if i == j else [(i, j), (j, i)]
            value, sd = _weighted(
                np.concatenate([basis] * len(both)),
                np.concatenate([block.receptance[a, b, keep] for a, b in both]),
                np.concatenate([block.variance[a, b, keep] for a, b in both]),
            )
            terms[:, i, j] = terms[:, j, i] = value
            spread[:, i, j] = spread[:, j, i] = sd
    return FittedFrfs(
        block.name,
        frequency,
        frequency_sd,
        ratio,
        ratio_sd,
        terms[:kept],
        spread[:kept],
        band[1],
    )


def _poles(
    block: FrfBlock, band: tuple[float, float]
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
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
    poles: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Append a mode just above the band where the FRFs need one."""
    frequency, frequency_sd, ratio, ratio_sd = poles
    damping = float(np.median(ratio)) if ratio.size else _DAMPING
    columns = [_power(power) for power in range(-1, _POWERS + 1)]
    columns += [
        _pole(w, z)
        for w, z in zip((2.0 * np.pi * frequency).tolist(), ratio.tolist(), strict=True)
    ]
    found = mode_above(block, band, columns, damping)
    if found is None:
        return poles
    return (
        np.append(frequency, found[0]),
        np.append(frequency_sd, found[1]),
        np.append(ratio, damping),
        np.append(ratio_sd, damping),
    )


def _power(power: int) -> Callable[[ComplexArray], ComplexArray]:
    return lambda s: np.asarray(s ** (2 * power))


def _pole(omega: float, ratio: float) -> Callable[[ComplexArray], ComplexArray]:
    return lambda s: np.asarray(1.0 / (s**2 + 2.0 * ratio * omega * s + omega**2))


def _weighted(
    basis: np.ndarray, response: np.ndarray, variance: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return real coefficients of a weighted fit, and their standard deviations."""
    weight = 1.0 / np.sqrt(0.5 * variance)
    rows = np.concatenate([basis.real * weight[:, None], basis.imag * weight[:, None]])
    wanted = np.concatenate([response.real * weight, response.imag * weight])
    scale = np.linalg.norm(rows, axis=0)
    value, _, _, _ = np.linalg.lstsq(rows / scale, wanted, rcond=None)
    left = wanted - rows / scale @ value
    freedom = max(wanted.size - value.size, 1)
    noise = max(1.0, float(left @ left) / freedom)
    inverse = np.linalg.inv((rows / scale).T @ (rows / scale))
    return value / scale, np.sqrt(noise * np.diag(inverse)) / scale


def _leading(residue: FloatArray) -> FloatArray:
    """Return the shape of the closest matrix of rank one."""
    value, vector = np.linalg.eigh(residue)
    return np.asarray(vector[:, -1] * np.sqrt(max(float(value[-1]), 0.0)))


def _shape_sd(spread: FloatArray) -> FloatArray:
    """Return about the standard deviation of each row of a shape."""
    return np.asarray(np.sqrt(np.diag(spread)))


def _rigid_rows(rigid: FloatArray, spread: FloatArray) -> FloatArray:
    """Return the rigid motions that rise above the noise, as rows."""
    value, vector = np.linalg.eigh(rigid)
    noise = float(np.linalg.norm(spread, 2))
    kept = np.flatnonzero(value > _ABOVE_NOISE * noise)[-_MOST_RIGID:]
    return np.asarray((vector[:, kept] * np.sqrt(value[kept])).T)


def with_uncertainty(
    result: Callable[[Sequence[ModalTable]], FloatArray],
    blocks: Sequence[FrfBlock],
    band: tuple[float, float],
    *,
    draws: int = 40,
    seed: int = 0,
) -> tuple[FloatArray, FloatArray]:
    """Compute something from measured bodies, with its standard deviation.

    Args:
        result: from the tables of the bodies, for example coupled frequencies.
        blocks: FRFs of the bodies.
        band: of the fits [Hz].
        draws: from the uncertainty of the fits.
        seed: of the draws.

    Returns:
        The result, and its standard deviation: that of the draws, and the change with
        one power less, which shows how well the modes above the band are described.
    """
    random = np.random.default_rng(seed)
    fits = [fit_frfs(one, band) for one in blocks]
    value = result([one.table() for one in fits])
    fewer = [fit_frfs(one, band, powers=_POWERS - 1).table() for one in blocks]
    apart = result(fewer) - value
    drawn = np.array(
        [result([one.drawn(random).table() for one in fits]) for _ in range(draws)]
    )
    return value, np.asarray(np.hypot(np.std(drawn, axis=0, ddof=1), apart))
