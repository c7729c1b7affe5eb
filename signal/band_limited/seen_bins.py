# SPDX-License-Identifier: MIT
"""Spectrum of a model in the bins of a map's sample, as the grid and taper show it."""

from dataclasses import dataclass, replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, IntArray
from jointbench.signal.band_limited.lay_spectrum import LaySpectrum
from jointbench.signal.band_limited.map_parameters import (
    ANGLE,
    BLUR,
    HURST,
    RATIO,
    ROLL_OFF,
    SKEW,
)
from jointbench.signal.band_limited.map_sample import TAPER, MapSample
from jointbench.signal.fractal.instrument_blur import tip_fall
from jointbench.signal.surface.line_spectrum import fade

_LAYS = 48
"""Directions over which densities beyond the images are averaged [-]."""
_IMAGES = 8
"""Images of the spectrum next to it [-], taken at each bin."""
_FAR_RINGS = (2, 3)
"""Rings of images beyond them, taken at the nodes; the rest is an integral."""
_FAR = sum(8 * ring for ring in _FAR_RINGS)
_NODES, _FEW_NODES = (7, 11), (4, 6)
"""Places along rows and columns between which far images are interpolated [-]: within
1e-3 of the density, of the whole within 0.02 up to a ratio of 5; and the same where a
surface has hardly a lay."""
_LONG = 9.0
"""Waves along the sides below which the taper smooths the density [-]."""
_REACH = 2
"""Ordinates to each side over which it does [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class TakenDensity:
    """Density of a model at wavenumbers, with the parts that its derivatives share.

    Attributes:
        model: the surface.
        parts: wavenumbers along the lay and across it over the pivot [-], and the parts
            of the roll-off's sum along it and across it [-], each of shape (n,); empty
            without a lay.
        rest: 1 and both parts [-], shape (n,).
        fall: ln of the density over the level before the short cut, over 1 + H [-].
        square: of the wavenumber [rad^2/sample^2], same shape.
        tip: whether the short cut is a tip's path or a Gaussian.
        density: after the short cut, same shape.
    """

    model: LaySpectrum
    parts: tuple[FloatArray, ...]
    rest: FloatArray
    fall: FloatArray
    square: FloatArray
    tip: bool
    density: FloatArray

    def rate(self, parameter: int) -> FloatArray:
        """Return the derivative of ln density by a parameter of `map_parameters`.

        Args:
            parameter: its place; level and noise have closed ones of the bins.
        """
        if parameter == HURST:
            return self._by_hurst()
        if parameter == BLUR:
            return self._by_blur()
        return (1 + self.model.hurst) * self._fall_by(parameter)

    def _fall_by(self, parameter: int) -> FloatArray:
        """Return the derivative of `fall` by roll-off, ratio, angle or skew."""
        model, rest = self.model, self.rest
        middle = 1 + model.far * (model.ratio + 1 / model.ratio) / 2
        if parameter == ROLL_OFF:
            return 2 * (1 / rest - 1 / middle)
        u, v, along, across = self.parts
        if parameter == RATIO:
            whole = model.far * (model.ratio - 1 / model.ratio) / 2 / middle
            return whole - (along - across) / rest
        first, second = model.powers
        if parameter == ANGLE:
            turned = first * _over(along, u) * v
            turned -= second * _over(across, v) * u
            return -turned / rest
        assert parameter == SKEW
        bent = second**2 * across * _log(v)
        bent -= first**2 * along * _log(u)
        return -bent / (2 * rest)

    def _by_hurst(self) -> FloatArray:
        if not (self.tip and self.model.blur > 0):
            return self.fall
        # The exponent of a tip's short cut is inverse to H.
        fall = tip_fall(2 * self.model.hurst)
        ratio = self.model.blur / fall * self.square
        by_exponent = ratio / (1 + ratio) - np.log1p(ratio)
        return self.fall - by_exponent * fall / self.model.hurst

    def _by_blur(self) -> FloatArray:
        if not self.tip:
            return -self.square
        fall = tip_fall(2 * self.model.hurst)
        return -self.square / (1 + self.model.blur / fall * self.square)


def take_density(
    model: LaySpectrum, bins: "SeenBins", *, tip: bool, turned: bool
) -> TakenDensity:
    """Return the density of a model after its short cut.

    Args:
        model: the surface.
        bins: wavenumbers.
        tip: whether the short cut is a tip's path or a Gaussian.
        turned: whether the model has a lay, or derivatives by one are asked for.
    """
    square = bins.square
    middle = 1 + model.far * (model.ratio + 1 / model.ratio) / 2
    if turned:
        parts: tuple[FloatArray, ...] = model.parts(bins.x, bins.y)
        rest = 1 + parts[2]
        rest += parts[3]
    else:
        parts, rest = (), 1 + model.far / model.pivot**2 * square
    fall = np.log(middle / rest)
    log_density = (1 + model.hurst) * fall
    if model.blur > 0:
        log_density += model.log_short_cut(square, tip=tip)
    density = model.level * np.exp(log_density)
    return TakenDensity(model, parts, rest, fall, square, tip, density)


def _over(part: FloatArray, wave: FloatArray) -> FloatArray:
    """Return a power above 1 of a wavenumber over it, 0 where it is 0."""
    return np.divide(part, wave, out=np.zeros_like(part), where=wave != 0)


def _log(wave: FloatArray) -> FloatArray:
    """Return ln |wave|, 0 where it is 0."""
    return np.log(np.abs(wave), out=np.zeros_like(wave), where=wave != 0)


@dataclass(frozen=True, slots=True, eq=False)
class SeenBins:
    """Where the density of a model is taken for the bins of a sample.

    All wavenumbers are in one array, which costs a fraction of four: those of the bins,
    those about each long bin, the images of each bin, further images of each node and
    the disc beyond them. Images of a surface with a lay cross the bins as narrow
    ridges: between a few nodes the next ones cannot be interpolated.

    Attributes:
        sample: the binned spectrum.
        x: wavenumbers along the rows [rad/sample], shape (n_places,).
        y: the same down the columns, same shape.
        square: x^2 + y^2, same shape.
        long: places of bins of few waves, which the taper smooths, shape (n_long,).
        weight: of the places about a long bin, shape (n_near,).
        between: from the far images at the nodes to those of the bins, shape
            (n_bins, n_nodes).
        passed: share of the power that known filters pass, shape (n_bins,).
        cell: area of the wavenumbers that the grid resolves [rad^2/sample^2].
        disc: all further images, for H = 1, over the sum of the densities at the edge
            of those that are taken one by one [-].
    """

    sample: MapSample
    x: FloatArray
    y: FloatArray
    square: FloatArray
    long: IntArray
    weight: FloatArray
    between: FloatArray
    passed: FloatArray
    cell: float
    disc: float

    def density(self, model: LaySpectrum) -> FloatArray:
        """Return the expected spectrum in each bin, with images and noise."""
        return self.seen(model).density

    def seen(
        self, model: LaySpectrum, *, least: float = 0.0, turned: bool = True
    ) -> "SeenDensity":
        """Return the expected spectrum in each bin, for its derivatives as well.

        Args:
            model: the surface.
            least: density that no bin falls below.
            turned: see `take_density`.
        """
        tip = self.sample.transfer.tip is not None
        taken = take_density(model, self, tip=tip, turned=turned)
        beyond = float(taken.density[-_LAYS:].sum()) * self.disc / model.hurst
        total = (self.folded(taken.density) + beyond) * self.passed
        total += model.noise / self.cell
        return SeenDensity(self, taken, np.maximum(total, least))

    def folded(self, values: FloatArray) -> FloatArray:
        """Return values at the places as the grid shows them, the disc left out."""
        bins, near = self.passed.size, self.weight.size
        far = values.size - _LAYS - _FAR * self.between.shape[1]
        middle = far - _IMAGES * bins
        seen = values[:bins].copy()
        seen[self.long] = values[bins:middle].reshape(-1, near) @ self.weight
        seen += values[middle:far].reshape(_IMAGES, bins).sum(axis=0)
        seen += self.between @ values[far:-_LAYS].reshape(_FAR, -1).sum(axis=0)
        return seen

    def folded_rate(self, taken: TakenDensity, parameter: int) -> FloatArray:
        """Return the derivative of the surface's spectrum in each bin."""
        rates = taken.density * taken.rate(parameter)
        hurst = taken.model.hurst
        disc = float(rates[-_LAYS:].sum())
        if parameter == HURST:
            disc -= float(taken.density[-_LAYS:].sum()) / hurst
        seen = self.folded(rates) + disc * self.disc / hurst
        seen *= self.passed
        return seen


