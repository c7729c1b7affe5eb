# SPDX-License-Identifier: MIT
"""Errors that all FRFs of a reference share, as a low-rank covariance of the poles.

The noise of the force and the aim of the hammer, weighted differently on each line by
the hits that are averaged, change all FRFs of one reference by the same factor, smooth
over the lines. A covariance from line variances takes errors of FRFs and lines as
independent: it lets that factor average out, which it does not. Here the factor is
estimated from the residual, line by line; what its values on different lines have in
common is its autocovariance, free of the noise of single lines; and that is propagated
to the poles.
"""

from dataclasses import dataclass

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.signal.modal.frf_lines import FrfLines
from jointbench.signal.modal.lsfd import LinearFit
from jointbench.signal.modal.normal_equations import gram_matrices, inverses
from jointbench.signal.modal.pole_columns import basis_and_slopes, modal_size
from jointbench.signal.modal.refined_pole_covariance import (
    RefinedPoles,
    slope_turns,
)

# A correlation of the factor counts above this many of its standard deviations.
_SIGNIFICANT = 2.0
# Lags are summed up to this share of the lines.
_LONGEST = 0.25
# Length of the force window with its taper over its width; samples of it, at least.
_TAPERED, _LEAST_SAMPLES = 1.5, 8


@dataclass(frozen=True, slots=True, eq=False)
class ForceNoise:
    """Noise of the force that one window kept.

    Attributes:
        relative: E|error|^2 of an FRF over its own |FRF|^2, shape (n_inputs, n_lines).
        width: time after the trigger in which the force was kept [s]; 0 where the
            noise is not known.
    """

    relative: FloatArray
    width: float


def shared_covariance(
    lines: FrfLines,
    poles: RefinedPoles,
    fit: LinearFit,
    variance: FloatArray,
    n_inputs: int,
) -> FloatArray:
    """Return the covariance of poles from errors that FRFs of a reference share.

    Args:
        lines: lines of the fit, inputs varying fastest.
        poles: at the optimum.
        fit: residues of modes and poles beyond the band.
        variance: E|error|^2 of each line, shape (n_frf, n_lines).
        n_inputs: references that were hit.

    Returns:
        Of (Re p, Im p) of each mode [rad^2/s^2], shape (n_modes, 2, 2); zero where the
        residual shows no such error.
    """
    n_modes = poles.pole.size
    covariance = _autocovariance(poles.residual, fit.synthesis, variance, n_inputs)
    if covariance.size == 0:
        return np.zeros((n_modes, 2, 2))
    everything = np.append(poles.pole, poles.beyond)
    responses = _responses(lines, everything, fit, variance, n_inputs)
    lags = covariance.size
    size = scipy.fft.next_fast_len(lines.laplace.size + lags)
    both = np.zeros(size, complex)
    both[:lags] = covariance
    both[size - lags + 1 :] = covariance[:0:-1].conj()
    density = np.maximum(scipy.fft.fft(both).real, 0.0)
    total = np.zeros((2 * everything.size, 2 * everything.size))
    for response in responses:
        spectrum = scipy.fft.fft(response, size, axis=0)
        total += 0.5 * (spectrum.T * density @ spectrum.conj()).real / size
    return _of_modes(poles, total)


