# SPDX-License-Identifier: MIT
"""Variance of each line of an FRF: noise and model error.

Where hits were averaged, their scatter gives the noise. Where only the FRF is given,
its roughness does: from line to line a structure is smooth and noise is not. Neither
includes the model error; that is estimated from the residual of a fit.

The covariance of a least-squares fit holds if residuals match the variances and are
independent from line to line. Their local ratio around a mode corrects for the first,
their correlation for the second. Two practices make intervals too wide and are avoided:
counting only ratios above 1, where the variances themselves are estimates that err both
ways, and treating every chance correlation of a few lines as real.
"""

import numpy as np
from scipy.ndimage import uniform_filter1d

from jointbench.acquisition.basics.arrays import ComplexArray, FloatArray
from jointbench.signal.modal.frf_lines import FrfLines, measured_width

# |x|^2 of complex normal noise has this median, as a share of its mean.
_MEDIAN_OF_POWER = float(np.log(2.0))
# Lines over which the noise is assumed constant; fewer for a response with resonances.
_ROUGHNESS_LINES = 41
_RESIDUAL_LINES = 164
_LEVEL_LINES = 11
_LOCAL_LINES = 41
# Least sd of an FRF as a share of its own level: converters, cables.
_BEST = 1e-7
# Model error above which a structure is none of the model, and a small residual chance.
_INEXACT = 0.02
# Around a mode: this many half-power half-widths, and this many lines, each side.
_REACH_WIDTHS = 4.0
_REACH_LINES = 10.0
# A correlation counts above this many of its own standard deviations.
_SIGNIFICANT = 2.0
_HIGHEST_SHARE = 0.99


def line_noise(
    response: ComplexArray,
    scatter: FloatArray | None,
    residual: ComplexArray | None = None,
) -> FloatArray:
    """Return the noise variance of every line.

    Args:
        response: FRF, shape (n_frf, n_lines).
        scatter: variance from the scatter between hits, same shape, or None.
        residual: of a fit, same shape, or None: the response is rough at resonances,
            the residual only where it is noisy.

    Returns:
        E|error|^2, same shape, positive everywhere.

    Note:
        The scatter between hits also holds what moves whole residues and no pole: the
        aim of the hammer, its gain. It is smooth over the lines of a peak, so that the
        roughness of the residual does not contain it; the smaller of the two counts.
    """
    if residual is None:
        noise = roughness(response)
    else:
        noise = roughness(residual, alike=_RESIDUAL_LINES)
    if scatter is not None:
        usual = uniform_filter1d(scatter, _LEVEL_LINES, axis=1, mode="nearest")
        noise = np.minimum(noise, usual)
    floor = (_BEST**2) * local_level(response)
    smallest = float(floor.max()) * 1e-12 or 1.0
    return np.asarray(np.maximum(noise, np.maximum(floor, smallest)))


