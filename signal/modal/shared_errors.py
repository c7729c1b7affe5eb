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

import numpy as np
import scipy.fft

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.signal.modal.frf_lines import FrfLines
from jointbench.signal.modal.lsfd import LinearFit, modal_basis, modal_size
from jointbench.signal.modal.normal_equations import gram_matrices, inverses
from jointbench.signal.modal.refined_pole_covariance import (
    RefinedPoles,
    pole_slopes,
    slope_turns,
)

# A correlation of the factor counts above this many of its standard deviations.
_SIGNIFICANT = 2.0
# Lags are summed up to this share of the lines.
_LONGEST = 0.25
# Largest correction for what the fit absorbed of the factor.
_ABSORBED = 0.75


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
    joint = poles.linearised.poles
    whole = joint @ total @ joint
    index = np.arange(2 * n_modes).reshape(-1, 2)
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
    basis, slopes = modal_basis(lines, pole), pole_slopes(lines, pole)
    n_linear = modal_size(pole)
    columns = np.hstack((basis, slopes))
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
