# SPDX-License-Identifier: MIT
"""Joints from the physics of single summits, for campaigns of the contact bench.

Nothing here is shared with the product: contacts are Hertz contacts on the summits of
simulated surfaces, one by one; waves are closed by a boundary-element solution; slip is
solved with the load of each contact; flattened summits unload one by one.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
GRID = 256
REALISATIONS = 60
GAPS = 400


@dataclass(frozen=True, eq=False)
class Summits:
    """Summits of simulated surfaces of unit rms height and unit pixel.

    Attributes:
        height: above the mean plane, shape (n,).
        curvature: mean of both directions, shape (n,).
        slope: rms along lines.
        line_curvature: rms along lines.
        cells: pixels of all surfaces.
        coarse: slope and line curvature through coarser instruments, by cut ratio.
    """

    height: Array
    curvature: Array
    slope: float
    line_curvature: float
    cells: int
    coarse: dict[float, tuple[float, float, float]]


@lru_cache(maxsize=16)
def summits(kind: int) -> Summits:
    """Return the summits of one of eight kinds of surfaces."""
    rng = np.random.default_rng(9000 + kind)
    hurst, roll = rng.uniform(0.6, 0.9), rng.uniform(3.0, 10.0)
    fx = np.fft.fftfreq(GRID)[:, None] * GRID
    fy = np.fft.rfftfreq(GRID)[None, :] * GRID
    q = np.hypot(fx, fy)
    cut = GRID / 8.0
    shape = np.maximum(q, roll) ** (-(1.0 + hurst)) * (q <= cut) * (q > 0)
    found: list[tuple[Array, Array]] = []
    slopes, curvatures, coarse = [], [], {2.0: [], 3.0: [], 4.0: []}
    for _ in range(REALISATIONS):
        noise = np.fft.rfft2(rng.standard_normal((GRID, GRID)))
        z = np.fft.irfft2(noise * shape, s=(GRID, GRID))
        scale = z.std()
        z /= scale
        slopes.append(_line_moments(z))
        curvatures.append(slopes[-1][1])
        for ratio, own in coarse.items():
            seen = np.fft.irfft2(noise * shape * (q <= cut / ratio), s=(GRID, GRID))
            own.append((float(np.std(seen / scale)), *_line_moments(seen / scale)))
        found.append(_summits_of(z))
    slope, curvature = np.mean(slopes, axis=0)
    return Summits(
        np.concatenate([f[0] for f in found]),
        np.concatenate([f[1] for f in found]),
        float(slope),
        float(curvature),
        REALISATIONS * GRID**2,
        {r: tuple(np.mean(own, axis=0)) for r, own in coarse.items()},
    )


def _line_moments(z: Array) -> tuple[float, float]:
    """Return rms slope and curvature along lines, by spectral derivatives."""
    k = 2.0 * np.pi * np.fft.rfftfreq(GRID)
    spectrum = np.fft.rfft(z, axis=1)
    slope = np.fft.irfft(1j * k * spectrum, axis=1)
    bend = np.fft.irfft(-(k**2) * spectrum, axis=1)
    return float(slope.std()), float(bend.std())


def _summits_of(z: Array) -> tuple[Array, Array]:
    shifts = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0)]
    top = np.all([z > np.roll(z, s, axis=(0, 1)) for s in shifts], axis=0)
    k = 2.0 * np.pi * np.fft.fftfreq(GRID)
    spectrum = np.fft.fft2(z)
    bend = np.fft.ifft2(-(k[:, None] ** 2 + k[None, :] ** 2) * spectrum).real
    return z[top], -0.5 * bend[top]


@dataclass(frozen=True, eq=False)
class RoughContact:
    """A rough contact of given size.

    Attributes:
        kind: of `summits`.
        rms: height [m].
        pixel: [m].
        area: apparent [m^2].
        modulus: E* [Pa].
        poisson: of the bodies [-].
    """

    kind: int
    rms: float
    pixel: float
    area: float
    modulus: float
    poisson: float

    @property
    def count(self) -> float:
        """Times that the simulated surfaces cover the area [-]."""
        return self.area / (summits(self.kind).cells * self.pixel**2)

    def contacts(self, preload: float) -> tuple[Array, Array, Array]:
        """Return radius, interference [m] and load [N] of the simulated contacts."""
        s = summits(self.kind)
        gap = self.gap(np.array([preload]))[0]
        deep = s.height > gap
        delta = (s.height[deep] - gap) * self.rms
        radius = self.pixel**2 / (self.rms * s.curvature[deep])
        return radius, delta, 4.0 / 3.0 * self.modulus * np.sqrt(radius) * delta**1.5

    def gap(self, preload: Array) -> Array:
        """Return the gap over the rms height at preloads [N]."""
        gaps, load, _ = _curve(self.kind)
        full = 4.0 / 3.0 * self.modulus * self.pixel * self.rms * self.count
        return np.interp(np.log(preload), np.log(full * load[::-1]), gaps[::-1])

    def stiffness(self, preload: Array) -> Array:
        """Return the normal stiffness at preloads [N/m]."""
        gaps, _, slope = _curve(self.kind)
        full = 2.0 * self.modulus * self.pixel * self.count
        return full * np.exp(np.interp(self.gap(preload), gaps, np.log(slope)))


@lru_cache(maxsize=16)
def _curve(kind: int) -> tuple[Array, Array, Array]:
    """Return gap, load and slope of the sum over all summits, dimensionless."""
    s = summits(kind)
    gaps = np.linspace(0.0, np.sort(s.height)[-20], GAPS)
    load, slope = np.empty(GAPS), np.empty(GAPS)
    for i, gap in enumerate(gaps):
        deep = s.height > gap
        delta, root = s.height[deep] - gap, s.curvature[deep] ** -0.5
        load[i], slope[i] = root @ delta**1.5, root @ np.sqrt(delta)
    return gaps, load, slope


def start_rms(contact: RoughContact, preload: float, gap: float) -> float:
    """Return the rms height at which a preload leaves a gap over the rms height [m]."""
    gaps, load, _ = _curve(contact.kind)
    one = np.exp(np.interp(gap, gaps, np.log(load)))
    full = 4.0 / 3.0 * contact.modulus * contact.pixel * contact.count * one
    return float(preload / full)


def tangential(
    contact: RoughContact, preload: float, shear: float, friction: float
) -> float:
    """Return the tangential stiffness under a tangential force [N/m].

    Every contact moves by the same amount and slips at its own limit.
    """
    radius, delta, load = contact.contacts(preload)
    reach = np.sqrt(radius * delta)
    compliant = (
        8.0 * contact.modulus * (1 - contact.poisson) / (2.0 * (2 - contact.poisson))
    )
    stick = compliant * reach
    if shear <= 0.0:
        return float(stick.sum() * contact.count)
    limit, wanted = friction * load, shear / contact.count
    low, high = 0.0, 2.0 * float((limit / stick).max())
    for _ in range(60):
        x = 0.5 * (low + high)
        left = np.maximum(1.0 - 2.0 * stick * x / (3.0 * limit), 0.0)
        force = float(np.sum(limit * (1.0 - left**1.5)))
        low, high = (x, high) if force < wanted else (low, x)
    return float(np.sum(stick * np.sqrt(left)) * contact.count)


def flattened_stiffness(
    contact: RoughContact, highest: float, preload: float, yield_depth: float
) -> float:
    """Return the normal stiffness after unloading flattened summits [N/m].

    Args:
        contact: the contact.
        highest: preload before [N].
        preload: now [N].
        yield_depth: interference at which a summit yields over its radius [-].

    Source:
        Etsion, Kligerman and Kadin 2005, Int. J. Solids Struct. 42, 3716.
    """
    radius, delta, load = contact.contacts(highest)
    deep = np.maximum(delta / (yield_depth * radius), 1.0)
    rest = delta * (1.0 - deep**-0.28) * (1.0 - deep**-0.69)
    power = 1.5 * deep**-0.0331
    low, high = 0.0, float(delta.max())
    for _ in range(60):
        back = 0.5 * (low + high)
        left = np.maximum(delta - back - rest, 0.0) / (delta - rest)
        force = load * left**power
        total = float(force.sum() * contact.count)
        low, high = (back, high) if total > preload else (low, back)
    live = left > 0
    slope = power[live] * force[live] / (left[live] * (delta - rest)[live])
    return float(slope.sum() * contact.count)


@lru_cache(maxsize=1)
def wave_compliance() -> tuple[Array, Array]:
    """Return p/p* and the compliance of a sinusoidal wave by boundary elements.

    The compliance is that of the mean gap, times E*/wavelength: -d(gap)/dp E*/lambda.
    """
    n = 512
    x = np.arange(n) / n
    wave = 0.5 * (1.0 - np.cos(2.0 * np.pi * x))  # gap of wavelength 1, depth 1
    k = 2.0 * np.pi * np.abs(np.fft.fftfreq(n, 1.0 / n))
    green = np.divide(2.0, k, out=np.zeros(n), where=k > 0)  # E* = 1
    closing = 0.5 * np.pi
    share = np.geomspace(0.01, 1.2, 60)
    gaps = []
    pressure = np.full(n, share[0] * closing)
    for one in share:
        pressure = _closed(wave, green, one * closing, pressure)
        bent = np.fft.ifft(np.fft.fft(pressure) * green).real
        total = wave + bent
        gaps.append(float(np.mean(total - total[pressure > 0].min())))
    compliance = -np.gradient(np.array(gaps), share * closing)
    return share, np.maximum(compliance, 0.0)


def _closed(wave: Array, green: Array, mean: float, start: Array) -> Array:
    """Return the pressure of a periodic contact with a given mean, by projection."""
    pressure = start * mean / start.mean()
    step = 1.0 / green.max()
    momentum, last, t = pressure.copy(), pressure.copy(), 1.0
    for _ in range(3000):
        gradient = wave + np.fft.ifft(np.fft.fft(momentum) * green).real
        pressure = _with_mean(momentum - step * gradient, mean)
        t, before = 0.5 * (1.0 + np.sqrt(1.0 + 4.0 * t * t)), t
        momentum = pressure + (before - 1.0) / t * (pressure - last)
        if np.abs(pressure - last).max() < 1e-7 * mean:
            break
        last = pressure
    return pressure


def _with_mean(values: Array, mean: float) -> Array:
    """Return the nearest non-negative values with that mean."""
    ordered = np.sort(values)[::-1]
    total = np.cumsum(ordered) - mean * values.size
    above = ordered - total / np.arange(1, values.size + 1) > 0
    last = int(np.flatnonzero(above)[-1])
    return np.maximum(values - total[last] / (last + 1), 0.0)
