# SPDX-License-Identifier: MIT
"""Poles by least squares on a right matrix fraction, all orders at once (LSCF).

The FRF is written as H = B(z) A(z)^-1 with z on the unit circle: A has one column per
input (poly-reference), B one row per output. Eliminating B leaves one small Hermitian
matrix, made of Toeplitz blocks that an FFT fills; its Cholesky factor nests, so that
every order is a leading block of the largest.

Two choices matter:

- a band that begins next to zero can be mapped to half the circle with real
  coefficients, as in the textbook, or around nearly the whole circle with complex ones.
  The first includes the mirror image of a low mode, whose flank would otherwise bias
  its damping; the second has one pole per mode instead of two, and is as well
  conditioned for a band far from zero;
- the constant coefficient of A is the identity, not the highest. Noise poles then fall
  outside the circle, and those inside are nearly all structural (Cauberghe, Applied
  frequency-domain system identification, 2004, ch. 4).
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.fft
import scipy.linalg
from numpy.typing import NDArray

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray, IntArray
from jointbench.signal.modal.matrix_roots import inverse_roots

# Share of the circle left open between the ends of the band.
_GAP = 0.05
# A band that begins below this share of its end begins next to zero.
_NEXT_TO_ZERO = 0.1
# Tolerance of lines at whole multiples of their spacing.
_WHOLE = 1e-9
# Keeps the normal equations definite where clean data leave them singular.
_RIDGE = 1e-14
# Spectra per transform: all that is made of them stays in the cache of one core.
_SERIES_AT_ONCE = 16
Progress = Callable[[str, float], None]
"""Called with the current step and its completed share [-]."""
# Inputs for which null vectors need no decomposition.
_PAIR = 2
_TINY = float(np.finfo(float).tiny)
Coefficients = NDArray[np.inexact[Any]]
"""Real on half the circle, complex on the whole."""


@dataclass(frozen=True, slots=True, eq=False)
class OrderPoles:
    """Poles of one order inside the band, by ascending frequency.

    Attributes:
        order: degree of the polynomial; times the number of inputs = poles found,
            including mirror images where these are fitted.
        pole: [rad/s], shape (n_poles,), those with positive damping only.
        shape: response at each pole, unit length, shape (n_poles, n_outputs).
    """

    order: int
    pole: ComplexArray
    shape: ComplexArray


@dataclass(frozen=True, slots=True, eq=False)
class _Reduced:
    """Normal equations of the largest order, before B is eliminated.

    Attributes:
        factor: lower Cholesky factor of R, shape (n + 1, n + 1).
        cross: factor^-1 S for each output, shape (n + 1, n_outputs, (n + 1) n_inputs).
        square: sum of T over outputs, shape ((n + 1) n_inputs,) * 2.
        n_inputs: columns of A.
    """

    factor: Coefficients
    cross: Coefficients
    square: Coefficients
    n_inputs: int


@dataclass(frozen=True, slots=True)
class _Circle:
    """The map between frequency and the unit circle, z = exp((s - j centre) period).

    Half of it, with centre zero, is the band's own and half its mirror image's.
    """

    centre: float
    period: float
    half: bool

    @classmethod
    def around(cls, frequency: FloatArray, half: bool | None) -> "_Circle":
        """Map a band to the circle but for a small gap, at the spacing of an FFT."""
        low, high = 2.0 * np.pi * frequency[[0, -1]]
        pitch = (high - low) / (frequency.size - 1)
        if half is None:
            half = bool(low < _NEXT_TO_ZERO * high)
        lines = 2.0 * high / pitch if half else float(frequency.size)
        points = scipy.fft.next_fast_len(math.ceil(lines * (1.0 + _GAP)), real=half)
        period = 2.0 * np.pi / (points * pitch)
        return cls(0.0 if half else 0.5 * (low + high), period, half)

    def angle(self, frequency: FloatArray) -> FloatArray:
        """Return the angle of z at frequencies [Hz]."""
        return (2.0 * np.pi * frequency - self.centre) * self.period

    def pole(self, root: ComplexArray) -> ComplexArray:
        """Return the pole [rad/s] of a root of A."""
        return np.asarray(np.log(root) / self.period + 1j * self.centre)

    def moments(
        self, frequency: FloatArray, series: NDArray[Any], order: int
    ) -> Coefficients:
        """Return sum over lines of series times z^k, k = -order..order, one row each.

        Half the circle takes the real part: half the sum with the mirror image. Evenly
        spaced lines take one FFT; others the sum itself.
        """
        angle, lags = self.angle(frequency), np.arange(-order, order + 1)
        pitch = np.diff(angle)
        if np.ptp(pitch) > 1e-9 * pitch[0] * angle.size:
            sums = series @ np.exp(1j * np.outer(angle, lags))
            return np.asarray(sums.real if self.half else sums)
        points = round(2.0 * np.pi / float(pitch.mean()))
        first = angle[0] / float(pitch.mean())
        if self.half and abs(first - round(first)) < _WHOLE:
            padded = np.zeros((series.shape[0], points // 2 + 1), series.dtype)
            padded[:, round(first) : round(first) + angle.size] = series
            sums = scipy.fft.irfft(padded, points, axis=1)[:, lags % points]
            return np.asarray(0.5 * (points * sums + padded[:, :1].real))
        sums = scipy.fft.ifft(series, points, axis=1)[:, lags % points]
        sums = sums * points * np.exp(1j * angle[0] * lags)
        return np.asarray(sums.real if self.half else sums)


def fit_poles(
    frequency: FloatArray,
    response: ComplexArray,
    orders: Sequence[int],
    *,
    weight: FloatArray | None = None,
    scalar: bool = False,
    mirrored: bool | None = None,
    added_decay_rate: float = 0.0,
    progress: Progress | None = None,
) -> tuple[OrderPoles, ...]:
    """Fit poles of several orders at once.

    Args:
        frequency: lines of the band [Hz], shape (n_lines,).
        response: FRF on them, any kind, shape (n_outputs, n_inputs, n_lines).
        orders: degrees, each at least 1; ascending.
        weight: of each line [-], shape (n_lines,), or None for equal weights (see
            `line_weights`).
        scalar: one denominator for all FRFs, each a separate output: for many inputs,
            or inputs that were not measured together. Close modes then share the order
            with all others, and shapes have n_outputs n_inputs components.
        mirrored: whether the mirror images of the poles, at negative frequencies, are
            fitted too: real coefficients on half the circle. None does so where the
            band begins below a tenth of its end.
        added_decay_rate: of the exponential window [1/s], subtracted from the poles.
        progress: called with the current step and its share; None for no reports.

    Returns:
        For each order the poles inside the band with positive damping.

    Source:
        Peeters, Van der Auweraer, Guillaume and Leuridan, Shock and Vibration 11
        (2004) 395, eq. (9) to (19).
    """
    if scalar:
        response = response.reshape(-1, 1, frequency.size)
    circle = _Circle.around(frequency, mirrored)
    largest = max(orders)
    scale = np.array([[[np.linalg.norm(r)]] for r in response])
    scale /= math.sqrt(response[0].size)
    line_weight = np.ones_like(frequency) if weight is None else weight
    reduced = _normal_equations(
        circle,
        frequency,
        response,
        np.where(scale > 0.0, scale, 1.0),
        line_weight,
        largest,
        progress,
    )
    band = (float(frequency[0]), float(frequency[-1]))
    found, inverse = [], None
    for order, matrix in _nested(reduced, orders):
        denominator = _denominator(matrix, reduced.n_inputs)
        inverse = inverse_roots(denominator.astype(complex), inverse)
        finite = np.where(np.abs(inverse) > _TINY, inverse, _TINY)
        roots = np.asarray(1.0 / finite, np.complex128)
        kept = _modes_among(circle.pole(roots) + added_decay_rate, band)
        shape = _shapes(reduced, denominator, roots[kept]) * scale.ravel()
        pole = circle.pole(roots[kept]) + added_decay_rate
        found.append(OrderPoles(order, pole, _unit(shape)))
        if progress is not None:
            progress("finding poles", (order / largest) ** 2)
    return tuple(found)


def _modes_among(pole: ComplexArray, band: tuple[float, float]) -> IntArray:
    """Return which poles can be modes, by ascending frequency."""
    frequency = pole.imag / (2.0 * np.pi)
    kept = (pole.real < 0.0) & (frequency >= band[0]) & (frequency <= band[1])
    kept &= np.abs(pole) <= 2.0 * np.pi * band[1]
    chosen = np.flatnonzero(kept)
    return np.asarray(chosen[np.argsort(frequency[chosen])])


def _unit(shape: ComplexArray) -> ComplexArray:
    """Return shapes of unit length, one per row."""
    length = np.linalg.norm(shape, axis=1, keepdims=True)
    return np.asarray(shape / np.where(length > 0, length, 1.0))


def _normal_equations(
    circle: _Circle,
    frequency: FloatArray,
    response: ComplexArray,
    scale: FloatArray,
    weight: FloatArray,
    order: int,
    progress: Progress | None,
) -> _Reduced:
    """Fill R, S and T, a few outputs at a time, and eliminate R."""
    n_outputs, n_inputs, n_lines = response.shape
    size = order + 1
    plain = circle.moments(frequency, weight[None], order)
    factor = np.asarray(np.linalg.cholesky(_regular(_blocks(plain, size)[0])))
    inner = np.zeros((n_inputs, n_inputs, n_lines), complex)
    cross = np.empty((size, n_outputs, size * n_inputs), factor.dtype)
    chunk = max(1, _SERIES_AT_ONCE // n_inputs)
    for first in range(0, n_outputs, chunk):
        part = response[first : first + chunk] / scale[first : first + chunk]
        inner += np.einsum("oil,ojl->ijl", part.conj(), part)
        series = (part * weight).reshape(-1, n_lines)
        moments = circle.moments(frequency, series, order)
        blocks = _blocks(-moments, size)
        blocks = blocks.reshape(-1, n_inputs, size, size).transpose(2, 0, 3, 1)
        solved = scipy.linalg.solve_triangular(
            factor, blocks.reshape(size, -1), lower=True
        )
        cross[:, first : first + chunk] = solved.reshape(size, -1, size * n_inputs)
        if progress is not None:
            progress("adding up FRFs", min(1.0, (first + chunk) / n_outputs))
    moments = circle.moments(frequency, (inner * weight).reshape(-1, n_lines), order)
    square = _blocks(moments, size)
    square = square.reshape(n_inputs, n_inputs, size, size).transpose(2, 0, 3, 1)
    return _Reduced(
        factor, cross, square.reshape(size * n_inputs, size * n_inputs), n_inputs
    )


def _blocks(moments: Coefficients, size: int) -> Coefficients:
    """Return Toeplitz blocks with entry (a, b) = moment of z^(b - a), one per row."""
    place = np.arange(size)
    return np.asarray(moments[:, size - 1 + place - place[:, None]])


def _regular(matrix: Coefficients) -> Coefficients:
    """Return the matrix with a ridge far below the measured values."""
    ridge = _RIDGE * np.trace(matrix).real
    return np.asarray(matrix + ridge * np.eye(matrix.shape[0]))


def _nested(
    reduced: _Reduced, orders: Sequence[int]
) -> Iterator[tuple[int, Coefficients]]:
    """Yield each order with its reduced matrix, growing by one row of B per step."""
    wanted = set(orders)
    eliminated = np.zeros_like(reduced.square)
    for row in range(max(orders) + 1):
        rows = reduced.cross[row]
        eliminated += rows.conj().T @ rows
        if row in wanted:
            size = (row + 1) * reduced.n_inputs
            yield row, (reduced.square - eliminated)[:size, :size]


def _denominator(matrix: Coefficients, n_inputs: int) -> Coefficients:
    """Return A with identity as its constant, shape (order + 1, n_inputs, n_inputs)."""
    known = matrix[n_inputs:, :n_inputs]
    rest = _solved(_regular(matrix[n_inputs:, n_inputs:]), -known)
    stacked = np.concatenate((np.eye(n_inputs), rest))
    return np.asarray(stacked.reshape(-1, n_inputs, n_inputs))


def _solved(matrix: Coefficients, right: Coefficients) -> Coefficients:
    """Solve a system that is positive definite, but for rounding on exact data."""
    posv: Any = scipy.linalg.get_lapack_funcs("posv", (matrix, right))
    found, failed = posv(matrix, right, lower=True)[1:]
    if failed:
        found = scipy.linalg.solve(matrix, right, assume_a="her")
    return np.asarray(found)


def _back_solved(factor: Coefficients, right: Coefficients) -> Coefficients:
    """Solve with the conjugate transpose of a lower factor; LAPACK without checks."""
    trtrs: Any = scipy.linalg.get_lapack_funcs("trtrs", (factor, right))
    return np.asarray(trtrs(factor, right, lower=1, trans=2)[0])


def _shapes(
    reduced: _Reduced, denominator: Coefficients, roots: ComplexArray
) -> ComplexArray:
    """Return B(z) v for each root z, where A(z) v = 0; shape (n_roots, n_outputs)."""
    size, n_inputs, _ = denominator.shape
    n_outputs = reduced.cross.shape[1]
    if roots.size == 0 or n_outputs == 1:
        return np.ones((roots.size, n_outputs), complex)
    powers = np.vander(roots, size, increasing=True)
    at_roots = (powers @ denominator.reshape(size, -1)).reshape(-1, n_inputs, n_inputs)
    null = _null_vectors(at_roots)
    moved = reduced.cross[:size, :, : size * n_inputs] @ denominator.reshape(
        -1, n_inputs
    )
    numerator = -_back_solved(reduced.factor[:size, :size], moved.reshape(size, -1))
    residues = (powers @ numerator).reshape(-1, n_outputs, n_inputs)
    return np.asarray((residues @ null[:, :, None])[:, :, 0])


def _null_vectors(matrices: ComplexArray) -> ComplexArray:
    """Return v with A v = 0 for each singular matrix, shape (n, n_inputs)."""
    if matrices.shape[1] != _PAIR:
        return np.asarray(np.linalg.svd(matrices)[2][:, -1].conj())
    # Across the longer row, as both are along one direction.
    longer = np.argmax(np.sum(np.abs(matrices) ** 2, axis=2), axis=1)
    row = matrices[np.arange(longer.size), longer]
    return np.asarray(np.stack((-row[:, 1], row[:, 0]), axis=1))
