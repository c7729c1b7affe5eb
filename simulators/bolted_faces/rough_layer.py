# SPDX-License-Identifier: MIT
"""Roughness of two surfaces as a layer: gap over pressure by boundary elements.

Nothing here is shared with the contact laws of the station: neither their spectra nor
their solver.
"""

from dataclasses import dataclass

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray, freeze

_MOST_STEPS = 3000
_TOLERANCE = 1e-7
"""Largest change of a pressure in a step over the mean pressure [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class RoughLayer:
    """Mean gap between rough surfaces over the pressure.

    Attributes:
        pressure: ascending [Pa], shape (n_points,).
        gap: mean of both deformed surfaces [m], same shape.
    """

    pressure: FloatArray
    gap: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        freeze(self, "pressure", "gap")

    def pressure_at(self, gap: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return pressure [Pa] and stiffness per area [N/m^3] at gaps [m].

        Beyond the table the pressure is exponential in the gap.
        """
        log_p = np.log(self.pressure)
        slope = np.diff(log_p) / np.diff(self.gap)
        place = np.clip(np.searchsorted(-self.gap, -gap) - 1, 0, self.gap.size - 2)
        value = np.exp(log_p[place] + slope[place] * (gap - self.gap[place]))
        return value, -slope[place] * value


def random_face(
    points: int, spacing: float, rms: float, longest: float, seed: int
) -> FloatArray:
    """Return heights of a ground surface, periodic [m], shape (points, points).

    Args:
        points: along one side.
        spacing: of the points [m].
        rms: height [m].
        longest: wavelength beyond which the spectrum is level [m].
        seed: of the realisation.
    """
    rng = np.random.default_rng([seed, 41])
    wave = np.hypot(
        np.fft.fftfreq(points, spacing)[:, None],
        np.fft.rfftfreq(points, spacing)[None, :],
    )
    # Hurst exponent 0.8; waves below four points are left out.
    shape = np.maximum(wave, 1.0 / longest) ** -1.8
    shape *= (wave > 0) & (wave < 0.25 / spacing)
    noise = np.fft.rfft2(rng.standard_normal((points, points)))
    heights = np.fft.irfft2(noise * shape, s=(points, points))
    return np.asarray(heights * rms / heights.std())


def rough_layer(
    heights: FloatArray, spacing: float, modulus: float, pressure: FloatArray
) -> RoughLayer:
    """Press rough heights flat at several pressures.

    Args:
        heights: of both surfaces together, periodic [m], shape (n, n).
        spacing: of the points [m].
        modulus: E* [Pa].
        pressure: ascending [Pa], shape (n_pressures,).

    Source:
        Stanley and Kato 1997, J. Tribol. 119, 481; accelerated projected gradients.
    """
    count = heights.shape[0]
    wave = (
        2
        * np.pi
        * np.hypot(
            np.fft.fftfreq(count, spacing)[:, None],
            np.fft.rfftfreq(count, spacing)[None, :],
        )
    )
    green = np.divide(2.0 / modulus, wave, out=np.zeros_like(wave), where=wave > 0)
    depth = heights.max() - heights
    gaps, found = [], np.full(heights.shape, pressure[0])
    for mean in pressure:
        found = _pressed(depth, green, float(mean), found)
        total = depth + np.fft.irfft2(np.fft.rfft2(found) * green, s=depth.shape)
        gaps.append(float(np.mean(total - total[found > 0].mean())))
    return RoughLayer(pressure, np.array(gaps))


def _pressed(
    depth: FloatArray, green: FloatArray, mean: float, start: FloatArray
) -> FloatArray:
    """Return the pressures with a given mean."""
    last = start * mean / start.mean()
    ahead, t, step = last, 1.0, 1.0 / green.max()
    for _ in range(_MOST_STEPS):
        gap = depth + np.fft.irfft2(np.fft.rfft2(ahead) * green, s=depth.shape)
        now = _with_mean(ahead - step * gap, mean)
        change = now - last
        if np.abs(change).max() < _TOLERANCE * mean:
            return np.asarray(now)
        # A step uphill ends the momentum (O'Donoghue and Candes 2015).
        if np.sum((ahead - now) * change) > 0:
            t = 1.0
        t, before = 0.5 * (1.0 + np.sqrt(1.0 + 4.0 * t * t)), t
        ahead, last = now + (before - 1.0) / t * change, now
    return np.asarray(last)


def _with_mean(values: FloatArray, mean: float) -> FloatArray:
    """Return the nearest pressures that are not negative and have that mean."""
    low, high = values.min() - mean, values.max()
    for _ in range(60):
        level = 0.5 * (low + high)
        if np.maximum(values - level, 0.0).mean() > mean:
            low = level
        else:
            high = level
    return np.asarray(np.maximum(values - 0.5 * (low + high), 0.0))
