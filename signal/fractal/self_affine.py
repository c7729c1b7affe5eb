# SPDX-License-Identifier: MIT
"""Structure function of a self-affine profile as an instrument shows it."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray
from scipy.special import betainc, gammaincinv, hyp1f1
from scipy.special import gamma as gamma_function

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.signal.surface.structure_constant import spectral_integral

_ASYMPTOTIC_FROM = 40.0
"""Squared lag over 4 width^2 above which six terms give nine digits [-]."""
_ASYMPTOTIC_TERMS = 6
_QUADRATURE_NODES = 96
_QUADRATURE_LAGS = 60.0
"""Lag beyond which a cosine over the band averages out [samples]; the nodes follow
it up to there."""
_TIP_FALL = 1.3
"""Times 1 / s: half the power by which a tip's path falls off [-], see `tip_fall`."""
TIP_TOLERANCE = 0.01
"""How far S of the mean path of simulated tips lies from `traced_power` [-]."""
_TIP_BLURS = 16
"""Gaussian blurs that make up the path of a tip: S within 2e-3 at all lags [-]."""
_TIP_TAILS = (1e-4, 1.0 - 1e-7)
"""Shares of them below the narrowest and the widest [-]."""
_ROUNDING_TERMS = 6
_WITHIN_ONE_STEP = 0.05
"""S over the square of the step below which no difference exceeds one step [-]."""
_FRACTION_TERMS = 60
"""Depth of the continued fraction; gives twelve digits from pi upwards [-]."""


class InstrumentModel(StrEnum):
    """What the instrument adds or takes away, from the simplest on."""

    NONE = "none"
    BAND_LIMIT = "band limit"
    NOISE = "noise"
    PSF = "point spread"
    PSF_AND_NOISE = "point spread and noise"
    STYLUS = "stylus"
    STYLUS_AND_NOISE = "stylus and noise"

    @property
    def has_noise(self) -> bool:
        """Whether white height noise is among the parameters."""
        return self in {
            InstrumentModel.NOISE,
            InstrumentModel.PSF_AND_NOISE,
            InstrumentModel.STYLUS_AND_NOISE,
        }

    @property
    def has_psf(self) -> bool:
        """Whether the width of a blur is among the parameters."""
        return self.is_traced or self in {
            InstrumentModel.PSF,
            InstrumentModel.PSF_AND_NOISE,
        }

    @property
    def is_traced(self) -> bool:
        """Whether the blur is that of a round tip's path."""
        return self in {InstrumentModel.STYLUS, InstrumentModel.STYLUS_AND_NOISE}


@dataclass(frozen=True, slots=True)
class SeenSurface:
    """A self-affine surface and the instrument it is seen through.

    Lengths are in samples, heights in any one unit.

    Attributes:
        exponent: s = 4 - 2D of the surface [-].
        amplitude: structure function of the surface itself at a lag of one sample.
        noise: variance of white noise of each height.
        psf_width: standard deviation of the Gaussian point spread [samples]; of a tip
            that of the Gaussian which takes as much from long waves.
        axes: 1 where blur and limit act along the profile only, 2 where they act all
            around on an isotropic map.
        band_limited: whether wavelengths under two samples are cut off sharply.
        corner: lag at which the surface stops to grow rougher [samples].
        quantum: step in which the heights are read; 0 for none.
        traced: whether the blur is that of a round tip's path.
    """

    exponent: float
    amplitude: float
    noise: float = 0.0
    psf_width: float = 0.0
    axes: int = 1
    band_limited: bool = False
    corner: float = np.inf
    quantum: float = 0.0
    traced: bool = False

    def surface(self, lag: FloatArray) -> FloatArray:
        """Return the power law of the surface itself at lags [samples]."""
        power: FloatArray = self.amplitude * np.abs(lag) ** self.exponent
        return power

    def seen(self, lag: FloatArray) -> FloatArray:
        """Return the structure function of what the instrument shows.

        Args:
            lag: [samples], any shape; 0 gives 0.
        """
        lag = np.abs(np.asarray(lag, dtype=np.float64))
        if self.psf_width > 0 and self.traced:
            shape = traced_power(lag, self.exponent, self.psf_width)
        elif self.psf_width > 0:
            shape = blurred_power(lag, self.exponent, self.psf_width, self.axes)
        elif self.band_limited:
            shape = band_limited_power(lag, self.exponent, self.axes)
        else:
            shape = lag**self.exponent
        if np.isfinite(self.corner):
            shape = rolled_off(shape, self.corner**self.exponent)
        seen: FloatArray = self.amplitude * shape + np.where(lag > 0, 2 * self.noise, 0)
        return _rounded(seen, self.quantum) if self.quantum > 0 else seen


