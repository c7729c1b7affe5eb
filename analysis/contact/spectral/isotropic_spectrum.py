# SPDX-License-Identifier: MIT
"""Isotropic spectrum of one or two measured surfaces, with draws of its estimate."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import nnls
from scipy.special import gammaln

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.acquisition.basics.errors import BadData
from jointbench.signal.band_limited.band_records import BandLimitedFit, LineDensity
from jointbench.signal.band_limited.matern_spectrum import BandLimited

DRAWS = 128
"""Draws of a surface: ends of intervals within a tenth of a standard deviation [-]."""
_BINS = 240
"""Wavenumbers of a modelled spectrum [-]."""
_RINGS = 48
"""Wavenumbers of a measured one: at most as many as a line has bins [-]."""
_OBLIQUE = 2.0
"""Highest wavenumber of the rings over that of the line [-]: a line sees shorter waves
where they cross it at an angle. They are fitted, and left out."""
_STRETCH = 9
"""Rings over which draws have the median of the estimate [-]: about two octaves."""
_BELOW = 0.1
"""Lowest wavenumber over that of the longest wave where the surface is level beyond
it: the waves below hold less than a hundredth of the variance [-]."""
_SEED = 235


@dataclass(frozen=True, slots=True, eq=False)
class IsotropicSpectrum:
    """Variance of the heights at each wavenumber, in all directions alike.

    Row 0 is the best estimate, the other rows are draws of equal weight.

    Attributes:
        wavenumber: ascending [rad/m], shape (n_bins,).
        variance: of the waves of each bin [m^2], shape (1 + n_draws, n_bins).
        hurst: H [-], shape (1 + n_draws,); nan without a self-affine band.
        saturated: whether the longest waves of the surface were seen.
        modelled: from a fitted model; False for one from a measured spectrum.
    """

    wavenumber: FloatArray
    variance: FloatArray
    hurst: FloatArray
    saturated: bool
    modelled: bool

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "wavenumber", "variance", "hurst")

    def moment(self, power: int) -> FloatArray:
        """Return the integral of q^power over the surface [m^(2 - power)].

        0 gives the square of the rms height, 2 that of the rms gradient, 4 that of the
        rms Laplacian; shape (1 + n_draws,).
        """
        total: FloatArray = self.variance @ self.wavenumber**power
        return total

    def mean_wave(self) -> FloatArray:
        """Return the mean wavelength by variance [m], shape (1 + n_draws,).

        It is the size of a hill: waves that hold little of the height do not count.
        """
        mean: FloatArray = 2 * np.pi * self.moment(-1) / self.moment(0)
        return mean

    @property
    def shortest(self) -> float:
        """Shortest wavelength [m]."""
        return float(2 * np.pi / self.wavenumber[-1])

    @property
    def longest(self) -> float:
        """Longest wavelength [m]."""
        return float(2 * np.pi / self.wavenumber[0])

    def without_below(self, wavelength: float) -> "IsotropicSpectrum":
        """Return the spectrum without waves shorter than a wavelength [m]."""
        keep = self.wavenumber <= 2 * np.pi / wavelength
        return replace(
            self, wavenumber=self.wavenumber[keep], variance=self.variance[:, keep]
        )


def isotropic_spectrum(fit: BandLimitedFit) -> IsotropicSpectrum:
    """Return the isotropic surface whose lines have the spectrum of a fit.

    Waves shorter than the shortest of the fit's moments take no part. Those longer than
    the line take part only where the fit shows that the spectrum is level there.

    Raises:
        BadData: no wavelength shows the surface.

    Source:
        Nayak, J. Lubr. Technol. 93 (1971) 398: a line's density is the integral of the
        surface's across the line.
    """
    if fit.moments is None:
        raise BadData(
            f"no contact law: {fit.reason}; filters and noise hide every wavelength, "
            "measure with a finer pitch or a shorter lambda_s"
        )
    if fit.model is None or fit.draws is None:
        if fit.density is None:
            raise BadData(f"no contact law: {fit.reason}")
        return _measured(fit.density)
    return _modelled(fit, (fit.moments.shortest, fit.moments.longest))


def _modelled(fit: BandLimitedFit, waves: tuple[float, float]) -> IsotropicSpectrum:
    assert fit.model is not None
    assert fit.draws is not None
    weight = np.array(fit.draws.weight)
    chosen = _systematic(weight, DRAWS)
    models = [fit.model, *(fit.draws.models[k] for k in chosen)]
    saturated = fit.roll_off is not None
    low = 2 * np.pi / waves[1] * (_BELOW if saturated else 1.0)
    edges = np.geomspace(low, 2 * np.pi / waves[0], _BINS + 1)
    middle = np.sqrt(edges[1:] * edges[:-1])
    area = np.pi * (edges[1:] ** 2 - edges[:-1] ** 2)
    density = np.array([_areal_density(one, middle * fit.pitch) for one in models])
    variance = fit.scale**2 * density * area * fit.pitch**2
    if fit.tolerance > 0:
        variance[1:] *= _waver(middle, fit.tolerance)
    hurst = np.array([one.hurst for one in models])
    return IsotropicSpectrum(middle, variance, hurst, saturated, modelled=True)


def _areal_density(model: BandLimited, omega: FloatArray) -> FloatArray:
    """Return the density over both wavenumbers [squared height / (rad/sample)^2].

    Source:
        Integral of (a^2 + y^2)^(-1 - H) over y: sqrt(pi) Gamma(H + 1/2) / Gamma(H + 1)
        times a^(-1 - 2 H).
    """
    ratio = np.exp(gammaln(model.hurst + 1) - gammaln(model.hurst + 0.5))
    corner = 2 * np.pi / model.roll_off
    across: FloatArray = ratio / np.sqrt(np.pi * (corner**2 + omega**2))
    return across * model.surface(omega)


def _waver(wavenumber: FloatArray, tolerance: float) -> FloatArray:
    """Return factors of the draws by which the density differs from the model.

    A fitted tolerance is a standard deviation of ln density that the model leaves; it
    is taken as one draw for each octave, interpolated between them.
    """
    random = np.random.default_rng(_SEED)
    octave = np.log2(wavenumber / wavenumber[0])
    knots = np.arange(int(octave[-1]) + 2)
    drawn = tolerance * random.standard_normal((DRAWS, knots.size))
    return np.exp([np.interp(octave, knots, one) for one in drawn])


def _systematic(weight: FloatArray, count: int) -> Sequence[int]:
    """Return draws of equal weight by systematic resampling.

    Source:
        Kitagawa, J. Comput. Graph. Stat. 5 (1996) 1.
    """
    place = (np.arange(count) + 0.5) / count
    found = np.searchsorted(np.cumsum(weight), place)
    return [int(k) for k in np.minimum(found, weight.size - 1)]


def _measured(line: LineDensity) -> IsotropicSpectrum:
    """Return rings of waves whose lines have a measured spectrum.

    Each ring of waves of one wavenumber gives a line the density 1/(pi sqrt(q^2 -
    q_x^2)) below it. Their variances, none negative, are fitted to the bins with the
    scatter of their ordinates; draws are of those ordinates.
    """
    q, count = line.wavenumber, line.count
    rings = min(_RINGS, q.size)
    step = (q[-1] / q[0]) ** (1 / rings)
    beyond = int(np.ceil(np.log(_OBLIQUE) / np.log(step)))
    edges = q[0] * step ** np.arange(rings + beyond + 1)
    ring = np.sqrt(edges[1:] * edges[:-1])
    bounds = np.concatenate([[q[0]], np.sqrt(q[1:] * q[:-1]), [q[-1]]])
    share = _ring_share(edges, bounds)
    # Lognormal: a density below its estimate is as likely as one above it.
    random = np.random.default_rng(_SEED).standard_normal((DRAWS, q.size))
    drawn = np.exp(random * np.sqrt(np.log1p(1 / count)))
    # A two-sided density: the other half of the variance is at negative q.
    power = 2 * line.density * np.diff(bounds)
    root = np.sqrt(count)
    design = share * (root / power)[:, None]
    seen = np.concatenate([np.ones((1, q.size)), drawn])
    found = _centred(np.array([nnls(design, root * one)[0] for one in seen]))
    hurst = np.full(DRAWS + 1, np.nan)
    return IsotropicSpectrum(
        ring[:rings], found[:, :rings], hurst, saturated=False, modelled=False
    )


def _centred(variance: FloatArray) -> FloatArray:
    """Return draws whose median is the best estimate, over stretches of rings.

    Sums of skewed densities and of variances that cannot be negative are larger than
    the sum of the estimates.
    """
    window = np.ones(min(_STRETCH, variance.shape[1]))
    sums = np.array([np.convolve(one, window, mode="same") for one in variance])
    middle = np.median(sums[1:], axis=0)
    factor = np.divide(sums[0], middle, out=np.ones_like(middle), where=middle > 0)
    centred = variance.copy()
    centred[1:] *= factor
    return centred


def _ring_share(edges: FloatArray, bounds: FloatArray) -> FloatArray:
    """Return which share of a ring's variance a line has in each bin.

    Shape (n_bins, n_rings); the ring is spread evenly over its width in ln q.
    """
    inner = np.linspace(0, 1, 9)[1::2]
    total = np.zeros((bounds.size - 1, edges.size - 1))
    for part in inner:
        radius = edges[:-1] ** (1 - part) * edges[1:] ** part
        angle = np.arcsin(np.clip(bounds[:, None] / radius[None, :], 0, 1))
        total += np.diff(angle, axis=0) * 2 / np.pi
    share: FloatArray = total / inner.size
    return share


def combined(one: IsotropicSpectrum, other: IsotropicSpectrum) -> IsotropicSpectrum:
    """Return the spectrum of the sum of the heights of two independent surfaces.

    Both are cut at the longer of their shortest waves: beyond it one is not known.

    Source:
        Johnson, Contact Mechanics (1985), sec. 13.2: variances of independent heights
        add.
    """
    short = max(one.shortest, other.shortest) * (1 - 1e-9)
    a, b = one.without_below(short), other.without_below(short)
    q = np.concatenate([a.wavenumber, b.wavenumber])
    order = np.argsort(q)
    # Draws of the two are paired at random; those of the best estimates stay together.
    pairs = 1 + np.random.default_rng(_SEED).permutation(DRAWS)
    second = b.variance[np.concatenate([[0], pairs])]
    larger = a.moment(0) >= b.moment(0)[np.concatenate([[0], pairs])]
    return IsotropicSpectrum(
        q[order],
        np.concatenate([a.variance, second], axis=1)[:, order],
        np.where(larger, a.hurst, b.hurst[np.concatenate([[0], pairs])]),
        saturated=a.saturated and b.saturated,
        modelled=a.modelled and b.modelled,
    )


def doubled(one: IsotropicSpectrum) -> IsotropicSpectrum:
    """Return the spectrum of two independent surfaces that one measurement stands for.

    Their spectrum is the same draw: the error of the estimate does not average out.
    """
    return replace(one, variance=2 * one.variance)


def averaged(one: IsotropicSpectrum, other: IsotropicSpectrum) -> IsotropicSpectrum:
    """Return the mean of two spectra of one surface, as of its rows and its columns."""
    halves = [replace(part, variance=0.5 * part.variance) for part in (one, other)]
    return combined(*halves)
