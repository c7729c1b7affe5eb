# SPDX-License-Identifier: MIT
"""A rough surface that is cut, with a finer finish on the cuts: spectrum and skewness.

Heights are the lower of two independent Gaussian processes, z = min(x, y): of the rough
one x of variance v, and of the finish y of variance w about a level. With u = x - y and
its standardised level a the derivatives of z by x and y are steps of u, so that Price's
theorem gives the covariance of z in closed form from those of x and y:

    C_z = p C_x + q C_y + (v + w) (D(R) - D(0)),   R = (C_x + C_y) / (v + w)

with p = Phi(a) the share of valleys, q = 1 - p that of plateaus, and D the mean product
of what both points lose (`corner_product`). The spectrum of its last term is that of
the corners of the cut.
"""

from dataclasses import dataclass

import numpy as np
from scipy.fft import fht
from scipy.special import gamma, ndtr

from jointbench.acquisition.basics.arrays import FloatArray, freeze
from jointbench.signal.band_limited.matern_spectrum import BandLimited

_COUNT = 512
"""Lags and wavenumbers of the table."""
_STEP = 0.08
"""Step of their logarithms: correlations change over a unit."""
_DECAYED = 100.0
"""Lag over its length beyond which a correlation is nothing [-]."""
_ORDER = -0.5
"""Order of the Hankel transform that is a cosine transform."""
_PLACE = _STEP * (np.arange(_COUNT) - (_COUNT - 1) / 2)
_LAG = np.exp(_PLACE)
"""Lags over the correlation length of the rough process [-], shape (_COUNT,)."""
_WAVE = np.exp(_PLACE)
"""Wavenumbers times that length [-], same shape."""
_SPREAD = np.exp(np.arange(2 * _PLACE[0] - 4.0, 3.8, 0.7))
"""Squared widths of the bells whose sum a correlation is, over four times the squared
correlation length [-]: the trapezoidal rule over their logarithm is exact to 1e-6."""
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(12)
_FADE = np.exp(-0.5 * _LAG**2)
_FADE_WAVES = np.exp(-0.5 * _WAVE**2) / np.sqrt(2 * np.pi)
"""A bell of lags, and its density: it takes out what is constant at short lags."""


@dataclass(frozen=True, slots=True, eq=False)
class CutSurface:
    """The lower of two Gaussian processes.

    Attributes:
        omega: ascending [rad/sample], shape (n,).
        log_density: ln of the two-sided density, same shape.
        skewness: of the heights [-].

    Source:
        Malburg, Raja and Whitehouse 1993, CIRP Ann. 42, 637: plateau honing as two
        processes; ISO 21920-2:2021 has their rms as Rvq and Rpq.
    """

    omega: FloatArray
    log_density: FloatArray
    skewness: float

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "omega", "log_density")

    def surface(self, omega: FloatArray) -> FloatArray:
        """Return the two-sided density, at any wavenumber [rad/sample]."""
        at = np.log(np.maximum(omega, self.omega[0]))
        return np.asarray(np.exp(np.interp(at, np.log(self.omega), self.log_density)))


def cut_surface(rough: BandLimited, finish: BandLimited, level: float) -> CutSurface:
    """Return the lower of a rough process and a finish about a level.

    Args:
        rough: with a roll-off, and a short cut as its blur.
        finish: with a roll-off.
        level: mean of the finish over that of the rough process, in its sd [-].

    Source:
        Price 1958, IRE Trans. Inf. Theory 4, 69; the transform by Hamilton 2000, Mon.
        Not. R. Astron. Soc. 312, 257, in `scipy.fft.fht`.
    """
    corner = 2 * np.pi / rough.roll_off
    own, other = correlation_bells(rough), correlation_bells(finish)
    total = own.variance + other.variance
    share = own.variance / total
    at = level * float(np.sqrt(share))
    ratio = rough.roll_off / finish.roll_off
    loss = share * own.missing(_LAG) + (1 - share) * other.missing(_LAG * ratio)
    far = float(corner_product(np.ones(1), at)[0])
    lags = corner_product(loss, at) - far * (1 - _FADE)
    waves = _cosine_transform(lags, 3 * min(rough.hurst, finish.hurst))
    waves -= far * _FADE_WAVES
    omega = _WAVE * corner
    valleys = float(ndtr(at))
    density = valleys * rough.surface(omega) * rough.short_cut(omega, tip=False)
    density += (1 - valleys) * finish.surface(omega) + total / corner * waves
    return CutSurface(
        omega,
        np.log(np.maximum(density, np.finfo(float).tiny)),
        _skewness(share, at),
    )


