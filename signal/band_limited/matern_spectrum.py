# SPDX-License-Identifier: MIT
"""Spectrum of a band-limited self-affine surface along a line."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.signal.band_limited.known_transfer import KnownTransfer
from jointbench.signal.fractal.instrument_blur import tip_fall

_IMAGES = 3
"""Images of the spectrum on each side that sampling folds in; the rest is an integral
[-]."""
_SHIFTS = 2 * np.pi * np.array([m for m in range(-_IMAGES, _IMAGES + 1) if m])
"""Places of the images [rad/sample]."""
_NEAR = 0.1
"""Wavenumber below which the sum of the images is a parabola in its square, to 1e-13
of the spectrum [rad/sample]."""
_NODES = _NEAR * np.sqrt([0.0, 0.5, 1.0])


@dataclass(frozen=True, slots=True)
class BandLimited:
    """A self-affine surface with a roll-off and a short cut, seen by an instrument.

    The spectrum is level / (1 + (q / q_r)^2)^(H + 1/2) up to a constant: a power law
    q^(-1-2H) at wavelengths below the roll-off, level above it. It is the line spectrum
    of an isotropic surface with C(q) ~ (1 + (q / q_r)^2)^(-1-H), and of the Matern
    covariance: H = 1/2 has the exponential one.

    Attributes:
        level: density at the pivot [rad^-1 in units of the squared height].
        pivot: wavenumber [rad/sample].
        hurst: H [-].
        roll_off: wavelength 2 pi / q_r [samples].
        blur: square of the width of the short cut [samples^2].
        noise: variance of each height, independent of all others.
    """

    level: float
    pivot: float
    hurst: float
    roll_off: float
    blur: float = 0.0
    noise: float = 0.0

    def surface(self, omega: FloatArray) -> FloatArray:
        """Return the two-sided density of the surface itself, at any wavenumber."""
        corner = (2 * np.pi / self.roll_off) ** 2
        ratio = (corner + self.pivot**2) / (corner + np.square(omega))
        density: FloatArray = self.level * ratio ** (self.hurst + 0.5)
        return density

    def short_cut(self, omega: FloatArray, *, tip: bool) -> FloatArray:
        """Return the power that the short cut leaves.

        Args:
            omega: [rad/sample], any shape.
            tip: whether it is the path of a round tip, or a Gaussian.
        """
        if self.blur == 0:
            return np.ones_like(omega)
        if not tip:
            left: FloatArray = np.exp(-self.blur * np.square(omega))
            return left
        fall = tip_fall(2 * self.hurst)
        traced: FloatArray = (1 + self.blur / fall * np.square(omega)) ** -fall
        return traced

    def sampled(self, omega: FloatArray, transfer: KnownTransfer) -> FloatArray:
        """Return the density of the sampled heights, with aliases and noise.

        Args:
            omega: 0 to pi [rad/sample], any shape.
            transfer: what the instrument is known to do.
        """
        tip = transfer.tip is not None
        total = self._left(omega, tip=tip) + self._images(np.asarray(omega), tip=tip)
        edge = np.array(2 * np.pi * (_IMAGES + 0.5))
        beyond = self.surface(edge) * self.short_cut(edge, tip=tip)
        # 2 integral of q^(-1-2H) beyond the images, over their distance.
        total += float(beyond * edge / self.hurst) / (2 * np.pi)
        seen: FloatArray = total * transfer.power(omega) + self.noise / (2 * np.pi)
        return seen

    def _left(self, omega: FloatArray, *, tip: bool) -> FloatArray:
        """Return the density that the short cut leaves."""
        density = self.surface(omega)
        if self.blur > 0:
            density *= self.short_cut(omega, tip=tip)
        return density

    def _images(self, omega: FloatArray, *, tip: bool) -> FloatArray:
        """Return the sum of the images at wavenumbers of any shape.

        Most wavenumbers of long waves are near 0, where the images hardly change.
        """
        near = omega < _NEAR
        place = np.concatenate([_NODES, omega[~near]])
        folded = self._left(place + _SHIFTS[:, None], tip=tip).sum(axis=0)
        first, middle, last = folded[:3]
        square = np.square(omega[near] / _NEAR)
        bend = 2 * (first - 2 * middle + last)
        total = np.empty(omega.shape)
        total[near] = first + square * (last - first + bend * (square - 1))
        total[~near] = folded[3:]
        return total
