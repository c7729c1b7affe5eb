# SPDX-License-Identifier: MIT
"""Test whether parts of the records need separate parameters.

A law that imitates the true one leaves residuals that no effect of the catalogue
explains, but that differ between levels, channels, early and late samples, or low and
high frequency: the parameters of all records together are then not optimal for any
part. These tests need no catalogue, so they also detect effects that it lacks.

Source:
    Chow 1960, Econometrica 28, 591, for parameters that are the same in all parts;
    implemented as a score test, so that no part is fitted again.
"""

import itertools
from dataclasses import dataclass

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import FloatArray
from jointbench.acquisition.basics.tail_probabilities import chi2_above, gamma_above
from jointbench.analysis.gap.judgement.judgement_settings import JUDGEMENT
from jointbench.analysis.gap.residuals.bench_protocol import Bench
from jointbench.analysis.gap.residuals.fit_records import Fit
from jointbench.analysis.gap.residuals.slopes import squared_norms


@dataclass(frozen=True, slots=True)
class Unlike:
    """The division of the records whose parts differ most.

    Attributes:
        view: name of the division.
        chance: probability of such a difference under noise alone [-].
        excess: drop of chi2 by separate parameters, minus their number.
    """

    view: str
    chance: float
    excess: float


@dataclass(frozen=True, slots=True, eq=False)
class _Cells:
    """Normal equations of the smallest parts: (..., n, n) and (..., n)."""

    gram: FloatArray
    gradient: FloatArray


def most_unlike(bench: Bench, fit: Fit, allowed: float) -> Unlike:
    """Divide the records in every way and return the division that differs most.

    Args:
        bench: on which the fit was found.
        fit: a minimum.
        allowed: chi2 that the model error may contribute.
    """
    shape = bench.blocks.shape
    sizes = np.sqrt(squared_norms(fit.jacobian))
    slopes = fit.jacobian / np.maximum(sizes, 1e-300)
    cells = _time_cells(slopes, fit.residual, shape)
    bands = _band_cells(slopes, fit.residual, shape)
    tests = [
        _test("frequency", bands, (0,), slopes, allowed),
        _test("frequency and output", bands, (0, 1), slopes, allowed),
        _line(fit.residual.reshape(shape), allowed),
    ]
    for name, axes in (
        ("record", (0,)),
        ("output", (1,)),
        ("time", (2,)),
        ("record and output", (0, 1)),
        ("record and time", (0, 2)),
        ("output and time", (1, 2)),
    ):
        tests.append(_test(name, cells, axes, slopes, allowed))
    for name in bench.blocks.labels[0]:
        words = [labels[name] for labels in bench.blocks.labels]
        if 1 < len(set(words)) < len(words):
            tests.append(_test(name, _pooled(cells, words), (0,), slopes, allowed))
    return min(tests, key=lambda t: t.chance)


def _time_cells(
    slopes: FloatArray, residual: FloatArray, shape: tuple[int, int, int]
) -> _Cells:
    """Return cells of record, channel and half, halved by the power of the slopes."""
    j, r = slopes.reshape(*shape, -1), residual.reshape(shape)
    weight = np.cumsum(np.einsum("rctn,rctn->t", j, j))
    half = int(np.searchsorted(weight, 0.5 * weight[-1])) + 1
    parts = [slice(0, half), slice(half, None)]
    gram = [np.matmul(j[:, :, p].transpose(0, 1, 3, 2), j[:, :, p]) for p in parts]
    gradient = [np.einsum("rctn,rct->rcn", j[:, :, p], r[:, :, p]) for p in parts]
    return _Cells(np.stack(gram, axis=2), np.stack(gradient, axis=2))


def _band_cells(
    slopes: FloatArray, residual: FloatArray, shape: tuple[int, int, int]
) -> _Cells:
    """Return cells of frequency band and channel; bands have equal slope power."""
    n = shape[2]
    unit = np.sqrt(2.0 / n)
    r = scipy.fft.rfft(residual.reshape(shape), axis=2) * unit
    j = scipy.fft.rfft(slopes.reshape(*shape, -1), axis=2) * unit
    weight = np.cumsum(np.einsum("rctn,rctn->t", j.conj(), j).real)
    shares = np.arange(1, JUDGEMENT.part_bands) / JUDGEMENT.part_bands
    edges = [0, *np.searchsorted(weight, shares * weight[-1]), weight.size]
    gram, gradient = [], []
    for low, high in itertools.pairwise(edges):
        part = j[:, :, low:high].transpose(1, 3, 0, 2).reshape(shape[1], j.shape[3], -1)
        data = r[:, :, low:high].transpose(1, 0, 2).reshape(shape[1], -1, 1)
        gram.append((part @ part.conj().transpose(0, 2, 1)).real)
        gradient.append((part.conj() @ data).real[:, :, 0])
    return _Cells(np.array(gram), np.array(gradient))


def _pooled(cells: _Cells, words: list[str]) -> _Cells:
    """Return cells with the records of each word summed."""
    kinds = {w: [i for i, x in enumerate(words) if x == w] for w in words}
    return _Cells(
        np.array([cells.gram[rows].sum(axis=0) for rows in kinds.values()]),
        np.array([cells.gradient[rows].sum(axis=0) for rows in kinds.values()]),
    )


def _test(
    name: str,
    cells: _Cells,
    axes: tuple[int, ...],
    slopes: FloatArray,
    allowed: float,
) -> Unlike:
    """Test separate parameters for every part along `axes`."""
    n = slopes.shape[1]
    others = tuple(k for k in range(cells.gradient.ndim - 1) if k not in axes)
    gram = cells.gram.sum(axis=others).reshape(-1, n, n)
    gradient = cells.gradient.sum(axis=others).reshape(-1, n)
    values, vectors = np.linalg.eigh(gram)
    along = np.einsum("gnk,gn->gk", vectors, gradient)
    seen = values > JUDGEMENT.least_eigenvalue * np.maximum(values[:, -1:], 1e-300)
    taken = float(np.sum(along[seen] ** 2 / values[seen]))
    free = max(int(seen.sum()) - n, 1)
    chance = chi2_above(max(taken - allowed, 0.0), free)
    return Unlike(name, chance, taken - free)


def _line(residual: FloatArray, allowed: float) -> Unlike:
    """Test the largest line of the spectrum, of one channel or of all.

    An ordinate of white noise is exponential, so that a sum over records is gamma.
    """
    n = residual.shape[2]
    taper = np.hanning(n)
    spectrum = scipy.fft.rfft(residual * taper, axis=2)
    power = np.sum(np.abs(spectrum) ** 2, axis=0) / np.sum(taper**2)
    rows = [*power, power.sum(axis=0)]
    counts = [residual.shape[0]] * len(power) + [residual.shape[0] * len(power)]
    found = []
    for row, count in zip(rows, counts, strict=True):
        top = float(row[2:-2].max())
        chance = row.size * gamma_above(top - allowed, count)
        found.append(Unlike("line of the spectrum", chance, top - count))
    return min(found, key=lambda t: t.chance)
