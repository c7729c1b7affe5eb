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
    plain_power,
    tip_fall,
    traced_power,
)
from jointbench.signal.fractal.seen_forms import round_all

TIP_TOLERANCE = 0.01
"""Relative error of `traced_power` for S of the mean path of simulated tips [-]."""


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
        shape = self._form(lag)
        if self.corner < math.inf:
            shape = rolled_off(shape, self.corner**self.exponent)
        seen: FloatArray = self.amplitude * shape + np.where(lag > 0, 2 * self.noise, 0)
        if self.quantum > 0:
            flat = seen.ravel()
            round_all(flat, self.quantum)
            seen = flat.reshape(seen.shape)
        return seen

    def _form(self, lag: FloatArray) -> FloatArray:
        """Return the structure function of amplitude 1 without noise and corner."""
        if self.psf_width > 0 and self.traced:
            return traced_power(lag, self.exponent, self.psf_width)
        if self.psf_width > 0:
            return blurred_power(lag, self.exponent, self.psf_width, self.axes)
        if self.band_limited:
            return band_limited_power(lag, self.exponent, self.axes)
        return plain_power(lag, self.exponent)


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
