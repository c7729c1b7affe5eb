# SPDX-License-Identifier: MIT
"""Spectrum of a band-limited self-affine surface with a lay, over two wavenumbers."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import BoolArray, FloatArray
from jointbench.signal.band_limited.map_sample import TAPER, MapSample
from jointbench.signal.fractal.instrument_blur import tip_fall
from jointbench.signal.surface.line_spectrum import fade

_LAYS = 12
"""Directions over which densities beyond the images are averaged [-]."""
_LONG = 9.0
"""Waves along the sides below which the taper smooths the density [-]."""
_REACH = 2
"""Ordinates to each side over which it does [-]."""
_NODES = (7, 11)
"""Places along rows and columns between which images are interpolated [-]: within 1e-4
of their sum."""


@dataclass(frozen=True, slots=True)
class LaySpectrum:
    """A self-affine surface with a lay, seen by an instrument.

    With the wavenumbers u along the lay and v across it the density is

        level / (1 + (|u| / q_u)^(2 / (1 + e)) + (|v| / q_v)^(2 / (1 - e)))^(1 + H),

    so that lines along the lay have the exponent H / (1 + e), lines across it
    H / (1 - e). With e = 0 and q_u = q_v it is the isotropic surface whose lines have
    the spectrum of `BandLimited`.

    Attributes:
        level: density at the pivot, up to the anisotropy.
        pivot: wavenumber [rad/sample].
        hurst: H [-].
        roll_off: wavelength [samples], the same along and across but for `ratio`.
        blur: square of the width of the short cut [samples^2].
        noise: variance of each height.
        ratio: wavelength along over that across of equal density, at the pivot [-].
        angle: of the lay from the rows towards the columns [rad].
        skew: e [-].

    Source:
        Fields that scale differently along two axes: Bierme, Meerschaert and Scheffler,
        Stoch. Proc. Appl. 117 (2007) 312, sec. 2 and 4.
    """

    level: float
    pivot: float
    hurst: float
    roll_off: float
    blur: float = 0.0
    noise: float = 0.0
    ratio: float = 1.0
    angle: float = 0.0
    skew: float = 0.0

    @property
    def exponents(self) -> tuple[float, float]:
        """H along the lay and across it [-]."""
        return self.hurst / (1 + self.skew), self.hurst / (1 - self.skew)

    @property
    def roll_offs(self) -> tuple[float, float]:
        """Roll-off wavelengths along the lay and across it [samples]."""
        far = 2 * np.log(self.pivot * self.roll_off / (2 * np.pi))
        wide = np.log(self.ratio)
        unit = 2 * np.pi / self.pivot
        along = unit * np.exp(0.5 * (1 + self.skew) * (far + wide))
        across = unit * np.exp(0.5 * (1 - self.skew) * (far - wide))
        return float(along), float(across)

    def surface(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return the density of the surface itself, at any wavenumbers.

        Args:
            x: along the rows [rad/sample], any shape.
            y: down the columns [rad/sample], same shape.
        """
        turn, lift = np.cos(self.angle), np.sin(self.angle)
        far = (self.pivot * self.roll_off / (2 * np.pi)) ** 2
        u = np.abs(x * turn + y * lift) / self.pivot
        v = np.abs(y * turn - x * lift) / self.pivot
        if self.skew == 0:
            rho = self.ratio * np.square(u) + np.square(v) / self.ratio
        else:
            rho = self.ratio * u ** (2 / (1 + self.skew))
            rho += v ** (2 / (1 - self.skew)) / self.ratio
        rho *= far
        middle = 1 + 0.5 * far * (self.ratio + 1 / self.ratio)
        density: FloatArray = self.level * (middle / (1 + rho)) ** (1 + self.hurst)
        return density

    def short_cut(self, x: FloatArray, y: FloatArray, *, tip: bool) -> FloatArray:
        """Return the power that the short cut leaves, of a tip's path or a Gaussian."""
        square = np.square(x) + np.square(y)
        if not tip:
            left: FloatArray = np.exp(-self.blur * square)
            return left
        fall = tip_fall(2 * self.hurst)
        traced: FloatArray = (1 + self.blur / fall * square) ** -fall
        return traced

    def blurred(self, x: FloatArray, y: FloatArray, *, tip: bool) -> FloatArray:
        """Return the density after the short cut."""
        density = self.surface(x, y)
        if self.blur > 0:
            density *= self.short_cut(x, y, tip=tip)
        return density