@dataclass(frozen=True, slots=True, eq=False)
class CorrelationBells:
    """The correlation of a process with roll-off and short cut, as a sum of bells.

    A density (c^2 + q^2)^(-H - 1/2) exp(-b q^2) is that of Gaussian ones of all widths:
    int t^(H - 1/2) exp(-t c^2 - (t + b) q^2) dt / Gamma(H + 1/2).

    Attributes:
        variance: of the process.
        width: (t + b) c^2 of each bell [-], shape (n_bells,).
        weight: its share of the variance [-], same shape.
    """

    variance: float
    width: FloatArray
    weight: FloatArray

    def missing(self, lag: FloatArray) -> FloatArray:
        """Return 1 - the correlation at ascending lags over its length, (n,)."""
        found, near = np.ones(lag.size), lag[lag < _DECAYED]
        bells = -np.expm1(-np.multiply.outer(0.25 * near**2, 1 / self.width))
        found[: near.size] = bells @ self.weight
        return found


def correlation_bells(process: BandLimited) -> CorrelationBells:
    """Return the bells of a process.

    Args:
        process: with a roll-off; its short cut is its blur.
    """
    corner, power = 2 * np.pi / process.roll_off, process.hurst + 0.5
    width = _SPREAD + process.blur * corner**2
    weight = _SPREAD**power * np.exp(-_SPREAD) * np.sqrt(np.pi / width)
    weight *= np.log(_SPREAD[1] / _SPREAD[0]) / gamma(power)
    total = float(weight.sum())
    level = float(process.surface(np.zeros(1))[0])
    return CorrelationBells(total * corner * level, width, weight / total)


def corner_product(loss: FloatArray, level: float) -> FloatArray:
    """Return D = int_R^1 (r - R) phi_2(a, a; r) dr, with phi_2 the normal density.

    Args:
        loss: 1 - R [-], shape (n,).
        level: a [-].
    """
    # r = cos(angle): the density of two normal values has no singular point then.
    end = 2 * np.arcsin(np.sqrt(0.5 * np.clip(loss, 0.0, 2.0)))
    angle = 0.5 * np.multiply.outer(end, _NODES + 1)
    weight = np.exp(-(level**2) / (1 + np.cos(angle))) / (4 * np.pi)
    # cos(angle) - cos(end) without cancellation.
    rise = (
        2 * np.sin(0.5 * (end[:, None] + angle)) * np.sin(0.5 * (end[:, None] - angle))
    )
    return np.asarray(end * ((rise * weight) @ _WEIGHTS))


def _cosine_transform(lags: FloatArray, power: float) -> FloatArray:
    """Return (1/pi) int f(x) cos(k x) dx over the table's lags, shape (_COUNT,).

    Args:
        lags: f, shape (_COUNT,).
        power: of x in f at short lags [-].
    """
    # Half of that power is taken out: what is left falls off at both ends of the
    # table, and so does the error of the transform at high wavenumbers.
    even = fht(lags * np.sqrt(_LAG), _STEP, mu=_ORDER, bias=0.5 + 0.5 * power)
    return np.asarray(even / np.sqrt(2 * np.pi * _WAVE))


def _skewness(share: float, level: float) -> float:
    """Return the skewness of the lower of two normal values.

    Args:
        share: of the first one in the variance of their difference [-].
        level: mean of the second less that of the first, over the sd of it [-].
    """
    # z = g(u) + rest with u = (x - y) / sd of mean -a, and the rest independent of it.
    density, below = np.exp(-0.5 * level**2) / np.sqrt(2 * np.pi), float(ndtr(level))
    above = 1 - below
    # Moments of v = u + a over v > a, and over v < a.
    high = np.array([above, density, above + level * density, (level**2 + 2) * density])
    low = np.array(
        [below, -density, below - level * density, -(level**2 + 2) * density]
    )
    rest = share * (1 - share)
    # z - mean = slope * v + offset on each side, beside the rest.
    mean = share * low[1] + (share - 1) * high[1] + level * high[0]
    sides = ((share, -mean, low), (share - 1, level - mean, high))
    second = sum(a**2 * m[2] + 2 * a * b * m[1] + b**2 * m[0] for a, b, m in sides)
    third = sum(
        a**3 * m[3] + 3 * a**2 * b * m[2] + 3 * a * b**2 * m[1] + b**3 * m[0]
        for a, b, m in sides
    )
    return float(third / (second + rest) ** 1.5)
