# SPDX-License-Identifier: MIT
"""FRFs of a free body as rigid motions, modes and a series for the modes above."""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, freeze
from jointbench.analysis.structures.measured.measured_body import ModalTable

# A rigid motion counts if it exceeds its noise by this factor.
_ABOVE_NOISE = 3.0
_MOST_RIGID = 6
# Shares of the band at which poles above it answer as the series does.
_LOW, _HIGH = 0.4, 0.9
# Modes above this share of the band have no peak in it.
_CLEARLY_ABOVE = 1.03
# Eigenvalues of the flexibility below this share of the largest are noise.
_NO_FLEXIBILITY = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class BodyResponse:
    """Receptances of a body as a function of s, valid within the band of their fit.

    H(s) = rigid' rigid / s^2 + sum over modes residue / (s^2 + 2 z w s + w^2) + sum
    over p series[p] s^p; odd powers are the damping of the modes above.

    Attributes:
        omega: of the elastic modes [rad/s], shape (n_modes,).
        damping_ratio: [-], shape (n_modes,).
        residues: symmetric [1/kg], shape (n_modes, n_points, n_points).
        rigid: [kg^-1/2], shape (n_rigid, n_points).
        series: symmetric, shape (n_terms, n_points, n_points).
    """

    omega: FloatArray
    damping_ratio: FloatArray
    residues: FloatArray
    rigid: FloatArray
    series: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, *self.__slots__)

    def at(self, s: complex) -> ComplexArray:
        """Return H(s) [m/N], shape (n_points, n_points)."""
        swing = s * s + 2.0 * self.damping_ratio * self.omega * s + self.omega**2
        powers = s ** np.arange(self.series.shape[0])
        found = self.rigid.T @ self.rigid / (s * s)
        found = found + np.tensordot(1.0 / swing, self.residues, 1)
        return np.asarray(found + np.tensordot(powers, self.series, 1))

    def slope(self, s: complex) -> ComplexArray:
        """Return dH/ds, shape (n_points, n_points)."""
        decay = 2.0 * self.damping_ratio * self.omega
        swing = s * s + decay * s + self.omega**2
        power = np.arange(self.series.shape[0])
        slopes = power * s**power / s
        found = -2.0 * self.rigid.T @ self.rigid / s**3
        found = found - np.tensordot((2.0 * s + decay) / swing**2, self.residues, 1)
        return np.asarray(found + np.tensordot(slopes, self.series, 1))