def _rounded(value: FloatArray, quantum: float) -> FloatArray:
    """Return the structure function of heights that are read in steps.

    A Gaussian difference d of heights whose place between two steps is random turns
    into a whole number of steps with the mean square d^2 + q^2 f (1 - f), f being the
    fraction of |d| / q; the mean of f (1 - f) is a Fourier series.

    Args:
        value: S of the heights before [m^2], any shape.
        quantum: the step q [m], above 0.

    Source:
        Widrow and Kollar, Quantization Noise (2008), sec. 4 (characteristic function
        of a quantised Gaussian).
    """
    share = np.maximum(value, 0.0) / quantum**2
    order = np.arange(1.0, _ROUNDING_TERMS + 1)
    decay = np.exp(-2 * np.pi**2 * np.multiply.outer(share, order**2))
    fraction = 1 / 6 - np.sum(decay / (np.pi * order) ** 2, axis=-1)
    near = np.sqrt(2 * share / np.pi) - share  # all differences within one step
    added: FloatArray = np.where(share < _WITHIN_ONE_STEP, near, fraction)
    return value + quantum**2 * added


def rolled_off(shape: FloatArray, ceiling: float) -> FloatArray:
    """Return a structure function that follows `shape` and settles at `ceiling`.

    Source:
        ceiling (1 - exp(-S / ceiling)) is a structure function for every structure
        function S: Schoenberg, Ann. Math. 39 (1938) 811. For S = lag^s it is the
        self-affine surface of Sinha et al., Phys. Rev. B 38 (1988) 2297.
    """
    settled: FloatArray = -ceiling * np.expm1(-shape / ceiling)
    return settled


def blurred_power(
    lag: FloatArray, exponent: float, width: float, axes: int
) -> FloatArray:
    """Return the structure function lag^s after a Gaussian blur of the heights.

    The blur turns S into the mean of S over a Gaussian of sqrt(2) times the width,
    less the same mean at lag 0; the mean of |lag + g|^s is a Kummer function.

    Args:
        lag: [samples], not negative.
        exponent: s [-].
        width: standard deviation of the blur [samples], above 0.
        axes: 1 or 2 directions of blur; with 2 the surface is taken as isotropic.

    Source:
        Abramowitz and Stegun, 13.1.2 and 13.5.1 (far from the origin).
    """
    half = axes / 2
    at_zero = (2 * width) ** exponent * float(
        gamma_function(half + exponent / 2) / gamma_function(half)
    )
    argument = (lag / (2 * width)) ** 2
    near = argument < _ASYMPTOTIC_FROM
    mean = np.empty_like(lag)
    mean[near] = at_zero * hyp1f1(-exponent / 2, half, -argument[near])
    term = np.ones(int(np.count_nonzero(~near)))
    total = term.copy()
    for k in range(_ASYMPTOTIC_TERMS):
        factor = (k - exponent / 2) * (k + 1 - half - exponent / 2) / (k + 1)
        term = term * factor / argument[~near]
        total += term
    mean[~near] = lag[~near] ** exponent * total
    blurred: FloatArray = mean - at_zero
    return blurred


def tip_fall(exponent: float) -> float:
    """Return n of the transfer |K|^2 = (1 + (omega a)^2)^-n of a round tip's path.

    A parabola and a self-affine profile of one D have one length in common, the width
    of contact, so |K|^2 is one function of it for each D. The path has creases: far out
    its spectrum falls as omega^-4, n = (3 - s) / 2, but few data see so far. Fitted to
    the mean S of paths of tips of 1 to 5 um on profiles of D = 1.3, 1.5 and 1.7, with
    points eight times as dense as well, n = 1.3 / s leaves an error of D of 0.005 at
    most at 1.3 and 1.5 and 0.016 at 1.7; a Gaussian leaves up to 0.035, and five to a
    hundred times the squares. Tips many points wide (15 um here) see more of the fall.

    Args:
        exponent: s = 4 - 2D [-].
    """
    return _TIP_FALL / exponent