@dataclass(frozen=True, slots=True, eq=False)
class SeenBins:
    """Where the density of a model is taken for the bins of a sample.

    Attributes:
        sample: the binned spectrum.
        long: bins of few waves, which the taper smooths, shape (n_bins,).
        places: wavenumbers about each long bin, shape (2, n_long, n_places).
        weight: of the places, shape (n_places,).
        images: wavenumbers of images, shape (2, n_nodes, 8).
        between: from the images at the nodes to those of the bins, shape
            (n_bins, n_nodes).
        passed: share of the power that known filters pass, shape (n_bins,).
    """

    sample: MapSample
    long: BoolArray
    places: FloatArray
    weight: FloatArray
    images: FloatArray
    between: FloatArray
    passed: FloatArray

    @property
    def cell(self) -> float:
        """Area of the wavenumbers that the grid resolves [rad^2/sample^2]."""
        return float(4 * np.pi**2 / self.sample.stretch)

    def density(self, model: LaySpectrum) -> FloatArray:
        """Return the expected spectrum in each bin, with images and noise."""
        sample, tip = self.sample, self.sample.transfer.tip is not None
        seen = model.blurred(sample.along, sample.down, tip=tip)
        if self.places.size:
            near = model.blurred(self.places[0], self.places[1], tip=tip)
            seen[self.long] = near @ self.weight
        images = model.blurred(self.images[0], self.images[1], tip=tip).sum(axis=1)
        seen += self.between @ images
        seen += self._beyond(model)
        total: FloatArray = seen * self.passed + model.noise / self.cell
        return total

    def _beyond(self, model: LaySpectrum) -> float:
        """Return the density of all further images, as an integral over a disc."""
        edge = np.sqrt(9 * self.cell / np.pi)
        turn = np.pi * np.arange(_LAYS) / _LAYS
        tip = self.sample.transfer.tip is not None
        mean = model.blurred(edge * np.cos(turn), edge * np.sin(turn), tip=tip).mean()
        return float(np.pi * mean * edge**2 / (model.hurst * self.cell))


def seen_bins(sample: MapSample) -> SeenBins:
    """Return where the density is taken for a sample."""
    unit = sample.lowest
    waves = np.hypot(sample.along / unit[0], sample.down / unit[1])
    long = waves < _LONG
    step = np.arange(-_REACH, _REACH + 1)
    right, up = np.meshgrid(step, step)
    near = (np.abs(right) + np.abs(up) <= _REACH).ravel()
    kernel = [_smoothing(n) for n in sample.shape]
    weight = np.outer(kernel[0], kernel[1]).ravel()[near]
    places = np.stack(
        [
            sample.along[long][:, None] + unit[0] * right.ravel()[near],
            sample.down[long][:, None] + unit[1] * up.ravel()[near],
        ]
    )
    images, between = _images(sample)
    passed = sample.transfer.power(np.hypot(sample.along, sample.down))
    return SeenBins(
        sample, long, places, weight / weight.sum(), images, between, passed
    )


def _smoothing(points: int) -> FloatArray:
    """Return the squared transform of the taper at the nearest ordinates."""
    step = np.arange(-_REACH, _REACH + 1)
    phase = np.exp(2j * np.pi * np.outer(step, np.arange(points) / points))
    square: FloatArray = np.abs(phase @ fade(points, TAPER)) ** 2
    return square


def _images(sample: MapSample) -> tuple[FloatArray, FloatArray]:
    """Return images of nodes of Chebyshev, and the interpolation between the nodes."""
    top = np.pi, np.pi / sample.stretch
    nodes = [np.cos(np.pi * (np.arange(n) + 0.5) / n) for n in _NODES]
    right, up = np.meshgrid(0.5 * top[0] * (1 + nodes[0]), top[1] * nodes[1])
    shift = [(k, j) for k in (-1, 0, 1) for j in (-1, 0, 1) if k or j]
    periods = 2 * np.array(shift) * top
    images = np.stack(
        [right.reshape(-1, 1) + periods[:, 0], up.reshape(-1, 1) + periods[:, 1]]
    )
    across = _between(nodes[0], 2 * sample.along / top[0] - 1)
    down = _between(nodes[1], sample.down / top[1])
    between = (down[:, :, None] * across[:, None, :]).reshape(sample.along.size, -1)
    return images, between


def _between(nodes: FloatArray, places: FloatArray) -> FloatArray:
    """Return the polynomials that are 1 at one node each, shape (n_places, n_nodes)."""
    degree = nodes.size - 1
    known = np.polynomial.chebyshev.chebvander(nodes, degree)
    asked = np.polynomial.chebyshev.chebvander(places, degree)
    return np.asarray(np.linalg.solve(known.T, asked.T).T, dtype=np.float64)