@dataclass(frozen=True, slots=True, eq=False)
class FittedFrfs:
    """Real coefficients of all FRFs of a body.

    Attributes:
        name: of the body.
        frequency: of the elastic modes [Hz], shape (n_modes,).
        frequency_sd: [Hz], shape (n_modes,).
        damping_ratio: [-], shape (n_modes,).
        damping_sd: [-], shape (n_modes,).
        terms: rigid [1/kg], residues [1/kg], flexibility [m/N] and coefficients of s,
            s^2 ... of the modes above, shape (n_terms, n_points, n_points), symmetric.
        roots: factors of the covariance of the terms of each FRF, shape (n_points,
            n_points, n_terms, n_terms).
        band_hz: highest frequency of the fit [Hz].
    """

    name: str
    frequency: FloatArray
    frequency_sd: FloatArray
    damping_ratio: FloatArray
    damping_sd: FloatArray
    terms: FloatArray
    roots: FloatArray
    band_hz: float

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, *(one for one in self.__slots__ if one not in ("name", "band_hz")))

    @property
    def powers(self) -> int:
        """Highest power of s that describes the modes above the band."""
        return int(self.terms.shape[0]) - int(self.frequency.size) - 2

    @property
    def terms_sd(self) -> FloatArray:
        """Standard deviations of the terms, same shape."""
        return np.asarray(np.moveaxis(np.linalg.norm(self.roots, axis=3), 2, 0))

    def response(self) -> BodyResponse:
        """Return the FRFs, with modes of the band of rank one.

        Within the band, the residue of a mode above and the series compensate each
        other's errors; at a rank of one it would not.
        """
        count = self.frequency.size
        shapes = self._shapes()
        pure = shapes[:, :, None] * shapes[:, None, :]
        above = self.frequency > _CLEARLY_ABOVE * self.band_hz
        return BodyResponse(
            2.0 * np.pi * self.frequency,
            self.damping_ratio,
            np.where(above[:, None, None], self.terms[1 : count + 1], pure),
            self._rigid(),
            self.terms[count + 1 :],
        )

    def table(self) -> ModalTable:
        """Return modes of rank one, rigid motions and modes in place of the series."""
        count = self.frequency.size
        points = self.terms.shape[1]
        spread = np.sqrt(np.einsum("mii->mi", self.terms_sd[1 : count + 1]))
        flexibility, curvature = self._modes_above()
        return ModalTable(
            self.name,
            self.frequency,
            self.frequency_sd,
            self.damping_ratio,
            self.damping_sd,
            self._shapes(),
            spread.reshape(count, points),
            self._rigid(),
            flexibility,
            curvature,
            self.band_hz,
        )

    def drawn(self, random: np.random.Generator) -> "FittedFrfs":
        """Return coefficients drawn from their uncertainty.

        The place of a mode above the band stays: its residue and the series follow it.
        """
        points, terms = self.roots.shape[0], self.roots.shape[2]
        noise = np.einsum(
            "ijkl,ijl->kij", self.roots, random.standard_normal((points, points, terms))
        )
        upper = np.triu(noise)
        noise = upper + np.swapaxes(np.triu(noise, 1), 1, 2)
        shift = random.standard_normal((2, self.frequency.size))
        shift[:, self.frequency > _CLEARLY_ABOVE * self.band_hz] = 0.0
        return replace(
            self,
            frequency=np.sort(self.frequency + self.frequency_sd * shift[0]),
            damping_ratio=np.maximum(
                self.damping_ratio + self.damping_sd * shift[1], 0.0
            ),
            terms=self.terms + noise,
        )

    def _shapes(self) -> FloatArray:
        count = self.frequency.size
        found = [_leading(one) for one in self.terms[1 : count + 1]]
        return np.array(found).reshape(count, self.terms.shape[1])

    def _rigid(self) -> FloatArray:
        """Return the rigid motions that rise above the noise, as rows."""
        value, vector = np.linalg.eigh(self.terms[0])
        noise = float(np.linalg.norm(self.terms_sd[0], 2))
        kept = np.flatnonzero(value > _ABOVE_NOISE * noise)[-_MOST_RIGID:]
        return np.asarray((vector[:, kept] * np.sqrt(value[kept])).T)

    def _modes_above(self) -> tuple[FloatArray, FloatArray]:
        """Return flexibility and curvature of modes that answer as the series does.

        The series is known within the band, its coefficients at s = 0 are not: one mode
        for each direction agrees with it at two frequencies of the band.
        """
        square = (2.0 * np.pi * self.band_hz * np.array([_LOW, _HIGH])) ** 2
        low, high = (self._beside_modes(one) for one in square.tolist())
        value, vector = np.linalg.eigh(low)
        kept = value > _NO_FLEXIBILITY * max(float(value.max(initial=0.0)), 0.0)
        value, vector = value[kept], vector[:, kept]
        inverse = vector / np.sqrt(value)
        ratio, turn = np.linalg.eigh(inverse.T @ high @ inverse)
        # A mode at w answers 1 / (1 - square / w^2) times its flexibility.
        rises = ratio > 1.0
        ratio = np.where(rises, ratio, 2.0)
        place = np.where(rises, (ratio - 1.0) / (ratio * square[1] - square[0]), 0.0)
        rows = np.sqrt(1.0 - square[0] * place) * ((vector * np.sqrt(value)) @ turn)
        return np.asarray(rows @ rows.T), np.asarray((rows * place) @ rows.T)

    def _beside_modes(self, square: float) -> FloatArray:
        """Return what modes of rank one leave of the FRFs at a frequency, squared."""
        whole, shapes = self.response(), self._shapes()
        power = np.arange((whole.series.shape[0] + 1) // 2)
        found = np.tensordot((-square) ** power, whole.series[::2], 1)
        rest = whole.residues - shapes[:, :, None] * shapes[:, None, :]
        above = whole.omega > 2.0 * np.pi * _CLEARLY_ABOVE * self.band_hz
        swing = np.where(above, whole.omega**2 - square, np.inf)
        return np.asarray(found + np.tensordot(1.0 / swing, rest, 1))


def _leading(residue: FloatArray) -> FloatArray:
    """Return the shape of the closest matrix of rank one."""
    value, vector = np.linalg.eigh(residue)
    return np.asarray(vector[:, -1] * np.sqrt(max(float(value[-1]), 0.0)))
