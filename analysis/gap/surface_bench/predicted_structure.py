# SPDX-License-Identifier: MIT
"""Spectrum, structure function and rows that a fit of the surface bench predicts."""

from dataclasses import replace

import numpy as np

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.surface_bench.surface_bench import SurfaceBench
from jointbench.analysis.gap.surface_bench.surface_rows import SurfaceRows

_CELLS = 600
_LOWEST = 0.05
"""Lowest wavenumber over that of the length of a line [-]."""
_LEGENDRE = (2, 3)


def expected_rows(bench: SurfaceBench, fit: Fit) -> SurfaceRows:
    """Return the rows of a bench with the values that a fit expects.

    Args:
        bench: of the fit.
        fit: with or without effects.
    """
    state, rows = bench.state(fit.base, fit.terms), bench.rows
    long, bins = rows.expected(state, bench.rounded(state))
    shapes = rows.shapes
    marks = rows.marks
    if marks is not None:
        power = marks.chance + (state.marks * rows.sample.scale) ** 2
        marks = replace(marks, power=power)
    return replace(
        rows,
        sample=replace(rows.sample, power=bins),
        long=None if rows.long is None else replace(rows.long, power=long),
        shapes=replace(shapes, value=shapes.expected + np.asarray(state.shapes)),
        marks=marks,
    )


def predicted_spectrum(bench: SurfaceBench, fit: Fit) -> FloatArray:
    """Return the density that a fit predicts in the bins, without marks, (n_bins,).

    Args:
        bench: of the fit.
        fit: with or without effects.
    """
    state = bench.state(fit.base, fit.terms)
    sample = bench.rows.sample
    density = state.sampled(sample.omega, sample.transfer) + bench.rounded(state)
    return np.asarray(density + bench.rows.form @ np.square(state.form))


def predicted_structure(bench: SurfaceBench, fit: Fit, lag: FloatArray) -> FloatArray:
    """Return the structure function of levelled lines that a fit predicts [m^2].

    Args:
        bench: of the fit.
        fit: with or without effects.
        lag: [m], shape (n,).
    """
    state, sample = bench.state(fit.base, fit.terms), bench.rows.sample
    lowest = 2 * np.pi * _LOWEST / sample.points
    edge = np.geomspace(lowest, np.pi, _CELLS + 1)
    omega = np.sqrt(edge[1:] * edge[:-1])
    density = state.sampled(omega, sample.transfer) * np.diff(edge)
    steps = lag / sample.pitch
    phase = np.multiply.outer(steps, omega)
    # A line takes out the slope of waves longer than itself.
    slope = 6.0 * _slope_kernel(0.5 * sample.points * omega) / sample.points
    lost = np.multiply.outer(steps, slope)
    waves = 4 * (1 - np.cos(phase)) - 4 * lost * np.sin(phase) + 2 * lost**2
    found = waves @ density
    if state.step > 0:
        found = found + state.step**2 / 6
    x = np.linspace(-1, 1, 400)
    for size, degree in zip(state.form, _LEGENDRE, strict=True):
        shape = np.polynomial.legendre.Legendre.basis(degree)(x)
        moved = np.round(0.5 * 400 * steps / (0.5 * sample.points)).astype(int)
        found = found + size**2 * np.array([_mean_square(shape, k) for k in moved])
    return np.asarray(sample.scale**2 * np.maximum(found, 0.0))


def _slope_kernel(half: FloatArray) -> FloatArray:
    """Return the least-squares slope of sin(x) over half a line, in its half length."""
    small = half < 1e-2
    safe = np.where(small, 1.0, half)
    full = (np.sin(safe) - safe * np.cos(safe)) / safe**2
    return np.where(small, half / 3.0, full)


def _mean_square(shape: FloatArray, step: int) -> float:
    if step <= 0 or step >= shape.size:
        return 0.0
    return float(np.mean((shape[step:] - shape[:-step]) ** 2))