@dataclass(frozen=True, slots=True, eq=False)
class SeenDensity:
    """Expected spectrum of a model in each bin.

    Attributes:
        bins: where it is taken.
        taken: density at their places.
        density: with images and noise, shape (n_bins,).
    """

    bins: SeenBins
    taken: TakenDensity
    density: FloatArray

    def rate(self, parameter: int) -> FloatArray:
        """Return its derivative by a parameter of the surface or the blur."""
        return self.bins.folded_rate(self.taken, parameter)

    def raised(self, factor: float) -> "SeenDensity":
        """Return the density of a surface of a higher level, without noise.

        Args:
            factor: on its density [-].
        """
        model = replace(self.taken.model, level=factor * self.taken.model.level)
        taken = replace(self.taken, model=model, density=factor * self.taken.density)
        return replace(self, taken=taken, density=factor * self.density)


def seen_bins(sample: MapSample, *, few: bool = False) -> SeenBins:
    """Return where the density is taken for a sample.

    Args:
        sample: the binned spectrum.
        few: whether the models have hardly a lay, so that few places suffice.
    """
    unit = sample.lowest
    waves = np.hypot(sample.along / unit[0], sample.down / unit[1])
    long = waves < _LONG
    step = np.arange(-_REACH, _REACH + 1)
    right, up = np.meshgrid(step, step)
    near = (np.abs(right) + np.abs(up) <= _REACH).ravel()
    kernel = [_smoothing(n) for n in sample.shape]
    weight = np.outer(kernel[0], kernel[1]).ravel()[near]
    images = _images(sample.along, sample.down, sample.stretch, (1,))
    nodes, between = _nodes(sample, _FEW_NODES if few else _NODES)
    far = _images(*nodes, sample.stretch, _FAR_RINGS)
    turn = np.pi * np.arange(_LAYS) / _LAYS
    cell = float(4 * np.pi**2 / sample.stretch)
    edge = float(np.sqrt((1 + _IMAGES + _FAR) * cell / np.pi))
    about = (
        sample.along[long][:, None] + unit[0] * right.ravel()[near],
        sample.down[long][:, None] + unit[1] * up.ravel()[near],
    )
    x, y = (
        np.concatenate(
            [
                own,
                about[k].ravel(),
                images[k].ravel(),
                far[k].ravel(),
                edge * part(turn),
            ]
        )
        for k, (own, part) in enumerate(((sample.along, np.cos), (sample.down, np.sin)))
    )
    passed = sample.transfer.power(np.hypot(sample.along, sample.down))
    return SeenBins(
        sample=sample,
        x=x,
        y=y,
        square=x**2 + y**2,
        long=long.nonzero()[0],
        weight=weight / weight.sum(),
        between=between,
        passed=passed,
        cell=cell,
        disc=np.pi * edge**2 / (cell * _LAYS),
    )


