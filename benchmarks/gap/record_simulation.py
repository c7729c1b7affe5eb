# SPDX-License-Identifier: MIT
"""Records of nonlinear structures by a Runge-Kutta method in physical coordinates.

The simulation shares neither integrator nor model with the engine: masses, dampers and
springs in a matrix, slip as a differential equation, and a force that is interpolated
by a Fourier series between its samples.
"""

from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
FINE = 64
"""Half steps of the integration per sample."""


@dataclass(frozen=True, slots=True, eq=False)
class Structure:
    """Linear structure with one nonlinear port.

    Attributes:
        mass: [kg], shape (n, n).
        damping: [N s/m], same shape.
        stiffness: [N/m], same shape.
        driven: rows that the inputs act on, shape (n_inputs, n).
        across: relative motion at the port, shape (n,).
        springs: cubic stiffness [N/m^3], clearance stiffness [N/m], clearance [m] and
            its offset [m], shape (4,).
        sliders: stiffness [N/m], the coefficients of |v| |z|^n sign(z) and of
            v |z|^n [1/m N^(1-n)], and n, one row each, shape (n_sliders, 4).
    """

    mass: Array
    damping: Array
    stiffness: Array
    driven: Array
    across: Array
    springs: Array
    sliders: Array


def multisine(
    samples: int, rate: float, band: tuple[float, float], rms: float, seed: int
) -> Array:
    """Return one period of a random-phase multisine, shape (samples,)."""
    rng = np.random.default_rng(seed)
    frequency = np.fft.rfftfreq(samples, 1 / rate)
    lines = np.where((frequency >= band[0]) & (frequency <= band[1]), 1.0 + 0j, 0.0)
    lines *= np.exp(2j * np.pi * rng.random(lines.size))
    x = np.fft.irfft(lines, samples)
    return np.asarray(x * rms / x.std())


def sweep(
    rate: float, band: tuple[float, float], per_second: float, amplitude: float
) -> Array:
    """Return a linear sine sweep, shape (n_samples,)."""
    duration = (band[1] - band[0]) / per_second
    time = np.arange(int(duration * rate)) / rate
    return np.asarray(
        amplitude * np.sin(2 * np.pi * (band[0] * time + 0.5 * per_second * time**2))
    )


def finer(force: Array, *, periodic: bool = True) -> Array:
    """Interpolate forces by a Fourier series, shape (n_inputs, n FINE)."""
    n = force.shape[-1]
    if not periodic:
        mirrored = np.concatenate([force, -force[..., ::-1]], axis=-1)
        return finer(mirrored)[..., : n * FINE]
    return np.asarray(np.fft.irfft(np.fft.rfft(force), n * FINE) * FINE)


def simulate(structure: Structure, fine: Array, rate: float, periods: int = 1) -> Array:
    """Integrate from rest and return displacements at the samples.

    Args:
        structure: the structure.
        fine: forces, see `finer`, shape (n_inputs, n FINE).
        rate: of the samples [Hz].
        periods: times that the force is repeated.

    Returns:
        Displacement, velocity and acceleration [m, m/s, m/s^2], shape
        (3, n, periods n_samples).
    """
    inverse = np.linalg.inv(structure.mass)
    return np.asarray(
        _integrate(
            inverse @ structure.stiffness,
            inverse @ structure.damping,
            inverse @ structure.driven.T @ np.atleast_2d(fine),
            inverse @ structure.across,
            structure.across,
            structure.springs,
            structure.sliders,
            1.0 / (rate * FINE),
            periods,
        )
    )


@numba.njit(cache=True)
def _slope(x, v, z, push, k, c, inward, across, springs, sliders, a, dz):  # type: ignore[no-untyped-def]
    n = x.size
    r = rate = 0.0
    for i in range(n):
        r += across[i] * x[i]
        rate += across[i] * v[i]
    force = springs[0] * r * r * r
    over = abs(r - springs[3]) - springs[2]
    if springs[1] > 0.0 and over > 0.0:
        force += springs[1] * over * (1.0 if r > springs[3] else -1.0)
    for j in range(z.size):
        force += z[j]
        stiffness, turned, along, power = sliders[j]
        size = abs(z[j])
        sign = 1.0 if z[j] > 0.0 else -1.0
        dz[j] = stiffness * rate - size**power * (
            turned * abs(rate) * sign + along * rate
        )
    for i in range(n):
        total = push[i] - inward[i] * force
        for m in range(n):
            total -= k[i, m] * x[m] + c[i, m] * v[m]
        a[i] = total


@numba.njit(cache=True)
def _integrate(k, c, push, inward, across, springs, sliders, half, periods):  # type: ignore[no-untyped-def]
    n, count, slips = k.shape[0], push.shape[1], sliders.shape[0]
    fine = count * periods
    samples = fine // FINE
    out = np.zeros((3, n, samples))
    x, v, z = np.zeros(n), np.zeros(n), np.zeros(slips)
    a, dz = np.zeros((4, n)), np.zeros((4, slips))
    w, xt, vt, zt = np.zeros((4, n)), np.zeros(n), np.zeros(n), np.zeros(slips)
    shares = (0.0, 1.0, 1.0, 2.0)
    for i in range(0, fine, 2):
        for stage in range(4):
            h = shares[stage] * half
            last = max(stage - 1, 0)
            for m in range(n):
                xt[m] = x[m] + h * w[last, m]
                vt[m] = v[m] + h * a[last, m]
            for j in range(slips):
                zt[j] = z[j] + h * dz[last, j]
            w[stage] = vt
            at = (i + (stage + 1) // 2) % count
            _slope(
                xt,
                vt,
                zt,
                push[:, at],
                k,
                c,
                inward,
                across,
                springs,
                sliders,
                a[stage],
                dz[stage],
            )
        if i % FINE == 0:
            s = i // FINE
            out[0, :, s], out[1, :, s], out[2, :, s] = x, v, a[0]
        step = 2.0 * half / 6.0
        x += step * (w[0] + 2 * w[1] + 2 * w[2] + w[3])
        v += step * (a[0] + 2 * a[1] + 2 * a[2] + a[3])
        z += step * (dz[0] + 2 * dz[1] + 2 * dz[2] + dz[3])
    return out
