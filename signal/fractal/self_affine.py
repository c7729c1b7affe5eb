# SPDX-License-Identifier: MIT
"""Structure function of a self-affine profile as an instrument measures it."""

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.signal.fractal.instrument_blur import (
    band_limited_power,
    blurred_power,
    tip_fall,
    traced_power,
)

TIP_TOLERANCE = 0.01
"""Relative error of `traced_power` for S of the mean path of simulated tips [-]."""
_ROUNDING_TERMS = 6
_WITHIN_ONE_STEP = 0.05
"""S over the square of the step below which no difference exceeds one step [-]."""

_MANY_STEPS = 2.0
"""S over the square of the step above which the series is 1/6 to the last digit [-]."""


class InstrumentModel(StrEnum):
    """Effects of the instrument, from the simplest model upward."""

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
        return self in _WITH_NOISE

    @property
    def has_psf(self) -> bool:
        """Whether the width of a blur is among the parameters."""
        return self in _WITH_PSF

    @property
    def is_traced(self) -> bool:
        """Whether the blur is that of a round tip's path."""
        return self in _TRACED


_WITH_NOISE = frozenset(
    (
        InstrumentModel.NOISE,
        InstrumentModel.PSF_AND_NOISE,
        InstrumentModel.STYLUS_AND_NOISE,
    )
)
_TRACED = frozenset((InstrumentModel.STYLUS, InstrumentModel.STYLUS_AND_NOISE))
_WITH_PSF = _TRACED | {InstrumentModel.PSF, InstrumentModel.PSF_AND_NOISE}


@dataclass(frozen=True, slots=True)
class SeenSurface:
    """A self-affine surface and the instrument that measures it.

    Lengths are in samples, heights in any one unit.

    Attributes:
        exponent: s = 4 - 2D of the surface [-].
        amplitude: structure function of the surface itself at a lag of one sample.
        noise: variance of white noise of each height.
        psf_width: standard deviation of the Gaussian point spread [samples]; for a tip
            that of the Gaussian with the same effect on long waves.
        axes: 1 if blur and limit act along the profile only, 2 if in all directions on
            an isotropic map.
        band_limited: whether wavelengths under two samples are cut off sharply.
        corner: lag at which S of the surface levels off [samples].
        quantum: quantisation step of the heights; 0 for none.
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
        """Return the structure function that the instrument measures.

        Args:
            lag: [samples], any shape; 0 gives 0.
        """
        lag = np.abs(np.asarray(lag, dtype=np.float64))
        return self.seen_of(lag, form_of(lag, self.form))

    @property
    def form(self) -> "SeenForm":
        """What the form of the structure function depends on."""
        return (
            self.exponent,
            self.psf_width,
            self.axes,
            self.band_limited,
            self.traced,
        )

    def seen_of(self, lag: FloatArray, shape: FloatArray) -> FloatArray:
        """Return the structure function of a form.

        Args:
            lag: [samples], not negative, any shape.
            shape: the form at these lags, see `form_of`.
        """
        if self.corner < math.inf:
            shape = rolled_off(shape, self.corner**self.exponent)
        seen: FloatArray = self.amplitude * shape + np.where(lag > 0, 2 * self.noise, 0)
        return _rounded(seen, self.quantum) if self.quantum > 0 else seen


SeenForm = tuple[float, float, int, bool, bool]
"""Exponent, width of the blur, axes, band limit, path of a tip; see `SeenSurface`."""


def form_of(lag: FloatArray, form: SeenForm) -> FloatArray:
    """Return the structure function of a surface of amplitude 1 without noise.

    Args:
        lag: [samples], not negative, any shape.
        form: what it depends on.
    """
    exponent, width, axes, band_limited, traced = form
    if width > 0 and traced:
        return traced_power(lag, exponent, width)
    if width > 0:
        return blurred_power(lag, exponent, width, axes)
    if band_limited:
        return band_limited_power(lag, exponent, axes)
    return np.asarray(lag**exponent)


def _rounded(value: FloatArray, quantum: float) -> FloatArray:
    """Return the structure function of quantised heights.

    A Gaussian difference d of heights at a random position between two steps becomes a
    whole number of steps with the mean square d^2 + q^2 f (1 - f), where f is the
    fractional part of |d| / q; the mean of f (1 - f) is a Fourier series.

    Args:
        value: S of the heights before [m^2], any shape.
        quantum: the step q [m], above 0.

    Source:
        Widrow and Kollar, Quantization Noise (2008), sec. 4 (characteristic function
        of a quantised Gaussian).
    """
    share = np.maximum(value, 0.0) / quantum**2
    added = np.full(share.shape, 1 / 6)
    few = share < _MANY_STEPS
    if few.any():
        added[few] = _fraction(share[few])
    return np.asarray(value + quantum**2 * added)


def _fraction(share: FloatArray) -> FloatArray:
    """Return the mean of f (1 - f) for S over the square of the step."""
    order = np.arange(1.0, _ROUNDING_TERMS + 1)
    decay = np.exp(-2 * np.pi**2 * np.multiply.outer(share, order**2))
    fraction = 1 / 6 - np.sum(decay / (np.pi * order) ** 2, axis=-1)
    near = np.sqrt(2 * share / np.pi) - share  # all differences within one step
    return np.where(share < _WITHIN_ONE_STEP, near, fraction)


def rolled_off(shape: FloatArray, ceiling: float) -> FloatArray:
    """Return a structure function that follows `shape` and levels off at `ceiling`.

    Source:
        ceiling (1 - exp(-S / ceiling)) is a structure function for every structure
        function S: Schoenberg, Ann. Math. 39 (1938) 811. For S = lag^s it is the
        self-affine surface of Sinha et al., Phys. Rev. B 38 (1988) 2297.
    """
    settled: FloatArray = -ceiling * np.expm1(-shape / ceiling)
    return settled


def tip_radius(seen: SeenSurface) -> float:
    """Estimate the radius of the tip from the blur of its path.

    Where two points are the width of contact apart, their height difference is about
    the rise of a parabolic tip: on simulated paths the radius was 1.5, 2.1 and 4.8
    times contact^2 / height at D = 1.3, 1.5 and 1.7, for all tips.

    Args:
        seen: with a blur.

    Returns:
        Radius [samples^2 over the unit of heights], within a factor of about two.
    """
    contact = seen.psf_width / np.sqrt(tip_fall(seen.exponent))
    height = np.sqrt(seen.amplitude * contact**seen.exponent)
    return float(2 * contact**2 / height)