def roughness(response: ComplexArray, *, alike: int = _ROUGHNESS_LINES) -> FloatArray:
    """Estimate the noise variance from second differences along the lines.

    A median over a block of lines ignores resonances, which are narrow.

    Args:
        response: FRF, shape (n_frf, n_lines).
        alike: lines over which the noise is assumed constant.

    Returns:
        E|error|^2, same shape.
    """
    difference = response[:, :-2] - 2.0 * response[:, 1:-1] + response[:, 2:]
    power = np.abs(difference) ** 2 / (6.0 * _MEDIAN_OF_POWER)
    blocks = max(1, power.shape[1] // alike)
    pieces = np.array_split(power, blocks, axis=1)
    middle = np.array([np.median(piece, axis=1) for piece in pieces])
    centre = np.cumsum([p.shape[1] for p in pieces]) - 0.5 * pieces[0].shape[1] + 1.0
    line = np.arange(response.shape[1])
    return np.array([np.interp(line, centre, row) for row in middle.T])


def local_level(response: ComplexArray) -> FloatArray:
    """Return |response|^2 averaged over a few lines, same shape."""
    return np.asarray(
        uniform_filter1d(np.abs(response) ** 2, _LEVEL_LINES, axis=1, mode="nearest")
    )


def local_residual(residual: ComplexArray) -> FloatArray:
    """Return |residual|^2 averaged over neighbouring lines, same shape."""
    return np.asarray(
        uniform_filter1d(np.abs(residual) ** 2, _LOCAL_LINES, axis=1, mode="nearest")
    )


def local_size(lines: FrfLines) -> int:
    """Return how many real values `local_residual` averages, over all FRFs."""
    return int(2 * lines.response.shape[0] * min(_LOCAL_LINES, lines.laplace.size))


def model_error(
    residual: ComplexArray, noise: FloatArray, response: ComplexArray
) -> float:
    """Estimate the relative error of the model itself.

    Args:
        residual: of a fit, shape (n_frf, n_lines).
        noise: variance of the lines, same shape.
        response: the FRF, same shape.

    Returns:
        Rms model error as a share of the local level of the FRF [-]; 0 where noise
        explains the residual.
    """
    excess = np.abs(residual) ** 2 / _MEDIAN_OF_POWER - noise
    share = float(np.median(excess / local_level(response)))
    return float(np.sqrt(max(0.0, share)))


def line_variance(
    noise: FloatArray, error: float, residual: ComplexArray, response: ComplexArray
) -> FloatArray:
    """Return the variance of the lines from noise and model error.

    Args:
        noise: variance of the lines, shape (n_frf, n_lines).
        error: of the model, as a share of the local level [-].
        residual: of a fit, shape (n_frf, n_lines).
        response: the FRF, same shape.

    Returns:
        E|error|^2, same shape.

    Note:
        The share is that of most lines. At peaks, which stand far above them, a fit
        often does much better: where the residual shows that, it counts. Else poles
        would be taken from flanks, with an interval from peaks.
    """
    usual = error**2 * local_level(response)
    if error > _INEXACT:
        return np.asarray(noise + usual)
    excess = np.maximum(local_residual(residual) - noise, 0.0)
    return np.asarray(noise + np.minimum(usual, excess))


def residual_around(
    lines: FrfLines, pole: ComplexArray, residual: ComplexArray, variance: FloatArray
) -> FloatArray:
    """Compare the residual around each pole with the given variances.

    Args:
        lines: lines of the fit.
        pole: [rad/s], shape (n_modes,).
        residual: of the fit, shape (n_frf, n_lines).
        variance: E|error|^2 of each line, same shape.

    Returns:
        Factor on the covariance of each pole [-], shape (n_modes,).
    """
    omega = lines.laplace.imag
    pitch = float(np.median(np.diff(omega)))
    factors = []
    for p, width in zip(pole, measured_width(lines, pole), strict=True):
        reach = max(_REACH_WIDTHS * width, _REACH_LINES * pitch)
        near = np.abs(omega - p.imag) < reach
        around = residual[:, near] / np.sqrt(variance[:, near])
        inside = int(np.count_nonzero(np.abs(pole.imag - p.imag) < reach))
        factors.append(_power(around, inside) * _correlation_length(around))
    return np.array(factors)


def _power(standard: ComplexArray, modes: int) -> float:
    """Return mean |x|^2, corrected for the fitted parameters.

    One residue per FRF, one pole for all.
    """
    n_frf, n_lines = standard.shape
    left = n_frf * (n_lines - modes) - modes
    if left <= 0:
        return 1.0
    return float(np.sum(np.abs(standard) ** 2) / left)


def _correlation_length(standard: ComplexArray) -> float:
    """Return how many neighbouring lines carry one independent error, 1 or more."""
    power = float(np.sum(np.abs(standard) ** 2))
    if standard.shape[1] < 3 or power == 0.0:
        return 1.0
    shared = np.sum(standard[:, 1:] * standard[:, :-1].conj()).real / power
    share = min(float(shared), _HIGHEST_SHARE)
    # The real part of a correlation of n complex numbers has variance 1 / 2 n.
    if share < _SIGNIFICANT / np.sqrt(2.0 * standard.size):
        return 1.0
    return (1.0 + share) / (1.0 - share)