def _smoothing(points: int) -> FloatArray:
    """Return the squared transform of the taper at the nearest ordinates."""
    step = np.arange(-_REACH, _REACH + 1)
    phase = np.exp(2j * np.pi * np.outer(step, np.arange(points) / points))
    square: FloatArray = np.abs(phase @ fade(points, TAPER)) ** 2
    return square


def _images(
    along: FloatArray, down: FloatArray, stretch: float, rings: tuple[int, ...]
) -> tuple[FloatArray, FloatArray]:
    """Return images of places along rows and columns, each (n_images, n_places).

    Args:
        along: the places along the rows [rad/sample].
        down: the same down the columns.
        stretch: distance of the rows over that of the columns [-].
        rings: of images, counted from the places themselves.
    """
    most = range(-max(rings), max(rings) + 1)
    shift = [(k, j) for k in most for j in most if max(abs(k), abs(j)) in rings]
    right, up = 2 * np.pi * np.array(shift).T[:, :, None] / [[[1]], [[stretch]]]
    return along + right, down + up


def _nodes(
    sample: MapSample, numbers: tuple[int, int]
) -> tuple[tuple[FloatArray, FloatArray], FloatArray]:
    """Return nodes of Chebyshev, and the interpolation from them to the bins."""
    top = np.pi, np.pi / sample.stretch
    nodes = [np.cos(np.pi * (np.arange(n) + 0.5) / n) for n in numbers]
    right, up = np.meshgrid(0.5 * top[0] * (1 + nodes[0]), top[1] * nodes[1])
    across = _between(nodes[0], 2 * sample.along / top[0] - 1)
    down = _between(nodes[1], sample.down / top[1])
    between = (down[:, :, None] * across[:, None, :]).reshape(sample.along.size, -1)
    return (right.ravel(), up.ravel()), between


def _between(nodes: FloatArray, places: FloatArray) -> FloatArray:
    """Return the polynomials that are 1 at one node each, shape (n_places, n_nodes)."""
    degree = nodes.size - 1
    known = np.polynomial.chebyshev.chebvander(nodes, degree)
    asked = np.polynomial.chebyshev.chebvander(places, degree)
    return np.asarray(np.linalg.solve(known.T, asked.T).T, dtype=np.float64)