def force_covariance(
    lines: FrfLines,
    poles: RefinedPoles,
    fit: LinearFit,
    variance: FloatArray,
    noise: ForceNoise,
) -> FloatArray:
    """Return the covariance of poles from the noise of the windowed force.

    The noise of a force kept for a short time changes as many lines together as the
    block is longer than the window: its covariance over lines has the rank of that
    time. It is propagated sample by sample.

    Args:
        lines: lines of the fit, inputs varying fastest.
        poles: at the optimum.
        fit: residues of modes and poles beyond the band.
        variance: E|error|^2 of each line, shape (n_frf, n_lines).
        noise: of the force.

    Returns:
        Of (Re p, Im p) of each mode [rad^2/s^2], shape (n_modes, 2, 2).
    """
    everything = np.append(poles.pole, poles.beyond)
    n_inputs = noise.relative.shape[0]
    responses = _responses(lines, everything, fit, variance, n_inputs)
    omega = lines.laplace.imag
    count = max(_LEAST_SAMPLES, int(np.ceil(_TAPERED * noise.width * np.ptp(omega))))
    time = (np.arange(count) + 0.5) * _TAPERED * noise.width / count
    beyond = np.clip((time / noise.width - 1.0) / (_TAPERED - 1.0), 0.0, 1.0)
    weight = (0.5 * (1.0 + np.cos(np.pi * beyond))) ** 2
    wave = np.exp(-1j * np.outer(time, omega)) * np.sqrt(weight / weight.sum())[:, None]
    total = np.zeros((2 * everything.size, 2 * everything.size))
    for relative, response in zip(noise.relative, responses, strict=True):
        samples = wave @ (np.sqrt(relative)[:, None] * response)
        total += 0.5 * (samples.T @ samples.conj()).real
    return _of_modes(poles, total)


def _of_modes(poles: RefinedPoles, score: FloatArray) -> FloatArray:
    """Return what a covariance of the score does to each mode."""
    joint = poles.linearised.poles
    whole = joint @ score @ joint
    index = np.arange(2 * poles.pole.size).reshape(-1, 2)
    return np.asarray(whole[index[:, :, None], index[:, None, :]])


def _autocovariance(
    residual: ComplexArray, synthesis: ComplexArray, variance: FloatArray, n_inputs: int
) -> ComplexArray:
    """Return the autocovariance of the common factor over lines, empty if not shown.

    Products of different lines are free of the noise of single lines; that of lag 0 is
    taken from lag 1.
    """
    n_lines = residual.shape[1]
    shape = (-1, n_inputs, n_lines)
    weight = np.sum((np.abs(synthesis) ** 2 / variance).reshape(shape), axis=0)
    force = np.sum((synthesis.conj() * residual / variance).reshape(shape), axis=0)
    size = scipy.fft.next_fast_len(2 * n_lines)

    def products(values: np.ndarray) -> ComplexArray:
        power = np.abs(scipy.fft.fft(values, size, axis=1)) ** 2
        return np.asarray(scipy.fft.ifft(power.sum(axis=0))[:n_lines])

    # Lines where noise is least would count alone: weights are those of the root.
    some = np.sqrt(np.maximum(weight, 1e-300))
    summed, norm = products(force / some), products(some + 0j).real
    spread = np.sqrt(products(np.abs(force / some) ** 2 + 0j).real)
    n_lags = max(2, int(_LONGEST * n_lines))
    clear = np.abs(summed[1:n_lags]) > _SIGNIFICANT * spread[1:n_lags]
    last = int(np.argmin(clear)) if not clear.all() else clear.size
    if last == 0:
        return np.empty(0, complex)
    found = summed[: last + 1] / norm[: last + 1]
    found[0] = abs(found[1])
    return np.asarray(found * (1.0 - np.arange(last + 1) / (last + 1.0)))


def _responses(
    lines: FrfLines,
    pole: ComplexArray,
    fit: LinearFit,
    variance: FloatArray,
    n_inputs: int,
) -> ComplexArray:
    """Return the score of each pole from a unit factor on each line.

    Shape (n_inputs, n_lines, 2 n_poles): the projected slopes of all FRFs of a
    reference, weighted, times the FRFs.
    """
    n_linear = modal_size(lines, pole)
    columns = basis_and_slopes(lines, pole)
    basis, slopes = columns[:, :n_linear], columns[:, n_linear:]
    weight = 2.0 / variance
    products = gram_matrices(columns, weight)
    turn = slope_turns(fit.coefficients[:, : 2 * pole.size])
    inverse = inverses(products[:, :n_linear, :n_linear])
    overlap = products[:, :n_linear, n_linear:] @ turn
    part = inverse @ overlap
    found = np.zeros((n_inputs, lines.laplace.size, 2 * pole.size), complex)
    for number in range(variance.shape[0]):
        slope = slopes @ turn[number] - basis @ part[number]
        strength = weight[number] * fit.synthesis[number]
        found[number % n_inputs] += slope.conj() * strength[:, None]
    return found