def tip_radius(seen: SeenSurface) -> float:
    """Return about which radius a tip must have for the blur of its path.

    Where two points are the width of contact apart, their heights differ by about as
    much as a parabola of the tip rises: on simulated paths the radius was 1.5, 2.1 and
    4.8 times contact^2 / height at D = 1.3, 1.5 and 1.7, for all tips alike.

    Args:
        seen: with a blur.

    Returns:
        Radius [samples^2 over the unit of heights], within a factor of two or so.
    """
    contact = seen.psf_width / np.sqrt(tip_fall(seen.exponent))
    height = np.sqrt(seen.amplitude * contact**seen.exponent)
    return float(2 * contact**2 / height)


def traced_power(lag: FloatArray, exponent: float, width: float) -> FloatArray:
    """Return the structure function lag^s of a profile on the path of a round tip.

    Args:
        lag: [samples], not negative.
        exponent: s [-].
        width: standard deviation of the Gaussian blur that takes as much from long
            waves [samples], above 0.

    Source:
        (1 + x)^-n is the mean of exp(-t x) over t with a gamma distribution of n: a
        mean over Gaussian blurs, taken here at even steps of ln t.
    """
    fall = tip_fall(exponent)
    ends = np.log(gammaincinv(fall, _TIP_TAILS))
    time = np.exp(np.linspace(ends[0], ends[1], _TIP_BLURS))
    weight = np.exp(fall * np.log(time / fall) - (time - fall))
    shape = np.zeros_like(lag)
    for share, t in zip(weight / weight.sum(), time / fall, strict=True):
        shape += share * blurred_power(lag, exponent, width * float(np.sqrt(t)), 1)
    return shape


def band_limited_power(lag: FloatArray, exponent: float, axes: int) -> FloatArray:
    """Return the structure function lag^s without wavelengths under two samples.

    Args:
        lag: [samples], not negative.
        exponent: s [-].
        axes: 1 where waves along the profile only are cut off; 2 where waves of an
            isotropic map are, along both directions of its grid.

    Source:
        S = integral of 2 P(f) (1 - cos 2 pi f lag) up to the Nyquist frequency with
        P ~ f^(-1-s); the missing tail is a generalised exponential integral,
        Abramowitz and Stegun, 5.1.22.
    """
    missing = np.zeros_like(lag)
    some = lag > 0
    angle = np.pi * lag[some]
    phase = np.asarray(-1j * angle, dtype=np.complex128)
    tail = np.real(_exponential_integral(1 + exponent, phase))
    missing[some] = np.pi**-exponent * (1 / exponent - tail)
    if axes > 1:
        missing += _missing_across(lag, exponent)
    limited: FloatArray = lag**exponent - missing / spectral_integral(exponent)
    return limited


def _missing_across(lag: FloatArray, exponent: float) -> FloatArray:
    """Return what a limit across a map takes from waves that run slantwise.

    A profile of an isotropic map sees the waves of all directions; of those that are
    slow along it, the ones too fast across it are missing. What is left of the power
    at the angular frequency q is a regularised incomplete beta function.
    """
    nodes, weights = np.polynomial.legendre.leggauss(_QUADRATURE_NODES)
    q = np.pi * (nodes + 1) / 2
    cosine_square = q**2 / (np.pi**2 + q**2)
    lost = betainc((1 + exponent) / 2, 0.5, cosine_square)
    density = np.pi / 2 * weights * lost * q ** (-1 - exponent)
    missing = np.full(lag.shape, float(density.sum()))
    near = lag < _QUADRATURE_LAGS
    missing[near] -= np.cos(np.outer(lag[near], q)) @ density
    return missing


def _exponential_integral(
    order: float, argument: NDArray[np.complex128]
) -> NDArray[np.complex128]:
    """Return E_order(argument) by its continued fraction, for |argument| > 3."""
    value = argument + order + 2 * _FRACTION_TERMS
    for k in range(_FRACTION_TERMS, 0, -1):
        value = argument + order + 2 * (k - 1) - k * (order + k - 1) / value
    result: NDArray[np.complex128] = np.exp(-argument) / value
    return result
