# SPDX-License-Identifier: MIT
"""Structure function of a seen surface at many lags, compiled.

A search looks at it thousands of times at few lags, a covariance at thousands of lags.
"""

import math
from enum import IntEnum

import numpy as np
from scipy.special import gammaincinv

from jointbench.acquisition.basics.arrays import FloatArray, read_only
from jointbench.acquisition.basics.compiled import compiled

LIMIT_RANGE = (0.0, 2.0)
"""Exponents s over which the form of a sharp band limit is tabulated [-]."""
TIP_FALL = 1.3
"""Times 1 / s: half the power by which a tip's path falls off [-], see
`instrument_blur.tip_fall`."""
_ASYMPTOTIC_FROM = 40.0
"""Squared lag over 4 width^2 above which six terms give nine digits [-]."""
_ASYMPTOTIC_TERMS = 6
_MOST_TERMS = 400
"""Most terms of a power series; 120 are used at its end [-]."""
_NEAR = 1.0
"""Squared lag over 4 width^2 below which the series has no cancellation [-]."""
_TIP_BLURS = 16
"""Gaussian blurs that represent the path of a tip: S within 2e-3 at all lags [-]."""
_TIP_TAILS = (1e-4, 1.0 - 1e-7)
"""Shares of them below the narrowest and the widest [-]."""
_TIP_EXPONENTS = (0.015, 2.0)
"""Exponents s over which the ends of these blurs are tabulated [-]."""
_TIP_NODES = 32
"""Nodes of the table: eight digits of the ends [-]."""
_ROUNDING_TERMS = 6
_WITHIN_ONE_STEP = 0.05
"""S over the square of the step below which no difference exceeds one step [-]."""
_MANY_STEPS = 2.0
"""S over the square of the step above which the series is 1/6 to the last digit [-]."""


class FormEffect(IntEnum):
    """What acts on the power law."""

    NONE = 0
    BLUR = 1
    TIP = 2
    LIMIT = 3


def _tip_table() -> FloatArray:
    """Return Chebyshev coefficients of ln of both ends over ln s, shape (n, 2)."""
    low, high = np.log(_TIP_EXPONENTS)
    place = np.cos(np.pi * (np.arange(_TIP_NODES) + 0.5) / _TIP_NODES)
    exponent = np.exp(0.5 * (low + high + (high - low) * place))
    ends = np.log(gammaincinv(TIP_FALL / exponent[:, None], _TIP_TAILS))
    found = np.polynomial.chebyshev.chebfit(place, ends, _TIP_NODES - 1)
    return read_only(np.ascontiguousarray(found))


_TIP_ENDS = _tip_table()


@compiled()
def chebyshev(table: FloatArray, column: int, place: float) -> float:
    """Return a sum of Chebyshev polynomials by Clenshaw's recurrence.

    Args:
        table: coefficients, shape (n, n_columns).
        column: of the table.
        place: between -1 and 1.
    """
    one, two = 0.0, 0.0
    for k in range(table.shape[0] - 1, 0, -1):
        one, two = table[k, column] + 2 * place * one - two, one
    return float(table[0, column] + place * one - two)


@compiled()
def _mean_less_one(exponent: float, half: float, x: float) -> float:
    """Return Kummer's M(-s/2; half; -x) - 1, for x below the asymptotic range."""
    total = 0.0
    if x < _NEAR:
        term = 1.0
        for k in range(_MOST_TERMS):
            term *= -(k - 0.5 * exponent) * x / ((half + k) * (k + 1))
            total += term
            if abs(term) < 1e-17 * abs(total) or term == 0:
                break
        return total
    # By Kummer's transformation all terms are positive.
    term, total = 1.0, 1.0
    for k in range(_MOST_TERMS):
        term *= (half + 0.5 * exponent + k) * x / ((half + k) * (k + 1))
        total += term
        if term < 1e-17 * total:
            break
    return math.exp(-x) * total - 1.0


