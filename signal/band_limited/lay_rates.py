# SPDX-License-Identifier: MIT
"""Density of a map's model at many wavenumbers, and its derivatives by parameter."""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.signal.band_limited.lay_spectrum import LaySpectrum
from jointbench.signal.band_limited.map_parameters import (
    ANGLE,
    BLUR,
    HURST,
    RATIO,
    ROLL_OFF,
    SKEW,
)
from jointbench.signal.fractal.instrument_blur import tip_fall


@dataclass(frozen=True, slots=True, eq=False)
class TakenDensity:
    """Density of a model at wavenumbers, with the parts that its derivatives share.

    Attributes:
        model: the surface.
        u: wavenumber along the lay over the pivot [-], shape (n,).
        v: the same across it, same shape.
        along: part of the roll-off's sum along the lay [-], same shape.
        across: part across it, same shape.
        fall: ln of the density over the level before the short cut, over 1 + H [-].
        square: of the wavenumber [rad^2/sample^2], same shape.
        tip: whether the short cut is a tip's path or a Gaussian.
        density: after the short cut, same shape.
    """

    model: LaySpectrum
    u: FloatArray
    v: FloatArray
    along: FloatArray
    across: FloatArray
    fall: FloatArray
    square: FloatArray
    tip: bool
    density: FloatArray

    def rate(self, parameter: int) -> FloatArray:
        """Return the derivative of ln density by a parameter of `map_parameters`.

        Args:
            parameter: its place; level and noise have closed ones of the bins.
        """
        if parameter == HURST:
            return self._by_hurst()
        if parameter == BLUR:
            return self._by_blur()
        return (1 + self.model.hurst) * self._fall_by(parameter)

    def _fall_by(self, parameter: int) -> FloatArray:
        """Return the derivative of `fall` by roll-off, ratio, angle or skew."""
        model, rest = self.model, 1 + self.along + self.across
        middle = 1 + model.far * (model.ratio + 1 / model.ratio) / 2
        if parameter == ROLL_OFF:
            return 2 * ((middle - 1) / middle - (rest - 1) / rest)
        if parameter == RATIO:
            whole = model.far * (model.ratio - 1 / model.ratio) / 2 / middle
            return whole - (self.along - self.across) / rest
        first, second = model.powers
        if parameter == ANGLE:
            turned = first * _over(self.along, self.u) * self.v
            turned -= second * _over(self.across, self.v) * self.u
            return -turned / rest
        assert parameter == SKEW
        bent = second**2 * self.across * _log(self.v)
        bent -= first**2 * self.along * _log(self.u)
        return -bent / (2 * rest)

    def _by_hurst(self) -> FloatArray:
        if not (self.tip and self.model.blur > 0):
            return self.fall
        # The exponent of a tip's short cut is inverse to H.
        fall = tip_fall(2 * self.model.hurst)
        ratio = self.model.blur / fall * self.square
        by_exponent = ratio / (1 + ratio) - np.log1p(ratio)
        return self.fall - by_exponent * fall / self.model.hurst

    def _by_blur(self) -> FloatArray:
        if not self.tip:
            return -self.square
        fall = tip_fall(2 * self.model.hurst)
        return -self.square / (1 + self.model.blur / fall * self.square)


def take_density(
    model: LaySpectrum, x: FloatArray, y: FloatArray, square: FloatArray, *, tip: bool
) -> TakenDensity:
    """Return the density of a model after its short cut.

    Args:
        model: the surface.
        x: along the rows [rad/sample], shape (n,).
        y: down the columns [rad/sample], same shape.
        square: x^2 + y^2, same shape.
        tip: whether the short cut is a tip's path or a Gaussian.
    """
    u, v, along, across = model.parts(x, y)
    middle = 1 + model.far * (model.ratio + 1 / model.ratio) / 2
    fall = np.log(middle / (1 + along + across))
    log_density = (1 + model.hurst) * fall
    if model.blur > 0:
        log_density += model.log_short_cut(square, tip=tip)
    density = model.level * np.exp(log_density)
    return TakenDensity(model, u, v, along, across, fall, square, tip, density)


def _over(part: FloatArray, wave: FloatArray) -> FloatArray:
    """Return a power above 1 of a wavenumber over it, 0 where it is 0."""
    return np.divide(part, wave, out=np.zeros_like(part), where=wave != 0)


def _log(wave: FloatArray) -> FloatArray:
    """Return ln |wave|, 0 where it is 0."""
    return np.log(np.abs(wave), out=np.zeros_like(wave), where=wave != 0)
