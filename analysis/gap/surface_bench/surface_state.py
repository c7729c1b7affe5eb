# SPDX-License-Identifier: MIT
"""A surface as base and effects describe it, and the spectrum of its samples."""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.surface_bench.cut_surface import CutSurface
from jointbench.analysis.gap.surface_bench.surface_settings import SURFACE
from jointbench.signal.band_limited.known_transfer import KnownTransfer
from jointbench.signal.band_limited.matern_spectrum import BandLimited

ENDLESS = 1e9
"""Roll-off of a surface that has none [samples]."""


@dataclass(frozen=True, slots=True)
class Crossover:
    """Change of the power law at one wavenumber.

    Attributes:
        wavenumber: [rad/sample].
        change: of H from long waves to short ones [-].
        sharpness: 2 for the roll-off of a Matern surface [-].
    """

    wavenumber: float
    change: float
    sharpness: float

    def factor(self, omega: FloatArray) -> FloatArray:
        """Return the density over that of the law of long waves."""
        ratio = (omega / self.wavenumber) ** self.sharpness
        found: FloatArray = (1 + ratio) ** (-2 * self.change / self.sharpness)
        return found


@dataclass(frozen=True, slots=True, eq=False)
class SurfaceState:
    """A surface, its instrument and its faults, in units of pitch and rms height.

    Attributes:
        process: self-affine, with its roll-off; its blur is Gaussian.
        tip: square of the width of the path of a tip [samples^2].
        crossover: to a second law, or None.
        cut: what is left of the process and a finish by a cut, or None.
        noise: variance of each height.
        step: of a converter; 0 for none.
        form: coefficients of Legendre polynomials of degree 2 and 3.
        marks: rms of what repeats.
        wavelength: of it [samples].
        shapes: expected shift of each shape row, see `ShapeRows`.
    """

    process: BandLimited
    tip: float = 0.0
    crossover: Crossover | None = None
    cut: CutSurface | None = None
    noise: float = 0.0
    step: float = 0.0
    form: tuple[float, float] = (0.0, 0.0)
    marks: float = 0.0
    wavelength: float = 0.0
    shapes: tuple[float, ...] = ()

    def shifted(self, row: int, by: float) -> "SurfaceState":
        """Return the state with the expected value of one shape row moved."""
        shapes = list(self.shapes)
        shapes[row] += by
        return replace(self, shapes=tuple(shapes))

    def density(self, omega: FloatArray) -> FloatArray:
        """Return the two-sided density before sampling, at any wavenumber."""
        surface = self.process if self.cut is None else self.cut
        found = surface.surface(omega)
        if self.crossover is not None:
            found = found * self.crossover.factor(omega)
        found = found * self.process.short_cut(omega, tip=False)
        if self.tip > 0:
            traced = replace(self.process, blur=self.tip)
            found = found * traced.short_cut(omega, tip=True)
        return np.asarray(found)

    def sampled(self, omega: FloatArray, transfer: KnownTransfer) -> FloatArray:
        """Return the density of the samples, with images and white noise.

        Args:
            omega: 0 to pi [rad/sample], any shape.
            transfer: what the instrument is known to do.
        """
        total = np.zeros_like(omega)
        for k in range(-SURFACE.folded_images, SURFACE.folded_images + 1):
            total += self.density(np.abs(omega + 2 * np.pi * k))
        edge = np.array(2 * np.pi * (SURFACE.folded_images + 0.5))
        total += float(self.density(edge) * edge / self.process.hurst) / (2 * np.pi)
        return np.asarray(total * transfer.power(omega) + self.noise / (2 * np.pi))


@dataclass(frozen=True, slots=True, eq=False)
class RoundingNoise:
    """Spectrum of the rounding errors of a Gaussian line.

    Attributes:
        omega: wavenumbers of the line's own density [rad/sample], shape (n,).
        width: of their cells [rad/sample], same shape.
        cosine: cos(lag omega), shape (n_lags, n).

    Source:
        Widrow and Kollar 2008, Quantization Noise, ch. 9: the covariance of the errors
        is (s^2 / 2 pi^2) sum k^-2 exp(-2 pi^2 k^2 S / s^2).
    """

    omega: FloatArray
    width: FloatArray
    cosine: FloatArray

    def covariance(self, density: FloatArray, step: float) -> FloatArray:
        """Return the covariance of the errors at lags 0, 1, ..., shape (n_lags,)."""
        structure = 4 * (1 - self.cosine) @ (density * self.width)
        order = np.arange(1, 13)[:, None] ** 2
        depth = 2 * np.pi**2 * order * structure / step**2
        sums = np.sum(np.exp(-np.minimum(depth, SURFACE.largest_depth)) / order, axis=0)
        sums[0] = np.pi**2 / 6
        return np.asarray(step**2 / (2 * np.pi**2) * sums)

    def density(
        self, omega: FloatArray, density: FloatArray, step: float
    ) -> FloatArray:
        """Return the density of the errors at wavenumbers, same shape."""
        covariance = self.covariance(density, step)
        lags = np.arange(1, covariance.size)
        waves = np.cos(np.multiply.outer(omega, lags)) @ covariance[1:]
        total = (covariance[0] + 2 * waves) / (2 * np.pi)
        return np.asarray(np.maximum(total, 1e-6 * covariance[0] / (2 * np.pi)))


def rounding_noise(lags: int) -> RoundingNoise:
    """Return the integral over wavenumbers for lags 0 to `lags`."""
    edge = np.concatenate([[0.0], np.geomspace(1e-3, np.pi, 300)])
    middle = 0.5 * (edge[1:] + edge[:-1])
    cosine = np.cos(np.outer(np.arange(lags + 1), middle))
    return RoundingNoise(middle, np.diff(edge), cosine)