@compiled()
def _add_blurred(
    lag: FloatArray,
    exponent: float,
    width: float,
    axes: int,
    factor: float,
    form: FloatArray,
) -> None:
    """Add lag^s after a Gaussian blur, see `instrument_blur.blurred_power`."""
    half = 0.5 * axes
    at_zero = math.gamma(half + exponent / 2) / math.gamma(half)
    factors = np.empty(_ASYMPTOTIC_TERMS)
    for k in range(_ASYMPTOTIC_TERMS):
        factors[k] = (k - exponent / 2) * (k + 1 - half - exponent / 2) / (k + 1)
    scale = factor * (2 * width) ** exponent
    for i in range(lag.size):
        reach = lag[i] / (2 * width)
        x = reach * reach
        if x < _ASYMPTOTIC_FROM:
            form[i] += scale * at_zero * _mean_less_one(exponent, half, x)
            continue
        inverse, total = 1 / x, 1.0
        for k in range(_ASYMPTOTIC_TERMS - 1, -1, -1):
            total = 1 + factors[k] * inverse * total
        form[i] += scale * (reach**exponent * total - at_zero)


@compiled()
def fill_form(
    lag: FloatArray,
    exponent: float,
    width: float,
    axes: int,
    effect: int,
    form: FloatArray,
) -> None:
    """Fill in the structure function of amplitude 1 without noise.

    Args:
        lag: [samples], not negative, shape (n,).
        exponent: s [-].
        width: standard deviation of the blur [samples].
        axes: directions of the blur.
        effect: `FormEffect`, but for a band limit, which is tabulated.
        form: filled, shape (n,).
    """
    if effect == FormEffect.BLUR:
        form[:] = 0.0
        _add_blurred(lag, exponent, width, axes, 1.0, form)
    elif effect == FormEffect.TIP:
        _fill_traced(lag, exponent, width, form)
    else:
        for i in range(lag.size):
            form[i] = lag[i] ** exponent


@compiled()
def _fill_traced(
    lag: FloatArray, exponent: float, width: float, form: FloatArray
) -> None:
    """Fill in the form on the path of a tip, see `instrument_blur.traced_power`."""
    fall = TIP_FALL / exponent
    low, high = math.log(_TIP_EXPONENTS[0]), math.log(_TIP_EXPONENTS[1])
    place = (2 * math.log(exponent) - low - high) / (high - low)
    first = chebyshev(_TIP_ENDS, 0, place)
    step = (chebyshev(_TIP_ENDS, 1, place) - first) / (_TIP_BLURS - 1)
    whole = 0.0
    form[:] = 0.0
    for k in range(_TIP_BLURS):
        time = math.exp(first + k * step)
        weight = math.exp(fall * math.log(time / fall) - (time - fall))
        whole += weight
        _add_blurred(lag, exponent, width * math.sqrt(time / fall), 1, weight, form)
    form /= whole


@compiled()
def rolled(value: float, ceiling: float) -> float:
    """Return a value of a structure function that levels off at a ceiling."""
    return -ceiling * math.expm1(-value / ceiling)


@compiled()
def rounded(value: float, quantum: float) -> float:
    """Return a value of the structure function of quantised heights.

    A Gaussian difference d of heights at a random position between two steps becomes a
    whole number of steps with the mean square d^2 + q^2 f (1 - f), where f is the
    fractional part of |d| / q; the mean of f (1 - f) is a Fourier series.

    Args:
        value: S of the heights before [m^2].
        quantum: the step q [m], above 0.

    Source:
        Widrow and Kollar, Quantization Noise (2008), sec. 4 (characteristic function
        of a quantised Gaussian).
    """
    share = max(value, 0.0) / quantum**2
    added = 1 / 6
    if share < _WITHIN_ONE_STEP:  # all differences within one step
        added = math.sqrt(2 * share / math.pi) - share
    elif share < _MANY_STEPS:
        for k in range(1, _ROUNDING_TERMS + 1):
            decay = math.exp(-2 * math.pi**2 * share * k**2)
            added -= decay / (math.pi * k) ** 2
    return value + quantum**2 * added


@compiled()
def round_all(values: FloatArray, quantum: float) -> None:
    """Replace values of a structure function by those of quantised heights."""
    for i in range(values.size):
        values[i] = rounded(values[i], quantum)
