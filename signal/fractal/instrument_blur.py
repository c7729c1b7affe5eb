# SPDX-License-Identifier: MIT
"""FormEffect of blur, tip and band limit of an instrument on a structure function."""

from functools import cache, lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.special import betainc

from jointbench.acquisition.basics.arrays import FloatArray, read_only
from jointbench.signal.fractal.seen_forms import (
    LIMIT_RANGE,
    TIP_FALL,
    FormEffect,
    fill_form,
)
from jointbench.signal.surface.structure_constant import spectral_integral

_QUADRATURE_NODES = 96
_QUADRATURE_LAGS = 60.0
"""Lag beyond which a cosine over the band averages out [samples]; the nodes resolve it
up to there."""
_LIMIT_NODES = 24
"""Nodes of the table of a sharp band limit: ten digits [-]."""
_KEPT_LAGS = 16
"""Sets of lags whose table is kept [-]."""
_FRACTION_TERMS = ((0.0, 60), (16.0, 12))
"""Depths of the continued fraction from these arguments on [-]: twelve digits from pi
upwards."""


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
        axes: 1 or 2 directions of blur; 2 assumes an isotropic surface.

    Source:
        Abramowitz and Stegun, 13.1.2 and 13.5.1 (far from the origin).
    """
    return _form(lag, exponent, width, axes, FormEffect.BLUR)


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
    return TIP_FALL / exponent


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
    return _form(lag, exponent, width, 1, FormEffect.TIP)


def plain_power(lag: FloatArray, exponent: float) -> FloatArray:
    """Return the structure function lag^s itself, at lags that are not negative."""
    return _form(lag, exponent, 0.0, 1, FormEffect.NONE)


def _form(
    lag: FloatArray, exponent: float, width: float, axes: int, effect: FormEffect
) -> FloatArray:
    """Return a form of `seen_forms` at lags of any shape."""
    flat = np.array(lag, dtype=np.float64).ravel()
    form = np.empty(flat.size)
    fill_form(flat, exponent, width, axes, int(effect), form)
    return form.reshape(np.shape(lag))


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
    limited = np.zeros_like(lag)
    some = lag > 0
    limited[some] = _limited(lag[some], np.array([[exponent]]), axes)[0]
    return limited


@lru_cache(maxsize=_KEPT_LAGS)
def limited_table(lags: tuple[float, ...], axes: int) -> FloatArray:
    """Return the form of a band limit over lag^s as Chebyshev coefficients over s.

    Args:
        lags: above 0 [samples].
        axes: 1 or 2 directions of the limit.

    Returns:
        Coefficients over `LIMIT_RANGE`, shape (n_coefficients, n_lags), read-only.
    """
    lag = np.array(lags)
    place = np.cos(np.pi * (np.arange(_LIMIT_NODES) + 0.5) / _LIMIT_NODES)
    low, high = LIMIT_RANGE
    exponent = 0.5 * (low + high + (high - low) * place[:, None])
    share = _limited(lag, exponent, axes) / lag**exponent
    found = np.polynomial.chebyshev.chebfit(place, share, _LIMIT_NODES - 1)
    return read_only(np.ascontiguousarray(found))


def _limited(lag: FloatArray, exponent: FloatArray, axes: int) -> FloatArray:
    """Return `band_limited_power` at lags above 0, shape (n_exponents, n_lags).

    Args:
        lag: shape (n_lags,).
        exponent: shape (n_exponents, 1).
        axes: 1 or 2.
    """
    angle = np.pi * lag
    phase = np.asarray(-1j * angle, dtype=np.complex128)
    tail = np.real(_exponential_integral(1 + exponent, phase))
    missing = np.pi**-exponent * (1 / exponent - tail)
    if axes > 1:
        missing += _missing_across(lag, exponent)
    integral = np.array([[spectral_integral(float(s))] for s in exponent[:, 0]])
    limited: FloatArray = lag**exponent - missing / integral
    return limited


def _missing_across(lag: FloatArray, exponent: FloatArray) -> FloatArray:
    """Return the loss of oblique waves by a band limit across a map.

    A profile of an isotropic map contains the waves of all directions; of those that
    are slow along it, the ones too fast across it are missing. The remaining share of
    the power at the angular frequency q is a regularised incomplete beta function.
    Shapes are those of `_limited`.
    """
    nodes, weights = _quadrature()
    q = np.pi * (nodes + 1) / 2
    cosine_square = q**2 / (np.pi**2 + q**2)
    lost = betainc((1 + exponent) / 2, 0.5, cosine_square)
    density = np.pi / 2 * weights * lost * q ** (-1 - exponent)
    missing = np.tile(density.sum(axis=1, keepdims=True), (1, lag.size))
    near = lag < _QUADRATURE_LAGS
    missing[:, near] -= density @ np.cos(np.outer(q, lag[near]))
    return missing


@cache
def _quadrature() -> tuple[FloatArray, FloatArray]:
    """Return nodes and weights between -1 and 1; finding them takes a millisecond."""
    nodes, weights = np.polynomial.legendre.leggauss(_QUADRATURE_NODES)
    return read_only(nodes), read_only(weights)


def _exponential_integral(
    order: FloatArray, argument: NDArray[np.complex128]
) -> NDArray[np.complex128]:
    """Return E_order(argument) by its continued fraction, for |argument| > 3.

    Args:
        order: shape (n_orders, 1).
        argument: shape (n_arguments,).
    """
    result = np.tile(np.exp(-argument), (order.size, 1))
    size = np.abs(argument)
    ends = [*(first for first, _ in _FRACTION_TERMS[1:]), np.inf]
    for (first, terms), end in zip(_FRACTION_TERMS, ends, strict=True):
        part = (size >= first) & (size < end)
        own = argument[part]
        value = own + order + 2 * terms
        for k in range(terms, 0, -1):
            value = own + order + 2 * (k - 1) - k * (order + k - 1) / value
        result[:, part] /= value
    return result
