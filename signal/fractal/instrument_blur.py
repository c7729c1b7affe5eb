# SPDX-License-Identifier: MIT
"""Effect of blur, tip and band limit of an instrument on a structure function."""

from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.special import betainc, gammaincinv, hyp1f1
from scipy.special import gamma as gamma_function

from jointbench.acquisition.basics.arrays import FloatArray, read_only
from jointbench.signal.surface.structure_constant import spectral_integral

_ASYMPTOTIC_FROM = 40.0
"""Squared lag over 4 width^2 above which six terms give nine digits [-]."""
_ASYMPTOTIC_TERMS = 6
_QUADRATURE_NODES = 96
_QUADRATURE_LAGS = 60.0
"""Lag beyond which a cosine over the band averages out [samples]; the nodes resolve it
up to there."""
_TIP_FALL = 1.3
"""Times 1 / s: half the power by which a tip's path falls off [-], see `tip_fall`."""
_TIP_BLURS = 16
"""Gaussian blurs that represent the path of a tip: S within 2e-3 at all lags [-]."""
_TIP_TAILS = (1e-4, 1.0 - 1e-7)
"""Shares of them below the narrowest and the widest [-]."""
_FRACTION_TERMS = ((0.0, 60), (16.0, 12))
"""Depths of the continued fraction from these arguments on [-]: twelve digits from pi
upwards."""


def blurred_power(
    lag: FloatArray, exponent: float, width: float | FloatArray, axes: int
) -> FloatArray:
    """Return the structure function lag^s after a Gaussian blur of the heights.

    The blur turns S into the mean of S over a Gaussian of sqrt(2) times the width,
    less the same mean at lag 0; the mean of |lag + g|^s is a Kummer function.

    Args:
        lag: [samples], not negative.
        exponent: s [-].
        width: standard deviation of the blur [samples], above 0; an array broadcasts
            with `lag`.
        axes: 1 or 2 directions of blur; 2 assumes an isotropic surface.

    Source:
        Abramowitz and Stegun, 13.1.2 and 13.5.1 (far from the origin).
    """
    half = axes / 2
    at_zero = float(gamma_function(half + exponent / 2) / gamma_function(half))
    reach = lag / (2 * width)
    argument = reach**2
    near = argument < _ASYMPTOTIC_FROM
    mean = np.empty_like(argument)
    mean[near] = at_zero * hyp1f1(-exponent / 2, half, -argument[near])
    inverse = 1 / argument[~near]
    total = np.ones_like(inverse)
    for k in range(_ASYMPTOTIC_TERMS - 1, -1, -1):
        factor = (k - exponent / 2) * (k + 1 - half - exponent / 2) / (k + 1)
        total = 1 + factor * inverse * total
    mean[~near] = reach[~near] ** exponent * total
    blurred: FloatArray = (2 * width) ** exponent * (mean - at_zero)
    return blurred


def tip_fall(exponent: float) -> float:
    """Return n of the transfer |K|^2 = (1 + (omega a)^2)^-n of a round tip's path.

    A parabola and a self-affine profile of one D have one length in common, the width
    of contact, so |K|^2 is one function of it for each D. The path has creases: at high
    frequency its spectrum falls as omega^-4, n = (3 - s) / 2, but few data reach it.
    Fitted to the mean S of paths of tips of 1 to 5 um on profiles of D = 1.3, 1.5 and
    1.7, with points eight times as dense as well, n = 1.3 / s leaves an error of D of
    0.005 at most at 1.3 and 1.5 and 0.016 at 1.7; a Gaussian leaves up to 0.035, and
    five to a hundred times the sum of squares. Tips many points wide (15 um here) show
    more of the fall.

    Args:
        exponent: s = 4 - 2D [-].
    """
    return _TIP_FALL / exponent


def traced_power(lag: FloatArray, exponent: float, width: float) -> FloatArray:
    """Return the structure function lag^s of a profile on the path of a round tip.

    Args:
        lag: [samples], not negative.
        exponent: s [-].
        width: standard deviation of the Gaussian blur with the same effect on long
            waves [samples], above 0.

    Source:
        (1 + x)^-n is the mean of exp(-t x) over t with a gamma distribution of n: a
        mean over Gaussian blurs, taken here at even steps of ln t.
    """
    fall = tip_fall(exponent)
    ends = np.log(gammaincinv(fall, _TIP_TAILS))
    time = np.exp(np.linspace(ends[0], ends[1], _TIP_BLURS))
    weight = np.exp(fall * np.log(time / fall) - (time - fall))
    widths = width * np.sqrt(time / fall)
    blurred = blurred_power(lag, exponent, widths[(...,) + (None,) * lag.ndim], 1)
    shape: FloatArray = np.tensordot(weight / weight.sum(), blurred, axes=1)
    return shape


def band_limited_power(lag: FloatArray, exponent: float, axes: int) -> FloatArray:
    """Return the structure function lag^s without wavelengths under two samples.

    Args:
        lag: [samples], not negative.
        exponent: s [-].
        axes: 1 if only waves along the profile are cut off; 2 for an isotropic map,
            along both directions of its grid.

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
    """Return the loss of oblique waves by a band limit across a map.

    A profile of an isotropic map contains the waves of all directions; of those that
    are slow along it, the ones too fast across it are missing. The remaining share of
    the power at the angular frequency q is a regularised incomplete beta function.
    """
    nodes, weights = _quadrature()
    q = np.pi * (nodes + 1) / 2
    cosine_square = q**2 / (np.pi**2 + q**2)
    lost = betainc((1 + exponent) / 2, 0.5, cosine_square)
    density = np.pi / 2 * weights * lost * q ** (-1 - exponent)
    missing = np.full(lag.shape, float(density.sum()))
    near = lag < _QUADRATURE_LAGS
    missing[near] -= np.cos(np.outer(lag[near], q)) @ density
    return missing


@cache
def _quadrature() -> tuple[FloatArray, FloatArray]:
    """Return nodes and weights between -1 and 1; finding them takes a millisecond."""
    nodes, weights = np.polynomial.legendre.leggauss(_QUADRATURE_NODES)
    return read_only(nodes), read_only(weights)


def _exponential_integral(
    order: float, argument: NDArray[np.complex128]
) -> NDArray[np.complex128]:
    """Return E_order(argument) by its continued fraction, for |argument| > 3."""
    result = np.exp(-argument)
    size = np.abs(argument)
    ends = [*(first for first, _ in _FRACTION_TERMS[1:]), np.inf]
    for (first, terms), end in zip(_FRACTION_TERMS, ends, strict=True):
        part = (size >= first) & (size < end)
        own = argument[part]
        value = own + order + 2 * terms
        for k in range(terms, 0, -1):
            value = own + order + 2 * (k - 1) - k * (order + k - 1) / value
        result[part] /= value
    return result
