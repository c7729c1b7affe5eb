# SPDX-License-Identifier: MIT
"""Root mean squares of a map between two wavelengths, over all directions."""

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.signal.band_limited.band_records import Interval95, RoughnessMoments
from jointbench.signal.band_limited.lay_spectrum import LaySpectrum
from jointbench.signal.band_limited.map_sample import MapSample
from jointbench.signal.band_limited.moment_units import in_metres
from jointbench.signal.band_limited.roughness_moments import RESOLVED
from jointbench.signal.fractal.verdict_records import NORMAL_97_5

_RADII, _TURNS = 80, 24
"""Nodes of the integral over wavelengths and directions [-]."""
_SHARE = np.linspace(0, 1, _RADII)
_LINE = np.array([1.0, 0.5, 0.375])
"""Mean squares of height, slope and curvature along a line, averaged over directions,
over the integrals of q^0, q^2 and q^4 [-]."""


def ring_moments(model: LaySpectrum, low: float, high: float) -> FloatArray:
    """Return mean squares of height, slope and curvature of waves in a ring.

    Args:
        model: the surface.
        low: wavenumber [rad/sample]; 0 for all long waves.
        high: wavenumber [rad/sample].
    """
    corner = 2 * np.pi / max(model.roll_offs)
    start = low if low > 0 else 1e-3 * min(corner, high)
    edge = start * (high / start) ** _SHARE
    if low == 0:
        edge = np.concatenate([[0.0], edge])
    q = 0.5 * (edge[1:] + edge[:-1])
    # An isotropic surface has the same density in all directions.
    turns = 1 if model.ratio == 1 and model.skew == 0 else _TURNS
    turn = model.angle + np.pi * (np.arange(turns) + 0.5) / turns
    x, y = q[:, None] * np.cos(turn), q[:, None] * np.sin(turn)
    part = 2 * np.pi * q * np.diff(edge) * model.surface(x, y).mean(axis=1)
    moments: FloatArray = _LINE * [np.sum(part * q**k) for k in (0, 2, 4)]
    return moments


def shortest_map_wave(sample: MapSample, model: LaySpectrum) -> float:
    """Return the shortest wavelength at which a map shows the surface [samples].

    It is outside known filters, not shorter than the short cut, and has more power of
    the surface than of noise.
    """
    tip = sample.transfer.tip is not None
    pitch = max(1.0, sample.stretch)
    omega = np.geomspace(2 * np.pi / sample.length, np.pi / pitch, 200)
    turn = np.pi * (np.arange(_TURNS) + 0.5) / _TURNS
    x, y = omega[:, None] * np.cos(turn), omega[:, None] * np.sin(turn)
    left = model.short_cut(np.square(omega), tip=tip)
    seen = model.surface(x, y).mean(axis=1) * left * sample.transfer.power(omega)
    shown = seen > model.noise * sample.stretch / (4 * np.pi**2)
    shown &= left >= 0.25
    hidden = np.flatnonzero(~shown)
    top = omega[max(0, int(hidden[0]) - 1)] if hidden.size else omega[-1]
    cutoff = sample.transfer.short or 0.0
    return float(max(RESOLVED * pitch, cutoff, 2 * np.pi / float(top)))


def longest_map_wave(sample: MapSample) -> float:
    """Return the longest wavelength of the moments [samples]: a side, or lambda_c."""
    lowest = sample.transfer.lowest
    return min(sample.length, 2 * np.pi / lowest if lowest > 0 else np.inf)


def measured_map_moments(sample: MapSample) -> RoughnessMoments | None:
    """Return sums of the measured spectrum, for maps without a self-affine band.

    Known filters are divided out. Waves that levelling and the taper change have the
    density of the longest that are fitted.
    """
    short = max(RESOLVED * max(1.0, sample.stretch), sample.transfer.short or 0.0)
    long = longest_map_wave(sample)
    q = np.hypot(sample.along, sample.down)
    inside = (q <= 2 * np.pi / short) & (q >= 2 * np.pi / long)
    if np.count_nonzero(inside) < 4 or not long > 2 * short:
        return None
    q, power, count = q[inside], sample.power[inside], sample.count[inside]
    power = power / sample.transfer.power(q)
    # Bins tile the half plane: each has the area of its ordinates.
    unit = sample.lowest[0] * sample.lowest[1]
    area = unit * count * _ordinates(sample)
    disc = np.pi * (float(q.min()) ** 2 - (2 * np.pi / long) ** 2) / 2
    long_bins = q < 1.5 * q.min()
    core = max(0.0, disc) * float(np.average(power[long_bins], weights=area[long_bins]))
    parts = []
    for k, factor in zip((0, 2, 4), _LINE, strict=True):
        terms = 2 * factor * power * area * q**k
        total = float(terms.sum()) + 2 * factor * core * float(q.min()) ** k
        # A normal mean of ordinates; the long waves that were left out add theirs.
        spread = np.sqrt(np.sum(terms**2 / count)) + 2 * factor * core * q.min() ** k
        reach = np.exp(0.5 * NORMAL_97_5 * spread / total)
        value = float(np.sqrt(total))
        parts.append(Interval95(value, float(value / reach), float(value * reach)))
    return in_metres(sample.pitch, sample.scale, (short, long), parts, modelled=False)


def _ordinates(sample: MapSample) -> float:
    """Return ordinates over independent ones: all fill the half plane."""
    rows, columns = sample.shape
    return float(max(1.0, 0.5 * rows * columns / sample.count.sum()))
