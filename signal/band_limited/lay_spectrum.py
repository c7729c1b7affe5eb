# SPDX-License-Identifier: MIT
"""Spectrum of a band-limited self-affine surface with a lay, over two wavenumbers."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import gamma

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.signal.band_limited.matern_spectrum import BandLimited
from jointbench.signal.fractal.instrument_blur import tip_fall


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

    @property
    def powers(self) -> tuple[float, float]:
        """Powers of the wavenumbers along the lay and across it [-]."""
        return 2 / (1 + self.skew), 2 / (1 - self.skew)

    @property
    def far(self) -> float:
        """Square of the pivot over the roll-off's wavenumber [-]."""
        return float((self.pivot * self.roll_off / (2 * np.pi)) ** 2)

    def parts(
        self, x: FloatArray, y: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Return wavenumbers and parts of the density's sum along and across the lay.

        Args:
            x: along the rows [rad/sample], any shape.
            y: down the columns [rad/sample], same shape.

        Returns:
            u and v over the pivot, with their signs, and |u / q_u|^(2 / (1 + e)) and
            |v / q_v|^(2 / (1 - e)).
        """
        turn = math.cos(self.angle) / self.pivot
        lift = math.sin(self.angle) / self.pivot
        u, v = x * turn + y * lift, y * turn - x * lift
        if self.skew == 0:
            along, across = np.square(u), np.square(v)
        else:
            first, second = self.powers
            along, across = np.abs(u) ** first, np.abs(v) ** second
        along *= self.far * self.ratio
        across *= self.far / self.ratio
        return u, v, along, across

    def surface(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return the density of the surface itself, at any wavenumbers.

        Args:
            x: along the rows [rad/sample], any shape.
            y: down the columns [rad/sample], same shape.
        """
        _, _, along, across = self.parts(x, y)
        middle = 1 + 0.5 * self.far * (self.ratio + 1 / self.ratio)
        density: FloatArray = (middle / (1 + along + across)) ** (1 + self.hurst)
        density *= self.level
        return density

    def short_cut(self, square: FloatArray, *, tip: bool) -> FloatArray:
        """Return the power that the short cut leaves, of a tip's path or a Gaussian.

        Args:
            square: of the wavenumber [rad^2/sample^2], any shape.
            tip: whether it is the path of a round tip, or a Gaussian.
        """
        return np.exp(self.log_short_cut(square, tip=tip))

    def log_short_cut(self, square: FloatArray, *, tip: bool) -> FloatArray:
        """Return ln of the power that the short cut leaves, see `short_cut`."""
        if not tip:
            left: FloatArray = -self.blur * square
            return left
        fall = tip_fall(2 * self.hurst)
        traced: FloatArray = -fall * np.log1p(self.blur / fall * square)
        return traced


def line_of(model: LaySpectrum) -> BandLimited:
    """Return the spectrum of lines of a surface without its lay.

    The integral of (1 + (u^2 + v^2) / q_r^2)^(-1-H) over v; a lay is left out, its
    level is that of the mean of both directions.
    """
    corner = (2 * np.pi / model.roll_off) ** 2 + model.pivot**2
    share = np.sqrt(np.pi) * gamma(model.hurst + 0.5) / gamma(model.hurst + 1)
    return BandLimited(
        level=float(model.level * np.sqrt(corner) * share),
        pivot=model.pivot,
        hurst=model.hurst,
        roll_off=model.roll_off,
        blur=model.blur,
        noise=model.noise,
    )
